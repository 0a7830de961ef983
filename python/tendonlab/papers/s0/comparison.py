"""Printed numbers of S0 next to the numbers computed here."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from tendonlab.papers.compared import PAPER, RECONSTRUCTED, TWIN, Number, compared
from tendonlab.papers.s0 import bearings, bench, drive, fits, maps, models, twin


def differences() -> pd.DataFrame:
    """Every number of S0's tables and text that can be recomputed, one row each, as `compared` gives them."""
    return compared([*_ratios(), *_tables_6_and_7(), *_table_8(), *_text()])


def _ratios() -> Iterator[Number]:
    for name, printed in (("C25P104GX", 4.16), ("C35P75GX", 2.143)):
        yield Number(f"Table 3: ratio N of {name}", "1", PAPER, printed, bench.configuration(name).ratio(), 5e-4)
    weights = [bench.loaded("C25P104GX", load).external.weight for load in bench.LOADS]
    for k, name in ((2, "first"), (3, "second")):
        found = weights[k] - weights[k - 1]
        yield Number(f"Table 4: weight of the {name} pair of masses", "N", PAPER, 9.81, found, 0.005)


def _tables_6_and_7() -> Iterator[Number]:
    """The twin was made so that its fit gives these numbers."""
    for number, transmission in ((6, "C35P75GX"), (7, "C25P104GX")):
        speed, _, torque = twin.points(transmission)
        found, printed = fits.fit_static_lugre(speed, torque).model, models.printed_lugre(transmission)
        for name, unit in (("F_c", "N·m"), ("theta_s", "rad/s"), ("F_v", "N·m·s/rad")):
            value = getattr(printed, name)
            yield Number(f"Table {number}: {name}", unit, TWIN, value, getattr(found, name), 5e-3 * value)
        yield Number(f"Table {number}: F_s", "N·m", TWIN, printed.F_s, found.F_s, 1e-3)


def _table_8() -> Iterator[Number]:
    printed = {str(name): row for name, row in maps.printed_peaks().to_dict("index").items()}
    lugre = maps.peak_errors(lambda of, w: float(models.printed_lugre(of.transmission).torque(w)))
    proposed = maps.peak_errors(_proposed)
    measured = maps.peak_errors(lambda of, w: float(twin.friction(of, w)))["model"]
    for name, row in printed.items():
        own = 100 * abs(row["proposed"] - row["measured"]) / row["measured"]
        torque, error = float(proposed["model"][name]), float(proposed["error"][name])
        at = f"Table 8: {name}"
        yield Number(f"{at}, measured", "N·m", TWIN, row["measured"], float(measured[name]), 1e-7)
        yield Number(f"{at}, LuGre", "N·m", PAPER, row["lugre"], float(lugre["model"][name]), 1e-4)
        yield Number(f"{at}, LuGre error", "%", PAPER, row["lugre_error"], float(lugre["error"][name]), 0.1)
        yield Number(f"{at}, proposed, set drawn from it", "N·m", RECONSTRUCTED, row["proposed"], torque, 1e-3)
        name_of_error = f"{at}, proposed error, set drawn from it"
        yield Number(name_of_error, "%", RECONSTRUCTED, row["proposed_error"], error, 0.6)
        yield Number(f"{at}, proposed error, from its columns", "%", PAPER, row["proposed_error"], own, 0.06)
    last = printed["C25P104GX-D4M"]  # printed as 44, meant is 44.6
    fall = last["lugre_error"] - last["proposed_error"]
    yield Number("abstract: greatest fall of the error", "points", PAPER, 44.0, fall, 1.0)


def _text() -> Iterator[Number]:
    """Ranges of the text as their middle, with half their width as tolerance; the twin was made to meet them."""
    surplus = 100 * (drive.viscous_factor(10.0) - 1)
    yield Number("section 3.6: viscous surplus at N = 10", "%", PAPER, 1.0, surplus, 1e-6)
    for transmission in bench.TRANSMISSIONS:
        for load in maps.LOADED:
            of = bench.loaded(transmission, load)
            peaks, valleys = maps.features(maps.FINE, twin.friction(of, maps.FINE))
            yield Number(f"section 3.1: peak of {of.name}", "rad/s", TWIN, 18.0, float(peaks[0]), 3.0)
            yield Number(f"section 3.1: valley of {of.name}", "rad/s", TWIN, 35.0, float(valleys[0]), 5.0)
        of = bench.configuration(transmission)
        peaks, _ = maps.features(maps.FINE, twin.friction(of, maps.FINE))
        name = f"section 3.1: decay of {of.name} begins after"
        yield Number(name, "rad/s", TWIN, 85.0, float(peaks[-1]), 5.0)


def _proposed(of: bench.Configuration, speed: float) -> float:
    model = models.reconstructed(of.transmission)
    return float(np.asarray(model.torque(speed, load=bearings.relative_load(of), ratio=of.ratio())))

"""Printed numbers of S0 next to the numbers computed here."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from tendonlab.papers.s0 import bearings, bench, drive, fits, maps, models, twin

Row = tuple[str, float, float, float]  # what, printed, computed, tolerance


def differences() -> pd.DataFrame:
    """Every number of S0's tables and text that can be recomputed: `printed`, `computed`, `difference`, `tolerance`
    (all in the number's own unit) and `within`, indexed by what it is.

    Rows that need the twin only show that the reconstruction is consistent with the print."""
    rows = [*_ratios(), *_tables_6_and_7(), *_table_8(), *_text()]
    frame = pd.DataFrame(rows, columns=["what", "printed", "computed", "tolerance"]).set_index("what")
    frame.insert(2, "difference", frame["computed"] - frame["printed"])
    frame["within"] = frame["difference"].abs() <= frame["tolerance"]
    return frame


def _ratios() -> Iterator[Row]:
    for name, printed in (("C25P104GX", 4.16), ("C35P75GX", 2.143)):
        yield f"Table 3: ratio N of {name} (1)", printed, bench.configuration(name).ratio(), 5e-4
    weights = [bench.loaded("C25P104GX", load).external.weight for load in bench.LOADS]
    for k, name in ((2, "first"), (3, "second")):
        yield f"Table 4: weight of the {name} pair of masses (N)", 9.81, weights[k] - weights[k - 1], 0.005


def _tables_6_and_7() -> Iterator[Row]:
    for number, transmission in ((6, "C35P75GX"), (7, "C25P104GX")):
        speed, _, torque = twin.points(transmission)
        found, printed = fits.fit_static_lugre(speed, torque).model, models.printed_lugre(transmission)
        for name, unit in (("F_c", "N·m"), ("theta_s", "rad/s"), ("F_v", "N·m·s/rad")):
            value = getattr(printed, name)
            yield f"Table {number}: {name} ({unit}), fit on the twin", value, getattr(found, name), 5e-3 * value
        yield f"Table {number}: F_s (N·m), fit on the twin", printed.F_s, found.F_s, 1e-3


def _table_8() -> Iterator[Row]:
    printed = {str(name): row for name, row in maps.printed_peaks().to_dict("index").items()}
    lugre = maps.peak_errors(lambda of, w: float(models.printed_lugre(of.transmission).torque(w)))
    proposed = maps.peak_errors(_proposed)
    measured = maps.peak_errors(lambda of, w: float(twin.friction(of, w)))["model"]
    for name, row in printed.items():
        own = 100 * abs(row["proposed"] - row["measured"]) / row["measured"]
        found = float(proposed["model"][name]), float(proposed["error"][name])
        yield f"Table 8: {name}, measured (N·m), twin", row["measured"], float(measured[name]), 1e-7
        yield f"Table 8: {name}, LuGre (N·m)", row["lugre"], float(lugre["model"][name]), 1e-4
        yield f"Table 8: {name}, LuGre error (%)", row["lugre_error"], float(lugre["error"][name]), 0.1
        yield f"Table 8: {name}, proposed (N·m), set drawn from it", row["proposed"], found[0], 1e-3
        yield f"Table 8: {name}, proposed error (%), set drawn from it", row["proposed_error"], found[1], 0.6
        yield f"Table 8: {name}, proposed error (%), from its columns", row["proposed_error"], own, 0.06
    last = printed["C25P104GX-D4M"]  # printed as 44, meant is 44.6
    yield "abstract: greatest fall of the error (points)", 44.0, last["lugre_error"] - last["proposed_error"], 1.0


def _text() -> Iterator[Row]:
    """Ranges of the text as their middle, with half their width as tolerance."""
    yield "section 3.6: viscous surplus at N = 10 (%)", 1.0, 100 * (drive.viscous_factor(10.0) - 1), 1e-6
    for transmission in bench.TRANSMISSIONS:
        for load in maps.LOADED:
            of = bench.loaded(transmission, load)
            peaks, valleys = maps.features(maps.FINE, twin.friction(of, maps.FINE))
            yield f"section 3.1: peak of {of.name} (rad/s), twin", 18.0, float(peaks[0]), 3.0
            yield f"section 3.1: valley of {of.name} (rad/s), twin", 35.0, float(valleys[0]), 5.0
        of = bench.configuration(transmission)
        peaks, _ = maps.features(maps.FINE, twin.friction(of, maps.FINE))
        yield f"section 3.1: decay of {of.name} begins after (rad/s), twin", 85.0, float(peaks[-1]), 5.0


def _proposed(of: bench.Configuration, speed: float) -> float:
    model = models.reconstructed(of.transmission)
    return float(np.asarray(model.torque(speed, load=bearings.relative_load(of), ratio=of.ratio())))

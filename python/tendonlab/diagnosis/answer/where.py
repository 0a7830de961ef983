"""Where the gap lies: signal, element and regime, each against its floor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tendonlab.diagnosis.answer.heldout import Replayed, row_mean_squares
from tendonlab.fitting.case import Case
from tendonlab.fitting.noise import Floor
from tendonlab.report.diagnosis import WhereMap
from tendonlab.report.words import port_words
from tendonlab.simulation.catalog import PORT_QUANTITIES, PortInfo, unit

NUM_BINS, NUM_SHIFTS = 8, 400
COORDINATES = ("velocity", "position", "load")


def dimension(port: PortInfo, quantity: str) -> str:
    """Dimension of one of the `COORDINATES` at a port."""
    return {"velocity": "flow", "position": "displacement", "load": port.load}[quantity]


def signals(case: Case, of: Replayed, floor: Floor) -> list[dict[str, Any]]:
    """Share of each output in the excess mean square over the floor, largest first."""
    square = row_mean_squares(np.concatenate(of.residuals, axis=1))
    excess = np.array(
        [
            max(0.0, square[c] / floor.rms[c] ** 2 - 1.0) if np.isfinite(floor.rms[c]) else 0.0
            for c in range(len(square))
        ]
    )
    total = float(excess.sum())
    rows = [{"signal": case.outputs[c], "share": float(excess[c] / total) if total > 0 else 0.0} for c in case.measured]
    return sorted(rows, key=lambda r: -float(r["share"]))


def elements(probability: Mapping[str, float], sets: Sequence[Mapping[str, Any]], case: Case) -> list[dict[str, Any]]:
    """Probability that the cause sits in each element: that of the `sets` which hold one of its effects, at least that
    of its most probable effect."""
    rows = []
    for element in case.system.info.elements:
        own = {name: p for name, p in probability.items() if name.rpartition(":")[0] == element.name}
        total = sum(entry["probability"] for entry in sets if own.keys() & set(entry["effects"]))
        rows.append({"element": element.name, "probability": float(min(1.0, max(total, *own.values(), 0.0)))})
    return sorted(rows, key=lambda r: -float(r["probability"]))


class PortRecords:
    """What the ports of a model did in some experiments, sample by sample."""

    def __init__(self, case: Case, of: Replayed, experiments: Sequence[int]) -> None:
        replays = zip(experiments, of.systems, of.initial, strict=True)
        runs = [case.run(i, system, initial, ports=True)["ports"] for i, system, initial in replays]
        self.case = case
        self.ports = np.concatenate(runs, axis=2)
        self.time = np.concatenate([np.asarray(case.experiments[i].time) for i in experiments])

    def coordinate(self, port: str, quantity: str) -> np.ndarray:
        """Samples of one quantity at one port."""
        names = [p.name for p in self.case.system.info.ports]
        return np.asarray(self.ports[names.index(port), PORT_QUANTITIES.index(quantity)])


def excess(case: Case, of: Replayed, floor: Floor) -> np.ndarray:
    """Mean over outputs of (residual / floor)², minus one, at each sample of all experiments together."""
    together = np.concatenate(of.residuals, axis=1)[case.measured]
    squares = np.square(together / floor.rms[case.measured, None])
    there = np.isfinite(squares)
    count = there.sum(axis=0)  # none where an outlier was left out
    return np.where(count > 0, np.where(there, squares, 0.0).sum(axis=0) / np.maximum(count, 1), 1.0) - 1.0


def regimes(case: Case, of: Replayed, floor: Floor, records: PortRecords) -> list[dict[str, Any]]:
    """For every coordinate the range that holds most of the excess beyond its share of time; p from shifting the excess
    in time against the coordinate, which keeps the autocorrelation of both."""
    e = np.maximum(excess(case, of, floor), 0.0)
    if e.sum() <= 0:
        return []
    rng = np.random.default_rng(0)
    shifts = rng.integers(len(e) // 20, len(e) - len(e) // 20, NUM_SHIFTS)
    rows = []
    for port in case.system.info.ports:
        for quantity in COORDINATES:
            x = records.coordinate(port.name, quantity)
            if np.ptp(x) > 0:
                rows.append(_regime(f"{port.name}_{quantity}", x, e, shifts))
    if not case.system.info.steady:  # the order of steady points means nothing
        rows.append(_regime("time", records.time, e, shifts))
    return sorted(rows, key=lambda r: (r["p_value"], -r["share"]))[:6]


def _regime(name: str, x: np.ndarray, e: np.ndarray, shifts: np.ndarray) -> dict[str, Any]:
    edges = np.unique(np.quantile(x, np.linspace(0, 1, NUM_BINS + 1)))
    index = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    time_share = np.bincount(index, minlength=len(edges) - 1) / len(x)

    def surplus(values: np.ndarray) -> np.ndarray:
        return np.asarray(np.bincount(index, values, minlength=len(edges) - 1) / values.sum() - time_share)

    found = surplus(e)
    best = int(np.argmax(found))
    twice = np.concatenate([e, e])  # moved by s, the excess is a part of it
    chance = np.array([surplus(twice[len(e) - s : 2 * len(e) - s]).max() for s in shifts])
    return {
        "coordinate": name,
        "range": [float(edges[best]), float(edges[best + 1])],
        "share": float(found[best] + time_share[best]),
        "p_value": float((1 + np.sum(chance >= found[best])) / (1 + len(chance))),
    }


def maps(
    case: Case, refitted: Replayed, improved: Replayed, floor: Floor, records: PortRecords
) -> tuple[WhereMap, ...]:
    """Residual over the floor in cells of velocity × load (position where no load varies), one a port."""
    before = np.sqrt(np.maximum(excess(case, refitted, floor) + 1.0, 0.0))
    after = np.sqrt(np.maximum(excess(case, improved, floor) + 1.0, 0.0))
    found = []
    for port in case.system.info.ports:
        x = records.coordinate(port.name, "velocity")
        quantity = "load" if np.ptp(records.coordinate(port.name, "load")) > 0 else "position"
        y = records.coordinate(port.name, quantity)
        axis = case.system.info.element(port.element).axis or case.system.axis
        if np.ptp(x) == 0 or np.ptp(y) == 0:
            continue
        x_edges, y_edges = _edges(x), _edges(y)
        place = port_words(port.name, case.system.kind)
        found.append(
            WhereMap(
                element=port.element,
                place=place,
                x=f"{place} velocity",
                x_unit=unit("flow", axis),
                x_edges=x_edges,
                y=f"{place} {quantity}",
                y_unit=unit(dimension(port, quantity), axis),
                y_edges=y_edges,
                refitted=_cells(x, y, before, x_edges, y_edges),
                with_effect=_cells(x, y, after, x_edges, y_edges),
            )
        )
    return tuple(found)


def _edges(x: np.ndarray) -> np.ndarray:
    low, high = np.quantile(x, [0.005, 0.995])
    if low == high:
        low, high = float(x.min()), float(x.max())
    return np.linspace(low, high, 15)


def _cells(x: np.ndarray, y: np.ndarray, r: np.ndarray, x_edges: np.ndarray, y_edges: np.ndarray) -> np.ndarray:
    count, _, _ = np.histogram2d(y, x, [y_edges, x_edges])
    total, _, _ = np.histogram2d(y, x, [y_edges, x_edges], weights=r**2)
    return np.asarray(np.sqrt(np.divide(total, count, out=np.full_like(total, np.nan), where=count > 0)))

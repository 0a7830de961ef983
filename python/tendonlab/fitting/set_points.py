"""Noise of steady points, whose rows have no order in time: from points at equal inputs, else from neighbours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tendonlab.simulation.reading import rounding_step
from tendonlab.simulation.records import Experiment

ENOUGH, FEWEST = 8, 3  # differences that tell a spread, and that tell its size where there are no more
ORDERS = (1, 2)  # neighbours to either side that a point is compared with: a straight line, a cubic


@dataclass(frozen=True)
class Points:
    """Steady points: `inputs` and conditions (rows, inputs), and the output's `values` (rows,), without gaps."""

    inputs: np.ndarray
    values: np.ndarray


def points_of(experiments: Sequence[Experiment], names: Sequence[str], records: Sequence[np.ndarray]) -> list[Points]:
    """The points of each experiment: its logged inputs of these `names`, what is stated of it, and the record of one
    output."""
    stated = sorted({(of, key) for e in experiments for of in ("conditions", "add") for key in getattr(e, of)})
    found = []
    for experiment, values in zip(experiments, records, strict=True):
        there = np.isfinite(values)
        columns = [experiment.data[name].to_numpy(dtype=float) for name in names if name in experiment.data.columns]
        columns += [np.full(len(values), getattr(experiment, of).get(key, np.nan)) for of, key in stated]
        found.append(Points(np.nan_to_num(np.column_stack(columns))[there], values[there]))
    return found


def noise_of_points(points: Sequence[Points]) -> float:
    """Sd of the noise of one output at steady points, whatever the order of their rows; at least that of rounding.

    Points at equal inputs tell it, within one experiment: friction differs from run to run. Without them the lesser of
    two that overstate it: points at equal inputs of different experiments, and what neighbours in one input, the others
    equal, do not predict of a point between them. 0 where nothing tells it."""
    rounding = max(map(_rounding, points))
    shown = _of_replicates(points)
    if shown is not None and max(shown, rounding) > 0.0:  # else all of them are copies
        return max(shown, rounding)
    whole = Points(np.concatenate([p.inputs for p in points]), np.concatenate([p.values for p in points]))
    shown = min(filter(None, (_of_replicates([whole]), _of_neighbours(points))), default=0.0)
    return max(shown or _of_neighbours([whole]) or _of_neighbours([whole], fewest=FEWEST), rounding)


def _of_replicates(points: Sequence[Points]) -> float | None:
    """Sd of points at equal inputs; None where there are too few."""
    squares, freedom = 0.0, 0
    for p in points:
        _, _, counts, spreads = _merged(p)
        freedom += int(np.sum(counts - 1))
        squares += float(np.sum(spreads))
    return float(np.sqrt(squares / freedom)) if freedom >= ENOUGH else None


def _of_neighbours(points: Sequence[Points], *, fewest: int = ENOUGH) -> float:
    """Sd of what neighbours do not predict of a point, by the number of neighbours that leaves least: fewer pass over
    less, and more follow a curve. 0 where there are too few points."""
    found = []
    for order in ORDERS:
        left = np.concatenate([_left(line, order) for p in points for line in _lines(p)] or [np.zeros(0)])
        if len(left) >= fewest:
            found.append(1.4826 * float(np.median(np.abs(left))))
    return min(found, default=0.0)


def _left(line: tuple[np.ndarray, np.ndarray, np.ndarray], order: int) -> np.ndarray:
    """Differences between each point of a line, of means of so many readings, and the polynomial through `order`
    neighbours to either side, each over what noise of one unit makes of it."""
    x, y, counts = line
    beside = [k for k in range(-order, order + 1) if k]
    middle = np.arange(order, len(x) - order)
    left, power = y[middle].copy(), 1.0 / counts[middle]
    for k in beside:
        weight = np.ones(len(middle))
        for other in beside:
            if other != k:
                weight *= (x[middle] - x[middle + other]) / (x[middle + k] - x[middle + other])
        left -= weight * y[middle + k]
        power += np.square(weight) / counts[middle + k]
    return np.asarray(left / np.sqrt(power))


def _lines(points: Points) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """The points by the input with the most values, at equal others and on one side of 0, where friction turns over:
    its values, rising, and mean and number of the readings there."""
    inputs, values, counts, _ = _merged(points)
    if not len(inputs):
        return
    along = int(np.argmax([len(np.unique(column)) for column in inputs.T]))
    x = inputs[:, along]
    others = np.column_stack([np.delete(inputs, along, axis=1), np.sign(x)])
    _, line = np.unique(others, axis=0, return_inverse=True)
    for k in range(int(line.max()) + 1):
        at = np.flatnonzero(line.reshape(-1) == k)
        yield x[at], values[at], counts[at]


def _merged(points: Points) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Inputs that differ, in rising order, with mean and number of the readings there, and the sum of their squares
    about that mean."""
    inputs, place, counts = np.unique(points.inputs, axis=0, return_inverse=True, return_counts=True)
    place = place.reshape(-1)
    means = np.bincount(place, weights=points.values, minlength=len(inputs)) / counts
    squares = np.bincount(place, weights=np.square(points.values - means[place]), minlength=len(inputs))
    return inputs, means, counts, squares


def _rounding(points: Points) -> float:
    """Sd of rounding, where readings in the order of the inputs show steps."""
    order = np.lexsort((points.values, *points.inputs.T[::-1]))
    return rounding_step(points.values[order]) / float(np.sqrt(12.0)) if len(order) else 0.0

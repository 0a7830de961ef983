"""Outliers: single samples, or a few in a row, far from their neighbours."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from tendonlab.checking.kicks import moves_the_rig
from tendonlab.checking.moving import WINDOW, largest_around, median_around, running_median
from tendonlab.data import Dataset, Experiment
from tendonlab.simulation.reading import smallest_change

FEWEST_SAMPLES = 3 * WINDOW  # of a record whose outliers are looked for, up to three in a row
AROUND = 51  # samples over which the noise of a record is looked at
DEVIATIONS = 8.0  # robust standard deviations from the running median that make an outlier
SPIKE = 25.0  # the same, of an input: what the controller did is no error
BEND = 6.0  # times what the running median itself bends nearby
RETURN = 0.2  # of a spike of an input, by which its neighbours may differ
CORNER = 2.0  # times by how much the steps before and after a sample differ, within which it is a corner of the motion
# Neighbours that tell the path, pass by pass: two outliers in a row, or with one sample between, hide one another.
NEAR = ((1, 2), (2, 3), (1, 3), (1, 2))
END = 5.0  # times by how much any other sample differs from its path, of one at either end
FOURTH = 70.0**0.5  # sd of the fourth difference of noise of sd 1
FEWEST = 3  # spikes that show a size
KICK = 0.05  # of the size of spikes, by which those may differ that a controller makes
MOST = 0.03  # of a record: what is more frequent belongs to the signal


Marks = Mapping[tuple[str, str], np.ndarray]  # which samples are outliers, by experiment and signal


def marks(dataset: Dataset) -> Marks:
    """The outliers of every input and output."""
    found = {
        (e.name, name): (spikes if role == "input" else outliers)(e.data[name].to_numpy(dtype=float))
        for e in dataset.experiments
        for name in e.data.columns
        if (role := dataset.signals[name].role) in ("input", "output")
    }
    kicking = {
        name
        for name in dataset.inputs
        if _are_kicks(_sizes(dataset, name, found)) or moves_the_rig(dataset, name, found)
    }
    return {key: np.zeros_like(mask) if key[1] in kicking else mask for key, mask in found.items()}


def _sizes(dataset: Dataset, name: str, found: Marks) -> np.ndarray:
    """How far each spike of an input stands out of its neighbours."""
    sizes = [np.zeros(0)]
    for e in dataset.experiments:
        at = np.flatnonzero(found.get((e.name, name), np.zeros(0)))
        if len(at):
            values = e.data[name].to_numpy(dtype=float)
            sizes.append(np.abs(values[at] - 0.5 * (values[at - 1] + values[at + 1])))
    return np.concatenate(sizes)


def _are_kicks(sizes: np.ndarray) -> bool:
    """Whether spikes of an input are all of one size: a controller that takes the difference of a coarse reading kicks
    by one step of the reading. Errors of logging differ."""
    middle = float(np.median(sizes)) if len(sizes) >= FEWEST else 0.0
    return middle > 0.0 and float(np.median(np.abs(sizes - middle))) < KICK * middle


def outliers(values: np.ndarray) -> np.ndarray:
    """Which samples of a record are outliers, shape (n,); NaN is none."""
    found = _far_from_median(values, DEVIATIONS)
    for near, far in NEAR:
        kept = np.flatnonzero(np.isfinite(values) & ~found)
        if len(kept) < FEWEST_SAMPLES:
            break
        filled = np.interp(np.arange(len(values)), kept, values[kept])
        off = np.concatenate([_off_the_path(filled, near, far), _off_at_the_ends(filled)])
        found[off[np.isfinite(values[off]) & ~found[off]]] = True
    return found if found.mean() <= MOST else np.zeros_like(found)


def _off_the_path(y: np.ndarray, near: int, far: int) -> np.ndarray:
    """Which samples lie off the cubic through two neighbours on either side, the `near`-th and the `far`-th ones; a
    corner of that path, or a jump in it, is none."""
    inner, outer = far**2 / (far**2 - near**2), -(near**2) / (far**2 - near**2)  # the cubic at the middle
    at = np.arange(far, len(y) - far)
    left, right = (y[at - near] - y[at - far]) / (far - near), (y[at + far] - y[at + near]) / (far - near)
    path = 0.5 * inner * (y[at - near] + y[at + near]) + 0.5 * outer * (y[at - far] + y[at + far])
    jump = np.abs(y[at + near] - y[at - near] - near * (left + right))
    away = np.abs(y[at] - path)
    noise = 1.4826 * np.fmax(np.median(away), median_around(away, AROUND))
    allowed = DEVIATIONS * np.fmax(noise, smallest_change(y)) + CORNER * np.abs(right - left) + jump
    return np.asarray(at[away > allowed])


def _off_at_the_ends(y: np.ndarray) -> np.ndarray:
    """Which of the first two and the last two samples, whose path is known from one side only, are far from the cubic
    through the next four: by more than noise, and far more than any other sample is from its own."""
    away = np.abs(np.diff(y, 4))  # of each sample from the cubic through the next four
    noise = max(1.4826 * float(np.median(away)), FOURTH * smallest_change(y))

    def is_off(along: np.ndarray, place: int) -> bool:
        others = float(np.max(along[place + 1 : -2]))  # the last two hold the samples at the other end
        return bool(along[place] > max(DEVIATIONS * noise, END * others))

    first = [place for place in (0, 1) if is_off(away, place)]
    return np.array(first + [len(y) - 1 - place for place in (0, 1) if is_off(away[::-1], place)], dtype=int)


def _far_from_median(values: np.ndarray, deviations: float) -> np.ndarray:
    """Which samples are far from the running median, more than the median itself bends."""
    kept = np.flatnonzero(np.isfinite(values))
    found = np.zeros(len(values), dtype=bool)
    if len(kept) < FEWEST_SAMPLES:
        return found
    y = values[kept]
    middle = running_median(y)
    away = np.abs(y - middle)
    noise = 1.4826 * np.fmax(np.median(away), median_around(away, AROUND))
    # A sample of a motion faster than its noise is the median itself, and says nothing of the noise.
    noise = np.fmax(noise, 1.4826 * float(np.median(np.abs(np.diff(y, 4)))) / FOURTH)
    bends = np.abs(np.diff(middle, 2, prepend=middle[0], append=middle[-1]))
    allowed = deviations * np.fmax(noise, smallest_change(y)) + BEND * largest_around(bends, WINDOW)
    found[kept] = away > allowed
    return found if found.mean() <= MOST else np.zeros_like(found)


def spikes(values: np.ndarray) -> np.ndarray:
    """Outliers of an input: single samples after which it is back where it was. Jumps and pulses drive the rig."""
    found = _far_from_median(values, SPIKE)
    single = found.copy()
    single[1:] &= ~found[:-1]
    single[:-1] &= ~found[1:]
    at = np.flatnonzero(single[1:-1]) + 1
    before, after = values[at - 1], values[at + 1]
    back = np.abs(after - before) < RETURN * np.abs(values[at] - 0.5 * (before + after))
    found[:] = False
    found[at[back]] = True
    return found


def without_outliers(dataset: Dataset) -> Dataset:
    """The dataset with its outliers taken out: missing in outputs, interpolated in inputs."""
    marked = marks(dataset)
    return replace(dataset, experiments=tuple(_cleaned(dataset, e, marked) for e in dataset.experiments))


def _cleaned(dataset: Dataset, experiment: Experiment, marked: Marks) -> Experiment:
    data = experiment.data.copy()
    for name in data.columns:
        found = marked.get((experiment.name, name))
        if found is None or not found.any():
            continue
        data.loc[found, name] = np.nan
        if dataset.signals[name].role == "input":
            data[name] = data[name].interpolate(method="index", limit_direction="both")
    return replace(experiment, data=data)

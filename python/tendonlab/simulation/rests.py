"""Rests in a noisy record of a motion: stretches over which only the noise moves."""

from __future__ import annotations

import numpy as np

HALF, LEAST = (0.03, 8), (0.2, 20)  # s and samples at least: of half a window, and of a rest
MOVES = 4.0  # sd by which the means of two neighbouring halves differ where something moves
STAYS = 4.0  # sd of the drift and of the mean square over a whole rest
PARTS = 32  # of a stretch without visible motion, at most, that are tried as its ends
WHOLE = 0.5  # share of a stretch without visible motion that must rest: a steady creep is no rest in its middle


def settled(time: np.ndarray, values: np.ndarray, noise: float) -> np.ndarray:
    """The record with its mean in each rest. Noise that a smooth curve follows there is a motion that does not exist:
    in a simulator that sticks it eases friction.

    `time` (n,), s, increasing; `values` (n,); `noise`: sd of the values."""
    if noise == 0.0:
        return values
    step = float(time[-1] - time[0]) / max(len(time) - 1, 1)
    half, least = (max(few, int(np.ceil(seconds / step))) for seconds, few in (HALF, LEAST))
    out = np.array(values)
    for start, stop in _quiet(values, half, MOVES * noise * np.sqrt(2.0 / half)):
        rest = _longest(time, values, noise, (start, stop), half, least)
        out[rest] = np.mean(values[rest]) if rest.stop > rest.start else out[rest]
    return out


def _longest(
    time: np.ndarray, values: np.ndarray, noise: float, quiet: tuple[int, int], half: int, least: int
) -> slice:
    """The longest part of a `quiet` stretch that rests, empty where there is none: a motion too slow to be seen at once
    may end or begin there."""
    start, stop = quiet
    fewest = max(least, int(WHOLE * (stop - start)))
    start, stop = start + (half // 2 if start else 0), stop - (half // 2 if stop < len(values) else 0)
    cut = max(half, (stop - start) // PARTS)
    for cuts in range((stop - start - fewest) // cut + 1):
        for before in range(cuts + 1):
            part = slice(start + before * cut, stop - (cuts - before) * cut)
            if _stays(time[part], values[part], noise):
                return part
    return slice(start, start)


def _quiet(values: np.ndarray, half: int, least: float) -> np.ndarray:
    """First and last sample (exclusive) of the stretches in which no two neighbouring means of `half` samples differ by
    more than `least` (stretches, 2)."""
    if len(values) < 2 * half:
        return np.empty((0, 2), dtype=int)
    sums = np.concatenate([[0.0], np.cumsum(values)])
    means = (sums[half:] - sums[:-half]) / half
    moves = np.ones(len(values) + 2, dtype=bool)
    moves[1 + half : len(values) - half + 2] = np.abs(means[half:] - means[:-half]) > least
    moves[1 : 1 + half] = moves[1 + half]
    moves[len(values) - half + 2 : -1] = moves[len(values) - half + 1]
    return np.flatnonzero(np.diff(moves.astype(int))).reshape(-1, 2)


def _stays(time: np.ndarray, values: np.ndarray, noise: float) -> bool:
    """Whether the values neither drift by more than their noise, or than chance has them drift, nor spread further."""
    away, since = values - np.mean(values), time - np.mean(time)
    drift = float(since @ away) / np.sqrt(float(since @ since))
    spread = float(np.mean(away**2)) / noise**2 - 1.0
    whole = np.sqrt(len(values) / 12.0)  # of a drift by the noise from one end to the other
    return bool(abs(drift) < max(STAYS, whole) * noise and spread < STAYS * np.sqrt(2.0 / len(values)))

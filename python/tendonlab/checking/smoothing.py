"""Logs on an even grid, every channel smoothed by the same Gaussian, with the derivatives of what moves.

One filter for all channels keeps an equation that is linear in them exact, whatever the filter removes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tendonlab.checking.moving import weighed_around

MOST_SAMPLES = 8000  # of the grid over all experiments
LEAST_WIDTH = 1.5  # samples: sd of the narrowest Gaussian
NOISE_SHARE = 0.03  # of the rms acceleration that noise may reach
BLOCK = 4  # samples of a Gaussian's sd that remain where a record is thinned before it is smoothed
REACH = 4.0  # sd of the Gaussian on each side
GROWTH = 1.25  # of the width from one trial to the next


def even(time: np.ndarray, values: np.ndarray, step: float, *, held: bool) -> np.ndarray:
    """`values` at even instants from the first sample on. A held sample stands for the middle of its interval."""
    grid = time[0] + step * np.arange(round((time[-1] - time[0]) / step) + 1)
    kept = np.isfinite(values)
    at = np.append(0.5 * (time[1:] + time[:-1]), time[-1] + 0.5 * (time[-1] - time[-2])) if held else time
    return np.asarray(np.interp(grid, at[kept], values[kept]))


def width(positions: Sequence[np.ndarray], noise: Sequence[float], total: int) -> float:
    """Sd of the Gaussian, in samples, at which noise is a small share of the acceleration of these even records; the
    least where there is none. `total`: samples of all experiments."""
    least = max(LEAST_WIDTH, total / MOST_SAMPLES)
    longest = max(least, min((len(y) for y in positions), default=0) / 30.0)
    sd = least
    while sd < longest:
        bends = sum(float(np.sum(np.square(smooth(y, sd, order=2)))) for y in positions)
        each = 3.0 / (8.0 * np.sqrt(np.pi)) / sd**5
        added = sum(s**2 * each * len(smooth(y, sd)) for y, s in zip(positions, noise, strict=True))
        if added <= NOISE_SHARE**2 * max(bends - added, 0.0):
            break
        sd *= GROWTH
    return min(sd, longest)


def smooth(values: np.ndarray, sd: float, *, order: int = 0) -> np.ndarray:
    """A derivative of an even record, per sample^order, smoothed by a Gaussian of `sd` samples: about one value per
    sd."""
    block = max(1, int(sd / BLOCK))
    n = len(values) // block
    thinned = values[: n * block].reshape(n, block).mean(axis=1)
    fine = weighed_around(thinned, _kernel(sd / block, order)) / float(block) ** order
    return np.asarray(fine[:: stride(sd) // block])


def _kernel(sd: float, order: int) -> np.ndarray:
    """A Gaussian or its derivative, exact for parabolas however coarse the samples: a derivative that leaked a part of
    the position itself would drown the acceleration."""
    n = np.arange(-np.ceil(REACH * sd), np.ceil(REACH * sd) + 1)
    weight = np.exp(-0.5 * np.square(n / sd))
    weight /= weight.sum()
    second, fourth = (float(weight @ n**power) for power in (2, 4))
    by_order = (weight, n * weight / second, 2.0 * (n**2 - second) * weight / (fourth - second**2))
    return np.asarray(by_order[order])


def stride(sd: float) -> int:
    """Samples from one smoothed value to the next."""
    block = max(1, int(sd / BLOCK))
    return block * max(1, round(sd / block))


def spread(sd: float, order: int) -> float:
    """Sd of a derivative per sample^order of white noise of sd 1, smoothed by a Gaussian of `sd` samples."""
    numerator = {0: 1.0, 1: 0.5, 2: 0.75}[order]
    return float(np.sqrt(numerator / (2.0 * np.sqrt(np.pi)) / sd ** (2 * order + 1)))

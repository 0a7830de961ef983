"""Filters over a window that moves along a record. (scipy.ndimage takes a third of a second to import.)"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

WINDOW = 7  # samples of the running median
STRIDE = 8  # samples from one median of many to the next
# Pairs that are put in order one after the other, by which seven values are sorted.
FIRST = ((0, 6), (2, 3), (4, 5), (0, 2), (1, 4), (3, 6), (0, 1), (2, 5))
SORTED = (*FIRST, (3, 4), (1, 2), (4, 6), (2, 3), (4, 5), (1, 2), (3, 4), (5, 6))


def running_median(values: np.ndarray) -> np.ndarray:
    """The median of each sample, shape (n,), and three neighbours on either side; beyond an end its sample repeats."""
    padded = np.pad(values, WINDOW // 2, mode="edge")
    rows = [padded[k : k + len(values)] for k in range(WINDOW)]
    for low, high in SORTED:
        rows[low], rows[high] = np.minimum(rows[low], rows[high]), np.maximum(rows[low], rows[high])
    return rows[WINDOW // 2]


def median_around(values: np.ndarray, width: int) -> np.ndarray:
    """About the median of `width` samples around each one, shape (n,), in steps of a few samples; beyond an end the
    record is mirrored."""
    half = min(width // 2, len(values) - 1)
    windows = sliding_window_view(np.pad(values, half, mode="reflect"), 2 * half + 1)[STRIDE // 2 :: STRIDE]
    if not len(windows):
        return np.full(len(values), np.median(values))
    medians = np.repeat(np.median(windows, axis=1), STRIDE)
    return np.concatenate([medians, np.full(max(0, len(values) - len(medians)), medians[-1])])[: len(values)]


def largest_around(values: np.ndarray, width: int) -> np.ndarray:
    """The largest of `width` samples around each one, shape (n,), an odd number."""
    padded = np.pad(values, width // 2, mode="edge")
    return np.asarray(np.maximum.reduce([padded[k : k + len(values)] for k in range(width)]))


def whole_around(is_whole: np.ndarray, width: int) -> np.ndarray:
    """Where all of `width` samples around each one, shape (n,), are whole; what lies beyond an end is not."""
    before = width // 2
    broken = np.pad(~np.asarray(is_whole, dtype=bool), (before, width - 1 - before), constant_values=True)
    gathered = np.concatenate([[0], np.cumsum(broken)])
    return np.asarray(gathered[width:] == gathered[:-width])


def weighed_around(values: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """The sum of samples around each one, shape (n,), times an odd number of weights; beyond an end its sample
    repeats."""
    half = len(weight) // 2
    if not len(values):
        return values
    return np.asarray(np.correlate(np.pad(values, half, mode="edge"), weight, mode="valid"))

"""Stretches of a record in which a condition holds, and block means of a record to search them quickly."""

from __future__ import annotations

import numpy as np


def stretches(holds: np.ndarray) -> list[slice]:
    """Every longest stretch of samples in which `holds` is true."""
    edges = np.flatnonzero(np.diff(holds.astype(np.int8), prepend=0, append=0))
    return [slice(int(begin), int(end)) for begin, end in zip(edges[::2], edges[1::2], strict=True)]


def blocks(values: np.ndarray, size: int) -> np.ndarray:
    """Means of consecutive blocks of `size` samples; remaining samples at the end do not count."""
    num = len(values) // size
    return np.asarray(values[: num * size].reshape(num, size).mean(axis=1))


def of_samples(stretch: slice, size: int, num_samples: int) -> slice:
    """The samples of a stretch of blocks; the last block includes the remaining samples."""
    end = num_samples if stretch.stop == num_samples // size else stretch.stop * size
    return slice(stretch.start * size, end)


def trimmed(stretch: slice, trim: float) -> slice:
    """The stretch without a share `trim` of its samples at each end."""
    cut = round(trim * (stretch.stop - stretch.start))
    return slice(stretch.start + cut, stretch.stop - cut)

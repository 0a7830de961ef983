"""Stretches of a record in which something holds, and the record in fewer samples to look for them."""

from __future__ import annotations

import numpy as np


def stretches(holds: np.ndarray) -> list[slice]:
    """Every longest stretch of samples in which `holds` is true."""
    edges = np.flatnonzero(np.diff(holds.astype(np.int8), prepend=0, append=0))
    return [slice(int(begin), int(end)) for begin, end in zip(edges[::2], edges[1::2], strict=True)]


def blocks(values: np.ndarray, size: int) -> np.ndarray:
    """Means of `size` samples after another; what is left over at the end does not count."""
    num = len(values) // size
    return np.asarray(values[: num * size].reshape(num, size).mean(axis=1))


def of_samples(stretch: slice, size: int, num_samples: int) -> slice:
    """The stretch of samples that a stretch of blocks stands for; the last block has what is left over."""
    end = num_samples if stretch.stop == num_samples // size else stretch.stop * size
    return slice(stretch.start * size, end)


def trimmed(stretch: slice, trim: float) -> slice:
    """The stretch without a share `trim` of its samples at each end."""
    cut = round(trim * (stretch.stop - stretch.start))
    return slice(stretch.start + cut, stretch.stop - cut)

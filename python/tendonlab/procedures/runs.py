"""Stretches of a record in which something holds."""

from __future__ import annotations

import numpy as np


def stretches(holds: np.ndarray) -> list[slice]:
    """Every longest stretch of samples in which `holds` is true."""
    edges = np.flatnonzero(np.diff(holds.astype(np.int8), prepend=0, append=0))
    return [slice(int(begin), int(end)) for begin, end in zip(edges[::2], edges[1::2], strict=True)]


def trimmed(stretch: slice, trim: float) -> slice:
    """The stretch without a share `trim` of its samples at each end."""
    cut = round(trim * (stretch.stop - stretch.start))
    return slice(stretch.start + cut, stretch.stop - cut)

"""Sampling designs: tables of points that fill a box of parameters evenly."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.arguments import whole
from tendonlab.errors import ParameterError
from tendonlab.seed import generator

if TYPE_CHECKING:
    import pandas as pd
    from scipy.stats.qmc import QMCEngine

Bounds = Mapping[str, tuple[float, float]]


def sobol(bounds: Bounds, *, num_points: int, seed: int | np.random.Generator = 0) -> pd.DataFrame:
    """A scrambled Sobol sequence within `bounds`, {parameter: (lower, upper)}, SI: one point per row for `tl.sweep`.

    `num_points`: a power of 2, as the balance of the sequence needs. Raises ParameterError for another number or for
    bounds that do not increase."""
    from scipy.stats.qmc import Sobol

    if whole("num_points", num_points, 1) & (num_points - 1):
        near = 1 << int(num_points).bit_length()
        raise ParameterError(f"num_points = {num_points}: expected a power of 2, such as {near // 2} or {near}")
    return _within(bounds, Sobol(max(1, len(bounds)), rng=generator(seed)), num_points)


def latin_hypercube(bounds: Bounds, *, num_points: int, seed: int | np.random.Generator = 0) -> pd.DataFrame:
    """A Latin hypercube within `bounds`, {parameter: (lower, upper)}, SI: each of `num_points` equal parts of each
    range holds one point. Raises ParameterError for bounds that do not increase."""
    from scipy.stats.qmc import LatinHypercube

    return _within(bounds, LatinHypercube(max(1, len(bounds)), rng=generator(seed)), whole("num_points", num_points, 1))


def _within(bounds: Bounds, engine: QMCEngine, num_points: int) -> pd.DataFrame:
    import pandas as pd

    if not isinstance(bounds, Mapping) or not bounds:
        raise ParameterError(f"bounds = {bounds!r:.60}: expected {{parameter: (lower, upper)}}")
    for name, pair in bounds.items():
        ends = np.asarray(pair)
        if ends.shape != (2,) or ends.dtype.kind not in "iuf" or not np.isfinite(ends).all() or ends[0] >= ends[1]:
            raise ParameterError(f"bounds of {name} = {pair!r:.60}: expected (lower, upper), lower below upper")
    lower, upper = np.array([bounds[name] for name in bounds], dtype=float).T
    points = lower + (upper - lower) * engine.random(num_points)
    return pd.DataFrame(np.clip(points, lower, upper), columns=list(bounds))

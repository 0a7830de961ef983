"""Points drawn from the uncertainty of a fit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tendonlab._core import Free
from tendonlab.errors import NumericalError

MOST_ROUNDS = 1000  # of drawing anew what fell outside the bounds


def samples(
    free: Sequence[Free], value: np.ndarray, sd: np.ndarray, correlations: np.ndarray, *, num: int,
    random: np.random.Generator,
) -> np.ndarray:  # fmt: skip
    """Values, shape (num, free), normal in the coordinates of the fit (logarithms where the fit takes those). A draw
    with any value outside its bounds is rejected and drawn anew. `sd`: of the values.

    Raises NumericalError where hardly any draw is within the bounds."""
    if not free:
        return np.empty((num, 0))
    centre = np.array([f.coordinate(v) for f, v in zip(free, value, strict=True)])
    width = np.array([s / f.slope(x) for f, s, x in zip(free, sd, centre, strict=True)])
    covariance = width[:, None] * correlations * width
    log, scale = np.array([f.log for f in free]), np.array([f.scale for f in free])
    lower, upper = np.array([f.lower for f in free]), np.array([f.upper for f in free])
    kept = np.empty((0, len(free)))
    for _ in range(MOST_ROUNDS):
        x = random.multivariate_normal(centre, covariance, size=num, method="eigh", check_valid="ignore")
        drawn = scale * np.where(log, np.exp(np.where(log, x, 0.0)), x)
        inside = ((lower <= drawn) & (drawn <= upper)).all(axis=1)
        kept = np.concatenate([kept, drawn[inside]])[:num]
        if len(kept) == num:
            return kept
    raise NumericalError(f"samples: {len(kept)} of {MOST_ROUNDS * num} draws were within the bounds, {num} expected")

"""Samples to fit and samples to validate (S2: 60/40)."""

from __future__ import annotations

import numpy as np

from tendonlab.arguments import whole, within
from tendonlab.errors import ParameterError
from tendonlab.seed import generator


def split(
    n: int, *, share: float = 0.6, contiguous: bool = True, seed: int | np.random.Generator = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Indices to fit and indices to validate, both increasing; together 0 … n - 1, once each.

    The first `share` of the samples trains (`contiguous`), or a random share of them drawn with `seed`. Neighbouring
    samples of a log are alike, so a random split makes the validation look better than it is. S2 section IV.

    Raises ParameterError where `n` is below 2, `share` leaves one side empty, or `seed` is none."""
    whole("n", n, 2)
    within("share", share, 0.0, 1.0, open_lower=True, open_upper=True)
    num_train = int(np.floor(share * n + 0.5))
    if num_train in (0, n):
        raise ParameterError(f"share = {share} of n = {n}: expected at least one sample on either side")
    order = np.arange(n) if contiguous else generator(seed).permutation(n)
    return np.sort(order[:num_train]), np.sort(order[num_train:])

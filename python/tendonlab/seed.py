"""Randomness comes in as an argument: the same seed, the same numbers."""

from __future__ import annotations

import numpy as np

from tendonlab.errors import ParameterError


def checked(seed: int) -> int:
    """A whole number of at least 0. Raises ParameterError for anything else, None included: what cannot be repeated is
    no result."""
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise ParameterError(f"seed = {seed!r}: expected a whole number of at least 0")
    return int(seed)


def generator(seed: int | np.random.Generator) -> np.random.Generator:
    """The generator itself, or one started from a number. Raises ParameterError as `checked`."""
    return seed if isinstance(seed, np.random.Generator) else np.random.default_rng(checked(seed))

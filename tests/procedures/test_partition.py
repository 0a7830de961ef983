"""Splits: every sample once, on one side."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tendonlab.errors import ParameterError
from tendonlab.procedures import split


@settings(max_examples=50, deadline=None)
@given(n=st.integers(4, 500), share=st.floats(0.2, 0.8), contiguous=st.booleans(), seed=st.integers(0, 2**32))
def test_every_sample_is_on_one_side(n: int, share: float, contiguous: bool, seed: int) -> None:
    train, validation = split(n, share=share, contiguous=contiguous, seed=seed)
    np.testing.assert_array_equal(np.sort(np.concatenate([train, validation])), np.arange(n))
    assert (np.diff(train) > 0).all()
    assert (np.diff(validation) > 0).all()
    assert abs(len(train) - share * n) <= 0.5


def test_the_default_is_the_first_sixty_percent() -> None:
    train, validation = split(10)
    assert train.tolist() == [0, 1, 2, 3, 4, 5]
    assert validation.tolist() == [6, 7, 8, 9]


def test_a_random_split_depends_on_its_seed_alone_and_covers_the_record() -> None:
    one, same, other = (split(1000, contiguous=False, seed=s)[0] for s in (1, np.random.default_rng(1), 2))
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)
    assert np.sum(one < 500) == pytest.approx(300, abs=4 * 7.75)  # hypergeometric: sd 7.75


@pytest.mark.parametrize(("n", "share"), [(1, 0.6), (10, 0.0), (10, 1.0), (10, 0.01), (3, 0.9), (2.5, 0.6)])
def test_a_side_without_samples_is_refused(n: int, share: float) -> None:
    with pytest.raises(ParameterError, match=r"(n|share) = .*: expected"):
        split(n, share=share)

"""Filters over a moving window, against the same by scipy or one window after the other."""

from itertools import permutations

import numpy as np
import pytest
from scipy import ndimage

from tendonlab.checking.moving import (
    STRIDE,
    largest_around,
    median_around,
    running_median,
    weighed_around,
    whole_around,
)

RECORD = np.random.default_rng(4).normal(size=507)


def test_seven_values_in_any_order_have_one_median() -> None:
    orders = np.array(list(permutations(range(7))), dtype=float)
    assert (running_median(orders.ravel())[3::7] == 3.0).all()


def test_windows_agree_with_those_of_scipy() -> None:
    np.testing.assert_array_equal(running_median(RECORD), ndimage.median_filter(RECORD, 7, mode="nearest"))
    np.testing.assert_array_equal(largest_around(RECORD, 7), ndimage.maximum_filter1d(RECORD, 7, mode="nearest"))
    weight = np.array([0.5, -1.0, 0.25, 2.0, 1.0])
    np.testing.assert_allclose(
        weighed_around(RECORD, weight), ndimage.correlate1d(RECORD, weight, mode="nearest"), atol=1e-12
    )


@pytest.mark.parametrize("width", [1, 2, 5, 40])
def test_what_is_whole_has_nothing_broken_in_its_window(width: int) -> None:
    is_whole = RECORD > -2.0
    expected = ndimage.minimum_filter1d(is_whole.astype(int), width, mode="constant", cval=0)
    np.testing.assert_array_equal(whole_around(is_whole, width), expected.astype(bool))


def test_medians_of_many_are_those_of_the_nearest_window_looked_at() -> None:
    found, every = median_around(RECORD, 51), ndimage.median_filter(RECORD, 51, mode="mirror")
    assert found.shape == RECORD.shape
    np.testing.assert_array_equal(found[STRIDE // 2 :: STRIDE], every[STRIDE // 2 :: STRIDE])
    assert set(found) <= set(every)


@pytest.mark.parametrize("num", [1, 3, 8])
def test_medians_of_a_record_shorter_than_a_window_are_of_the_record(num: int) -> None:
    found = median_around(RECORD[:num], 51)
    assert found.shape == (num,)
    assert RECORD[:num].min() <= found.min() <= found.max() <= RECORD[:num].max()


def test_an_empty_record_has_no_sums() -> None:
    assert weighed_around(RECORD[:0], np.ones(3)).shape == (0,)

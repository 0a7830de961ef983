"""From counts to the size that is found 9 times in 10."""

import numpy as np
import pytest

from tendonlab.rehearsal.curve import clopper_pearson, fit_curve, threshold_of

SIZES = [0.5, 1.0, 2.0, 4.0, 8.0]


def test_many_rigs_give_the_size_that_made_the_counts() -> None:
    midpoint, steepness, tried = 1.5, 3.0, 4000
    shares = 1 / (1 + np.exp(-steepness * np.log(np.array(SIZES) / midpoint)))
    found = [round(float(share) * tried) for share in shares]
    threshold = threshold_of(SIZES, found, [tried] * len(SIZES))
    assert threshold.kind == "within"
    assert threshold.size == pytest.approx(midpoint * np.exp(np.log(9) / steepness), rel=0.03)  # P = 0.9, by hand
    low, high = threshold.ci95
    assert low is not None
    assert high is not None
    assert low < threshold.size < high < 1.2 * low


def test_fewer_rigs_give_a_wider_interval() -> None:
    many = fit_curve(SIZES, [0, 20, 100, 100, 100], [100] * 5)
    few = fit_curve(SIZES, [0, 1, 5, 5, 5], [5] * 5)
    widths = [curve.size_at(0.9, 0.975) / curve.size_at(0.9, 0.025) for curve in (many, few)]
    assert widths[0] < widths[1]


def test_the_curve_rises_whatever_the_counts() -> None:
    mean, low, high = fit_curve(SIZES, [5, 3, 1, 4, 2], [5] * 5).probability(np.array(SIZES))
    assert (np.diff(mean) >= 0).all()
    assert (low <= mean).all()
    assert (mean <= high).all()


def test_what_is_never_found_lies_above_the_sizes_tried() -> None:
    threshold = threshold_of(SIZES, [0] * 5, [6] * 5)
    assert threshold.kind == "above"
    assert threshold.size == 8.0


def test_a_share_that_stays_below_nine_in_ten_lies_above_the_sizes_tried() -> None:
    assert threshold_of(SIZES, [12, 13, 14, 14, 15], [20] * 5).kind == "above"


def test_what_is_always_found_lies_below_the_sizes_tried() -> None:
    threshold = threshold_of(SIZES, [20] * 5, [20] * 5)
    assert threshold.kind == "below"
    assert threshold.size == 0.5


@pytest.mark.parametrize(
    ("hits", "num", "low", "high"),
    [(0, 20, 0.0, 0.1684), (20, 20, 0.8316, 1.0), (3, 10, 0.0667, 0.6525), (0, 0, 0.0, 1.0)],  # published tables
)
def test_clopper_pearson(hits: int, num: int, low: float, high: float) -> None:
    assert clopper_pearson(hits, num) == pytest.approx((low, high), abs=1e-4)

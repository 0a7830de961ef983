"""Intervals where residuals are not independent."""

import numpy as np
import pytest
from scipy import stats

from tendonlab._core import Free
from tendonlab.fitting.uncertainty import _correlation, informed, uncertainty

MEAN = Free(name="joint_coulomb", index=0, log=False, scale=1.0, start=0.0)
BLOCKS, LENGTH = 400, 25


def sd_of_mean(residual: np.ndarray) -> float:
    """Of a constant that is fitted to `residual`, in blocks of LENGTH samples."""
    rows = np.arange(len(residual))
    parts = [rows // LENGTH == block for block in range(BLOCKS)]
    run = (residual, np.ones((len(rows), 1)), parts)
    found = uncertainty([run], [MEAN], np.zeros(1), at_bound=[False], informed=[True])
    half = 0.5 * (found.upper[0] - found.lower[0])
    assert half == pytest.approx(1.96 * found.sd[0], rel=0.01)  # Student's t with 400 clusters
    return float(found.sd[0])


def test_a_residual_that_stays_for_a_block_is_one_measurement() -> None:
    random = np.random.default_rng(2)
    independent = random.normal(size=BLOCKS * LENGTH)
    assert sd_of_mean(independent) == pytest.approx((BLOCKS * LENGTH) ** -0.5, rel=0.1)
    assert sd_of_mean(np.repeat(random.normal(size=BLOCKS), LENGTH)) == pytest.approx(BLOCKS**-0.5, rel=0.1)


def free(name: str, *, sd: float = np.inf, mean: float = 0.0) -> Free:
    return Free(name=name, index=0, log=False, scale=2.0, start=0.0, mean=mean, sd=sd)


def straight_line(num: int, sd: float) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """Residuals of size `sd` under an offset and a slope, in clusters of one sample."""
    residual = sd * np.random.default_rng(5).standard_normal(num)
    slopes = np.column_stack([np.ones(num), np.linspace(0.0, 1.0, num)])
    return residual, slopes, [np.arange(num) // 10 == k for k in range(num // 10)]


def test_independent_residuals_leave_the_covariance_of_least_squares() -> None:
    """Offset and slope on [0, 1]: variances 4/n and 12/n, correlation -√3/2; a value is twice its coordinate."""
    pair = [free("offset"), free("slope")]
    x = np.array([0.3, -0.1])
    found = uncertainty([straight_line(4000, 1.0)], pair, x, at_bound=[False] * 2, informed=[True] * 2)
    assert found.sd == pytest.approx(2.0 * np.sqrt(np.array([4.0, 12.0]) / 4000), rel=0.1)
    assert found.correlations[0, 1] == pytest.approx(-np.sqrt(0.75), abs=0.05)
    assert np.diag(found.correlations) == pytest.approx([1.0, 1.0])
    assert 0.5 * (found.upper + found.lower) == pytest.approx(2.0 * x)


@pytest.mark.parametrize("size", [0.3, 3.0])
def test_residuals_larger_than_the_noise_widen_and_smaller_ones_do_not_narrow(size: float) -> None:
    pair = [free("offset"), free("slope")]
    run = straight_line(4000, size)
    found = uncertainty([run], pair, np.zeros(2), at_bound=[False] * 2, informed=[True] * 2)
    usual = 2.0 * max(size, 1.0) * np.sqrt(np.array([4.0, 12.0]) / 4000)
    assert found.sd == pytest.approx(usual, rel=0.1)
    fewer = uncertainty([run], pair, np.zeros(2), at_bound=[False] * 2, informed=[True] * 2, count=1000.0)
    more = 2.0 if size > 1 else 1.0  # four times the misfit per independent row
    assert fewer.sd == pytest.approx(more * usual, rel=0.1)


def test_a_parameter_at_a_bound_is_fixed_for_the_others_and_keeps_its_own_sd() -> None:
    pair = [free("offset"), free("slope")]
    found = uncertainty([straight_line(4000, 1.0)], pair, np.zeros(2), at_bound=[False, True], informed=[True] * 2)
    assert found.sd == pytest.approx(2.0 * np.sqrt(np.array([1.0, 12.0]) / 4000), rel=0.1)
    assert found.correlations[0, 1] == 0.0


def test_what_no_residual_sees_is_what_its_prior_says() -> None:
    pair = [free("offset"), free("unseen", sd=0.5, mean=0.2)]
    residual, slopes, parts = straight_line(1000, 1.0)
    run = (residual, slopes * [1.0, 0.0], parts)
    found = uncertainty([run], pair, np.array([0.0, 0.2]), at_bound=[False] * 2, informed=[True, False])
    assert found.sd == pytest.approx([2.0 / np.sqrt(1000), 1.0], rel=0.1)
    assert (found.lower[1], found.upper[1]) == pytest.approx((0.4 - 1.96, 0.4 + 1.96), abs=1e-3)


def test_a_prior_and_data_that_say_as_much_halve_the_variance() -> None:
    belief = free("offset", sd=1000**-0.5)
    residual, slopes, parts = straight_line(1000, 1.0)
    found = uncertainty([(residual, slopes[:, :1], parts)], [belief], np.zeros(1), at_bound=[False], informed=[True])
    assert found.sd[0] == pytest.approx(2.0 * 2000**-0.5, rel=0.1)


@pytest.mark.parametrize(("num", "clusters"), [(3, 30), (6, 6)])
def test_with_four_experiments_or_more_each_is_a_cluster(num: int, clusters: int) -> None:
    """A residual that stays throughout an experiment is one measurement where experiments are the clusters: then the sd
    is the scatter of their means, with Student's t for so few. With three, blocks are the clusters."""
    levels = np.random.default_rng(0).standard_normal(num)
    levels = (levels - levels.mean()) / levels.std()
    parts = [np.arange(100) // 10 == k for k in range(10)]
    runs = [(np.full(100, 9.0 * level), np.ones((100, 1)), parts) for level in levels]
    found = uncertainty(runs, [free("offset")], np.zeros(1), at_bound=[False], informed=[True])
    expected = 9.0 / np.sqrt(clusters) * np.sqrt(clusters / (clusters - 1))
    assert found.sd[0] == pytest.approx(2.0 * expected)
    half = 0.5 * (found.upper[0] - found.lower[0])
    assert half == pytest.approx(stats.t.ppf(0.975, clusters - 1) * found.sd[0])


def test_informed_is_what_narrows_its_prior() -> None:
    frees = [free("seen", sd=1.0), free("unseen", sd=1.0), free("wide", sd=1e6), free("faint"), free("sharp", sd=1e-6)]
    jacobian = np.zeros((50, 5))
    jacobian[:, [0, 2, 3, 4]] = [1.0, 1e-6, 1e-3, 1.0]
    assert informed([jacobian, jacobian], frees).tolist() == [True, False, True, True, False]


def test_what_has_no_variance_is_correlated_with_nothing() -> None:
    """Derivatives of 1e160 leave variances below what doubles hold: 0 in the table, and no overflow."""
    assert _correlation(np.array([[1e-320, 1e-10], [1e-10, 4.0]])).tolist() == [[1.0, 0.0], [0.0, 1.0]]
    assert _correlation(np.array([[1.0, 1.0], [1.0, 4.0]])) == pytest.approx(np.array([[1.0, 0.5], [0.5, 1.0]]))

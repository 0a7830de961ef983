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


def levels_of_experiments(levels: np.ndarray) -> tuple[float, float]:
    """Sd and half interval of a constant, from experiments of ten blocks whose residuals stay throughout."""
    parts = [np.arange(100) // 10 == k for k in range(10)]
    runs = [(np.full(100, level), np.ones((100, 1)), parts) for level in levels]
    found = uncertainty(runs, [MEAN], np.zeros(1), at_bound=[False], informed=[True])
    return found.sd[0], 0.5 * (found.upper[0] - found.lower[0])


@pytest.mark.parametrize("num", [3, 6])
def test_from_four_experiments_on_their_scatter_counts(num: int) -> None:
    """A residual that stays throughout an experiment is one measurement. The variance of a mean is that over all blocks
    with three experiments; with six it is pooled with that over the experiments, as if two more agreed with blocks."""
    levels = np.random.default_rng(0).standard_normal(num)
    levels *= 9.0 / np.sqrt(np.mean(levels**2))
    blocks, experiments = 81.0 / (10 * num - 1), 81.0 / (num - 1)
    pooled = (2 * blocks + (num - 1) * experiments) / (num + 1)
    variance, freedom = (pooled, num + 1) if num >= 4 else (blocks, 10 * num - 1)
    sd, half = levels_of_experiments(levels)
    assert sd == pytest.approx(np.sqrt(variance))
    assert half == pytest.approx(stats.t.ppf(0.975, freedom) * sd)


@pytest.mark.parametrize(("scatter", "least", "widest"), [(0.0, 0.96, 1.4), (1.0, 0.93, 1.4)])
def test_intervals_of_four_experiments_hold_the_truth(scatter: float, least: float, widest: float) -> None:
    """`scatter`: variance that an experiment adds to that of its ten blocks' mean."""
    draw, held, halves = np.random.default_rng(3), [], []
    for _ in range(400):
        blocks = draw.standard_normal((4, 10)) + np.sqrt(0.1 * scatter) * draw.standard_normal((4, 1))
        parts = [np.arange(10) == k for k in range(10)]
        runs = [(one - blocks.mean(), np.ones((10, 1)), parts) for one in blocks]
        found = uncertainty(runs, [MEAN], np.zeros(1), at_bound=[False], informed=[True])
        halves.append(0.5 * (found.upper[0] - found.lower[0]))
        held.append(abs(blocks.mean()) < halves[-1])
    assert np.mean(held) > least
    assert np.mean(halves) / (1.96 * np.sqrt(0.1 * (1.0 + scatter) / 4)) < widest


def test_informed_is_what_narrows_its_prior() -> None:
    frees = [free("seen", sd=1.0), free("unseen", sd=1.0), free("wide", sd=1e6), free("faint"), free("sharp", sd=1e-6)]
    jacobian = np.zeros((50, 5))
    jacobian[:, [0, 2, 3, 4]] = [1.0, 1e-6, 1e-3, 1.0]
    assert informed([jacobian, jacobian], frees).tolist() == [True, False, True, True, False]


def test_what_has_no_variance_is_correlated_with_nothing() -> None:
    """Derivatives of 1e160 leave variances below what doubles hold: 0 in the table, and no overflow."""
    assert _correlation(np.array([[1e-320, 1e-10], [1e-10, 4.0]])).tolist() == [[1.0, 0.0], [0.0, 1.0]]
    assert _correlation(np.array([[1.0, 1.0], [1.0, 4.0]])) == pytest.approx(np.array([[1.0, 0.5], [0.5, 1.0]]))


def test_exploded_derivatives_leave_unbounded_intervals_and_no_nan() -> None:
    residual, slopes, parts = straight_line(100, 0.1)
    found = uncertainty(
        [(residual, 1e160 * slopes, parts)], [free("offset"), free("slope")], np.zeros(2), at_bound=[False] * 2,
        informed=[True] * 2,
    )  # fmt: skip
    assert not np.isnan(np.concatenate([found.sd, found.lower, found.upper, found.correlations.ravel()])).any()
    assert np.isinf(found.sd).all()

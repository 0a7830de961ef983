"""The regression of the equation of motion: the minimum of its own posterior, found by an independent minimiser, with
and without unknowns that cannot be negative."""

import numpy as np
import pytest
from scipy import optimize, stats

from tendonlab.checking.regression import FREEDOM, Unknown, fit, growth

RNG = np.random.default_rng(5)
NUM = 400
COLUMNS = RNG.standard_normal((2, 2, NUM)) + np.array([1.0, 0.5])[:, None, None]
SIZE, SHARE = np.array([2.0, 30.0]), np.array([0.5, 0.25])
NOISE = np.array([0.1, 3.0])[:, None] * RNG.standard_t(4.0, (2, NUM))


def posterior(x: np.ndarray, level: np.ndarray, residual: np.ndarray, logarithm: bool) -> float:
    """Negative log density of the noise, Student's t of `level` per equation, and of the belief, normal of sd 0.5."""
    amount = np.array([np.exp(x[0]) - 1.0 if logarithm else x[0], x[1]])
    noise = (residual + np.tensordot(amount, COLUMNS, axes=1)) / SIZE[:, None]
    density = stats.t(FREEDOM).logpdf(noise / level[:, None]) - stats.t(FREEDOM).logpdf(0.0) - np.log(level)[:, None]
    return float(-SHARE @ density.sum(axis=1) + 0.5 * np.sum(x**2) / 0.5**2)


@pytest.mark.parametrize("logarithm", [False, True])
def test_a_fit_is_the_most_probable_point(logarithm: bool) -> None:
    true = np.array([0.3, -0.2])
    amount = np.array([np.expm1(true[0]) if logarithm else true[0], true[1]])
    residual = NOISE - np.tensordot(amount, COLUMNS, axes=1)
    unknowns = (Unknown("a", sd=0.5, logarithm=logarithm), Unknown("b", sd=0.5))
    found = fit(residual, COLUMNS, unknowns, SIZE, SHARE)

    best = optimize.minimize(lambda x: posterior(x, found.level, residual, logarithm), np.zeros(2), tol=1e-10)
    assert found.x == pytest.approx(best.x, abs=1e-4)  # where the steps of the regression end
    assert found.x == pytest.approx(true, abs=0.05)
    assert found.cost == pytest.approx(posterior(found.x, found.level, residual, logarithm), rel=1e-9)
    assert found.strain == pytest.approx(np.max(np.abs(found.x)) / 0.5)
    left = residual + np.tensordot([np.expm1(found.x[0]) if logarithm else found.x[0], found.x[1]], COLUMNS, axes=1)
    np.testing.assert_allclose(found.residual, left, atol=1e-12)
    # the scale of the noise of each equation is known to a few percent from 400 samples
    assert found.level == pytest.approx([0.1 / 2.0, 3.0 / 30.0], rel=0.1)


@pytest.mark.parametrize("positive", [False, True])
def test_an_unknown_that_cannot_be_negative_ends_at_zero_and_the_other_one_allows_for_it(positive: bool) -> None:
    residual = NOISE - np.tensordot([-0.2, 0.3], COLUMNS, axes=1)
    unknowns = (Unknown("a", sd=0.5, positive=positive), Unknown("b", sd=0.5))
    found = fit(residual, COLUMNS, unknowns, SIZE, SHARE)
    bounds = [(0.0 if positive else None, None), (None, None)]
    best = optimize.minimize(
        lambda x: posterior(x, found.level, residual, False), np.zeros(2), bounds=bounds, tol=1e-10
    )
    assert found.x == pytest.approx(best.x, abs=1e-4)
    assert (found.x[0] == 0.0) == positive


def test_the_sd_of_a_fit_is_that_of_weighted_least_squares() -> None:
    """The mean weight of Student's t noise is 1, so that n samples of scale s and a column of rms 1 leave s/√n."""
    noise = 0.1 * RNG.standard_t(FREEDOM, (1, 4000))
    column = RNG.standard_normal((1, 1, 4000))
    found = fit(noise, column, (Unknown("a", sd=10.0),), np.ones(1), np.ones(1))
    assert found.sd[0] == pytest.approx(0.1 / np.sqrt(4000), rel=0.05)
    quarter = fit(noise, column, (Unknown("a", sd=10.0),), np.ones(1), np.full(1, 0.25))
    assert quarter.sd[0] == pytest.approx(2.0 * found.sd[0], rel=0.01)
    alone = fit(noise, 0.0 * column, (Unknown("a", sd=10.0),), np.ones(1), np.ones(1))
    assert (alone.x[0], alone.sd[0]) == (0.0, pytest.approx(10.0, rel=1e-6))


def test_outliers_lose_their_say() -> None:
    column = np.ones((1, 1, 1000))
    values = 0.01 * RNG.standard_normal((1, 1000))
    values[0, ::50] = 100.0
    assert abs(fit(values, column, (Unknown("a", sd=100.0),), np.ones(1), np.ones(1)).x[0]) < 0.01


def test_what_has_no_value_costs_infinitely_much() -> None:
    residual, column = np.ones((1, 10)), np.full((1, 1, 10), 1e300)
    found = fit(residual, column, (Unknown("a", sd=1.0),), np.ones(1), np.ones(1))
    assert found.cost == np.inf
    assert np.isinf(found.level).all()


def test_the_scale_and_the_weights_of_a_fit_agree_with_each_other() -> None:
    """At the scale of Student's t the weighted mean square is its square; a sample at the scale weighs 1."""
    noise = 0.3 * np.random.default_rng(1).standard_t(FREEDOM, (1, 5000))
    found = fit(noise, np.ones((1, 1, 5000)), (Unknown("a", sd=1.0),), np.ones(1), np.ones(1))
    assert found.level == pytest.approx([0.3], rel=0.06)  # 5000 samples
    assert np.mean(found.weight * found.residual**2) == pytest.approx(found.level[0] ** 2, rel=1e-3)
    assert found.weight == pytest.approx(5.0 / (4.0 + (found.residual / found.level[:, None]) ** 2), rel=1e-3)


def test_a_column_grows_with_the_exponential_of_its_unknown() -> None:
    unknowns = (Unknown("a", sd=1.0, logarithm=True), Unknown("b", sd=1.0))
    assert growth(np.array([0.7, 0.7]), unknowns) == pytest.approx([np.exp(0.7), 1.0])

"""Global search: finds the optimum among many, says what is not known, repeats itself."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt

from tendonlab.errors import NumericalError, ParameterError
from tendonlab.procedures import SearchResult, global_search

X = np.linspace(0.1, 5.0, 88)
METHODS = ["multistart", "evolution"]


def bump(values: np.ndarray) -> np.ndarray:
    """A hump of a height and width, and a straight line."""
    return np.asarray(values[0] * np.exp(-((X / values[1]) ** 2)) + values[2] * X + values[3])


TRUTH = np.array([0.3, 1.2, 0.05, 0.02])
LOWER, UPPER = [0.0, 0.1, 0.0, -0.5], [1.0, 10.0, 1.0, 0.5]
NOISE = 0.01 * np.random.default_rng(0).normal(size=len(X))


def waves(values: np.ndarray) -> np.ndarray:
    """A sine's frequency: some ten optima between the bounds, one of them right."""
    return np.asarray(np.sin(values[0] * X) - np.sin(7.3 * X))


@pytest.mark.parametrize("method", METHODS)
def test_the_right_one_of_many_optima_is_found(method: str) -> None:
    found = global_search(waves, [0.5], [20.0], starts=30, method=method)
    assert found.values == pytest.approx([7.3], rel=1e-9)
    assert found.success
    alone = global_search(waves, [0.5], [20.0], starts=1)
    assert alone.cost > 1.0  # what a single start ends in


@pytest.mark.parametrize("method", METHODS)
def test_clean_data_give_the_parameters_back(method: str) -> None:
    found = global_search(lambda p: (bump(p) - bump(TRUTH)) / 0.01, LOWER, UPPER, starts=20, method=method)
    assert found.values == pytest.approx(TRUTH, rel=1e-7)
    assert found.hessian_rank == 4
    assert not found.at_bound.any()


def test_the_fit_of_a_straight_line_has_the_textbook_sd() -> None:
    """Linear least squares: sd^2 = s^2 (X'X)^-1 with s^2 = residual sum of squares / (n - 2)."""
    y = 2.0 + 3.0 * X + NOISE
    found = global_search(lambda p: p[0] + p[1] * X - y, [-10.0, -10.0], [10.0, 10.0], starts=3)
    line, covariance = np.polyfit(X, y, 1, cov="unscaled")
    left = y - np.polyval(line, X)
    assert found.values == pytest.approx(line[::-1], rel=1e-8)
    assert found.cost == pytest.approx(0.5 * left @ left, rel=1e-10)
    assert found.sd == pytest.approx(np.sqrt(np.diag(covariance)[::-1] * (left @ left) / (len(X) - 2)), rel=1e-6)
    np.testing.assert_allclose(found.jacobian, np.column_stack([np.ones_like(X), X]), rtol=1e-7)
    np.testing.assert_allclose(found.residual, -left, rtol=0, atol=1e-8)


def test_both_methods_end_in_the_same_digits() -> None:
    """Whatever they found roughly is polished."""
    y = bump(TRUTH) + NOISE
    one, other = (global_search(lambda p: (bump(p) - y) / 0.01, LOWER, UPPER, starts=10, method=m) for m in METHODS)
    assert one.values == pytest.approx(other.values, rel=1e-6)
    assert one.cost == pytest.approx(other.cost, rel=1e-12)


def test_the_sd_covers_the_truth() -> None:
    """100 seeds of noise: the truth lies within 2 sd in 95 % of them; four sd of that count are 8.7 %."""
    inside = []
    for seed in range(100):
        y = bump(TRUTH) + 0.01 * np.random.default_rng(seed).normal(size=len(X))
        found = global_search(lambda p, y=y: (bump(p) - y) / 0.01, LOWER, UPPER, starts=2)
        inside.append(np.abs(found.values - TRUTH) < 2.0 * found.sd)
    assert np.mean(inside, axis=0) == pytest.approx(np.full(4, 0.95), abs=0.087)


def test_an_optimum_outside_ends_on_the_bound_and_says_so() -> None:
    """Descents inside the box only come near a bound; the result lies on it, and the others' sd take it as fixed."""
    y = bump(TRUTH) - 0.1 + NOISE
    found = global_search(lambda p: (bump(p) - y) / 0.01, [0.0, 0.1, -1.0, 0.0], UPPER, starts=10)
    assert found.at_bound.tolist() == [False, False, False, True]
    assert found.values[3] == 0.0
    assert math.isnan(found.sd[3])
    held = global_search(lambda p: (bump(np.append(p, 0.0)) - y) / 0.01, [0.0, 0.1, -1.0], UPPER[:3], starts=10)
    assert found.values[:3] == pytest.approx(held.values, rel=1e-6)
    # one more parameter in the count of spare data than where it is held: none, since it counts as fixed
    assert found.sd[:3] == pytest.approx(held.sd, rel=1e-4)


def test_what_data_cannot_tell_apart_has_no_sd_and_lowers_the_rank() -> None:
    """Two offsets of which only the sum shows."""
    y = bump(TRUTH) + NOISE
    found = global_search(lambda p: (bump(p[:4]) + p[4] - y) / 0.01, [*LOWER, -0.5], [*UPPER, 0.5], starts=10)
    assert found.hessian_rank == 4
    assert np.isinf(found.sd).tolist() == [False, False, False, True, True]
    assert found.values[3] + found.values[4] == pytest.approx(0.02, abs=0.02)


def test_a_parameter_without_effect_has_no_sd() -> None:
    found = global_search(lambda p: p[0] * X - 0.3 * X + NOISE, [0.0, 0.0], [1.0, 1.0], starts=3)
    assert found.hessian_rank == 1
    assert np.isfinite(found.sd[0])
    assert np.isinf(found.sd[1])


@pytest.mark.parametrize("method", METHODS)
def test_decades_are_searched_on_a_logarithmic_scale(method: str) -> None:
    """A time constant of a millisecond between a microsecond and a second."""
    time = np.linspace(0.0, 5e-3, 50)

    def step(p: np.ndarray) -> np.ndarray:
        return np.asarray(np.exp(-time / p[0]) - np.exp(-time / 1e-3))

    found = global_search(step, [1e-6], [1.0], starts=8, method=method, log=[True])
    assert found.values == pytest.approx([1e-3], rel=1e-6)
    by_hand = time / 1e-3**2 * np.exp(-time / 1e-3)
    np.testing.assert_allclose(found.jacobian[:, 0], by_hand, rtol=0, atol=1e-6 * by_hand.max())


@pytest.mark.parametrize("method", METHODS)
def test_the_same_seed_gives_the_same_bits(method: str) -> None:
    def search(seed: int | np.random.Generator) -> SearchResult:
        return global_search(lambda p: waves(p) + 10.0 * NOISE, [0.5], [20.0], starts=6, method=method, seed=seed)

    first, again, generator, other = (search(seed) for seed in (4, 4, np.random.default_rng(4), 5))
    np.testing.assert_array_equal(first.costs, again.costs)
    np.testing.assert_array_equal(first.values, again.values)
    np.testing.assert_array_equal(first.costs, generator.costs)
    assert not np.array_equal(first.costs, other.costs)


def test_starts_that_fail_do_not_stop_the_others() -> None:
    """The model is not finite over half of the box."""

    def half(p: np.ndarray) -> np.ndarray:
        return np.full(10, np.nan) if p[0] < 0.0 else (p[0] - 0.4) * np.ones(10)

    found = global_search(half, [-1.0], [1.0], starts=20)
    assert found.values == pytest.approx([0.4])
    assert 0 < np.sum(np.isinf(found.costs)) < 20
    with pytest.raises(NumericalError, match="residual is not finite from any of 5 starts"):
        global_search(lambda p: np.full(3, np.inf), [0.0], [1.0], starts=5)
    with pytest.raises(NumericalError, match="residual is not finite for any of 5 members"):
        global_search(lambda p: np.full(3, np.nan), [0.0], [1.0], starts=5, method="evolution")


def test_an_error_of_the_residual_is_not_swallowed() -> None:
    """Neither at the start nor on the way, where one of least squares' own would only cost that start."""

    def broken(p: np.ndarray) -> np.ndarray:
        if p[0] > 0.7:
            raise ValueError("tension_in is missing")
        return p - 0.8

    for starts in (1, 20):
        with pytest.raises(ValueError, match="tension_in is missing"):
            global_search(broken, [0.0], [1.0], starts=starts, seed=1)


def test_an_interrupted_search_keeps_what_is_done() -> None:
    calls = 0

    def interrupted(p: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        if calls == 200:
            raise KeyboardInterrupt
        return waves(p)

    found = global_search(interrupted, [0.5], [20.0], starts=60)
    assert not found.success
    assert found.message.startswith(f"interrupted after {len(found.costs)} of 60 starts")
    assert found.cost == pytest.approx(found.costs.min())


def test_the_message_counts_who_agrees_and_the_plot_shows_it() -> None:
    found = global_search(lambda p: (bump(p) - bump(TRUTH)) / 0.01, LOWER, UPPER, starts=20)
    agree = int(found.message.split()[0])
    assert agree >= 5
    assert "of 20 starts ended at the best cost" in found.message
    axes = found.plot(plt.figure().subplots())
    assert axes.get_xlabel()
    assert axes.get_ylabel()
    assert len(axes.lines[0].get_xdata()) == 20
    plain = found.to_dict()
    assert plain["values"] == found.values.tolist()
    assert plain["hessian_rank"] == 4


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"upper": [1.0]}, "upper has 1 values: expected 2, as many as lower"),
        ({"upper": [0.0, 1.0]}, r"upper\[0\] = 0.0: expected a bound above lower\[0\] = 0.0"),
        ({"upper": [np.inf, 1.0]}, r"upper\[0\] = inf: expected a finite number"),
        ({"log": [True, False]}, r"lower\[0\] = 0.0: expected a bound above 0 on a logarithmic scale"),
        ({"log": [True]}, r"log has shape \(1,\): expected \(2,\)"),
        ({"starts": 0}, "starts = 0: expected a whole number of at least 1"),
        ({"starts": 4, "method": "evolution"}, "starts = 4: expected a whole number of at least 5"),
        ({"method": "annealing"}, "method = 'annealing': .*expected one of multistart, evolution"),
        ({"residual": lambda p: 1.0}, r"residual gives shape \(\): expected one row of numbers"),
    ],
)
def test_bad_input_is_named(options: dict[str, Any], message: str) -> None:
    given = {"residual": lambda p: p, "lower": [0.0, 0.0], "upper": [1.0, 1.0]} | options
    with pytest.raises(ParameterError, match=message):
        global_search(given.pop("residual"), given.pop("lower"), given.pop("upper"), **given)

"""The smoothing spline: scipy's at a given lambda, and the lambda of least GCV, which scipy's search can miss."""

import numpy as np
import pytest
from scipy.interpolate import make_smoothing_spline

from tendonlab.simulation.smoothing import SEARCHED, Smoother, smoothing_spline


def record(*, step: float, noise: float, num: int = 400, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    time = step * (np.arange(num) + rng.uniform(-0.3, 0.3, num))
    return time, np.sin(4.0 * time) + noise * rng.normal(size=num)


@pytest.mark.parametrize("log_lambda", [-8.0, 0.0, 8.0, 16.0])
def test_for_a_lambda_it_is_the_spline_of_scipy(log_lambda: float) -> None:
    time, values = record(step=1.0, noise=0.1)
    found, _ = Smoother.of(time, values).solve(log_lambda)
    known = make_smoothing_spline(time, values, lam=float(np.exp(log_lambda)))
    np.testing.assert_allclose(found, known(time), atol=1e-9)


@pytest.mark.parametrize("log_lambda", [-8.0, 0.0, 8.0, 16.0])
def test_the_freedom_left_is_the_trace_of_one_minus_the_smoother(log_lambda: float) -> None:
    time, _ = record(step=1.0, noise=0.1, num=30)
    columns = [Smoother.of(time, one).solve(log_lambda) for one in np.eye(30)]
    trace = 30.0 - sum(float(fitted[k]) for k, (fitted, _) in enumerate(columns))
    assert columns[0][1] == pytest.approx(trace, rel=1e-9)


def test_the_gcv_is_the_mean_square_residual_over_the_squared_share_of_freedom() -> None:
    time, values = record(step=1.0, noise=0.1)
    fitted, freedom = Smoother.of(time, values).solve(2.0)
    expected = np.mean(np.square(values - fitted)) / (freedom / len(values)) ** 2
    assert Smoother.of(time, values).score(2.0) == pytest.approx(expected)


@pytest.mark.parametrize("noise", [1e-4, 1e-2])
@pytest.mark.parametrize("step", [1e-3, 0.02, 1.0])
def test_no_lambda_has_a_smaller_gcv(step: float, noise: float) -> None:
    time, values = record(step=step, noise=noise)
    smoother = Smoother.of(time / step, values)
    assert smoother.score(smoother.best()) <= min(smoother.score(x) for x in np.arange(*SEARCHED, 0.25)) * (1 + 1e-6)


@pytest.mark.parametrize("step", [1e-3, 2e-3, 0.02])
@pytest.mark.parametrize("noise", [1e-4, 1e-2])
def test_it_comes_nearer_to_the_truth_than_the_samples(step: float, noise: float) -> None:
    """Also with 2000 samples in 2 or in 40 s, where a search over lambda itself ends in a straight line."""
    time, values = record(step=step, noise=noise, num=2000)
    assert np.std(smoothing_spline(time, values)(time) - np.sin(4.0 * time)) < 0.8 * noise


def test_a_long_record_keeps_its_speed() -> None:
    time, values = record(step=1e-3, noise=1e-3, num=20_000)
    error = smoothing_spline(time, values)(time, 1) - 4.0 * np.cos(4.0 * time)
    assert np.sqrt(np.mean(error**2)) < 0.01


@pytest.mark.parametrize("unit", [1e-3, 60.0])
def test_the_unit_of_time_does_not_matter(unit: float) -> None:
    time, values = record(step=0.01, noise=1e-4)
    seconds, others = smoothing_spline(time, values), smoothing_spline(unit * time, values)
    np.testing.assert_allclose(others(unit * time), seconds(time), atol=1e-9)
    np.testing.assert_allclose(unit * others(unit * time, 1), seconds(time, 1), atol=1e-6)

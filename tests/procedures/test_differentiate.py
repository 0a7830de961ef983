"""Velocity from position: exact on what each method is exact on, and how noise comes through."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tendonlab.errors import ParameterError
from tendonlab.procedures import velocity
from tendonlab.procedures.differentiate import window_samples

TIME = np.arange(0.0, 10.0, 1e-3)
POSITION, SPEED = np.sin(2.0 * TIME), 2.0 * np.cos(2.0 * TIME)


@settings(max_examples=50, deadline=None)
@given(coefficients=st.tuples(*[st.floats(-5.0, 5.0)] * 4))
def test_savgol_is_exact_on_cubics_to_the_ends(coefficients: tuple[float, ...]) -> None:
    time = TIME[:200] * 10.0
    cubic = np.polynomial.Polynomial(coefficients)
    found = velocity(time, cubic(time), method="savgol", window=0.35)
    np.testing.assert_allclose(found, cubic.deriv()(time), rtol=0, atol=1e-9)


def test_central_differences_are_exact_on_parabolas_unevenly_sampled() -> None:
    time = np.cumsum(np.random.default_rng(0).uniform(0.5e-3, 2e-3, size=500))
    np.testing.assert_allclose(velocity(time, 3.0 * time**2 - time), 6.0 * time - 1.0, rtol=0, atol=1e-9)


def test_central_differences_have_second_order() -> None:
    """Half the interval, a quarter of the error."""
    errors = [np.max(np.abs(velocity(TIME[::k], POSITION[::k]) - SPEED[::k])) for k in (8, 4)]
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.01)


@pytest.mark.parametrize("method", ["central", "spline", "savgol"])
def test_every_method_finds_the_velocity_of_a_clean_record(method: str) -> None:
    """Central: h^2/6 max|x'''| = 1.3e-6, twice that at the ends; the others do better."""
    assert np.max(np.abs(velocity(TIME, POSITION, method=method) - SPEED)) < 3e-6


def test_noise_of_savgol_falls_with_the_window_to_the_power_of_three_halves() -> None:
    """sd of the slope over n samples of white noise ~ n^-1.5: four times the window, an eighth of the noise."""
    noise = np.random.default_rng(1).normal(size=len(TIME))
    narrow, wide = (np.std(velocity(TIME, noise, method="savgol", window=w)[500:-500]) for w in (0.041, 0.161))
    assert narrow / wide == pytest.approx((161 / 41) ** 1.5, rel=0.15)  # 60 independent windows of the wide one


def test_the_spline_learns_the_noise_from_the_record() -> None:
    """Uneven sampling and noise of 0.2 % of the motion: central differences drown, the spline stays within 1 %."""
    rng = np.random.default_rng(2)
    time = np.cumsum(rng.uniform(0.5e-3, 1.5e-3, size=8000))
    noisy = np.sin(2.0 * time) + 0.002 * rng.normal(size=len(time))
    true = 2.0 * np.cos(2.0 * time)
    smooth, rough = velocity(time, noisy, method="spline"), velocity(time, noisy)
    assert np.std(smooth - true) < 0.01 * np.max(true)
    assert np.std(rough - true) > 0.5 * np.max(true)


def test_the_spline_does_not_follow_the_steps_of_an_encoder() -> None:
    """Slow motion seen in 50 steps: most samples repeat, so differences are 0 or a whole step a sample, 20 rad/s."""
    quantised = np.round(POSITION / 0.02) * 0.02
    assert np.std(velocity(TIME, quantised, method="spline") - SPEED) < 0.02 * 2.0


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("method", ["central", "spline", "savgol"])
def test_units_and_origin_do_not_matter(method: str, scale: float) -> None:
    noisy = POSITION[:3000] + 1e-3 * np.random.default_rng(4).normal(size=3000)
    expected = velocity(TIME[:3000], noisy, method=method)
    moved = velocity(TIME[:3000] + 100.0, scale * (noisy + 2.0), method=method) / scale
    np.testing.assert_allclose(moved, expected, rtol=0, atol=1e-6 * np.max(np.abs(expected)))


@pytest.mark.parametrize("method", ["central", "spline", "savgol"])
def test_standstill_has_no_velocity(method: str) -> None:
    np.testing.assert_allclose(velocity(TIME, np.full(len(TIME), 1.7), method=method), 0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("time", "values", "options", "message"),
    [
        (TIME[:2], POSITION[:2], {}, "time has 2 samples: expected at least 3"),
        (TIME, POSITION[1:], {}, "values has 9999 samples: expected 10000, as many as time"),
        (TIME[[0, 1, 3, 2, 4]], POSITION[:5], {}, r"time\[3\] = 0.002 s after 0.003 s: expected time to increase"),
        (TIME, POSITION, {"method": "savgol", "window": 21}, "window = 21: expected a value in"),
        (TIME, POSITION, {"method": "savgol", "window": 0.001}, "window = 0.001: expected a value in"),
        (TIME**1.1, POSITION, {"method": "savgol"}, r"time\[1\] - time\[0\] = .*: expected even sampling"),
        (TIME, POSITION, {"window": 0.1}, "window = 0.1: expected None"),
        (TIME, POSITION, {"method": "centre"}, "method = 'centre': did you mean 'central'"),
        (TIME[:9], POSITION[:9], {"method": "spline"}, "time has 9 samples: expected at least 10"),
        (TIME, np.full(10_000, np.inf), {}, r"values\[0\] = inf: expected a finite number"),
    ],
)
def test_bad_input_is_named(time: Any, values: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        velocity(time, values, **options)


@pytest.mark.parametrize(
    ("num", "window", "expected"),
    [
        (100, None, 21), (22, None, 21), (21, None, 21), (20, None, 19), (7, None, 7),
        (100, 0.055, 5), (100, 0.2, 21), (100, 0.21, 21), (100, 0.22, 23), (100, 0.99, 99), (101, 1.01, 101),
    ],
)  # fmt: skip
def test_a_window_has_an_odd_number_of_samples_and_fits_into_the_record(
    num: int, window: float | None, expected: int
) -> None:
    """Every 10 ms: as many samples as lie within half a window of the middle one, on both sides."""
    assert window_samples(0.01 * np.arange(num), window) == expected


@pytest.mark.parametrize("window", [0.03, 1.0, -0.1, np.nan])
def test_a_window_of_fewer_than_five_samples_or_beyond_the_record_is_refused(window: float) -> None:
    with pytest.raises(ParameterError, match=r"window = .*at least 5 samples and within the record"):
        window_samples(0.01 * np.arange(100), window)

"""Splines near noisy samples: as smooth as the samples ask for, whatever the unit of time."""

import numpy as np
import pytest

from tendonlab.signals import spline_near

T = np.linspace(0.0, 4.0, 401)
NOISE = 1e-4


def read() -> np.ndarray:
    """A motion with a corner, as where a joint breaks away, and noise."""
    moved = np.abs(np.sin(np.pi * T / 2)) ** 1.5
    return np.asarray(moved + NOISE * np.random.default_rng(0).standard_normal(len(T)))


@pytest.mark.parametrize("unit", [1e-3, 60.0])
def test_the_unit_of_time_does_not_matter(unit: float) -> None:
    seconds, others = spline_near(T, read()), spline_near(unit * T, read())
    np.testing.assert_allclose(others(unit * T), seconds(T), atol=1e-9)
    np.testing.assert_allclose(unit * others.derivative()(unit * T), seconds.derivative()(T), atol=1e-6)


def test_it_stays_near_the_samples_and_takes_noise_away() -> None:
    """Chosen in seconds, it missed the motion by 1.6 times the noise."""
    left = spline_near(T, read())(T) - np.abs(np.sin(np.pi * T / 2)) ** 1.5
    assert np.sqrt(np.mean(left**2)) < NOISE

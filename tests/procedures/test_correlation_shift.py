"""The shift between two records: recovered exactly, between samples, with its sign."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tendonlab.errors import ParameterError
from tendonlab.procedures import correlation_shift

TIME = np.arange(0.0, 20.0, 0.01)


def wave(time: np.ndarray) -> np.ndarray:
    """Never the same twice."""
    return np.asarray(np.sin(3.0 * time) + 0.7 * np.sin(4.3 * time + 1.0) + 0.02 * time**2)


@settings(max_examples=50, deadline=None)
@given(late=st.floats(-0.9, 0.9), gain=st.floats(0.1, 10.0), offset=st.floats(-100.0, 100.0))
def test_any_shift_is_recovered_between_samples(late: float, gain: float, offset: float) -> None:
    """Gain and offset do not matter. A parabola places the peak to about a thousandth of an interval."""
    found = correlation_shift(TIME, wave(TIME), offset + gain * wave(TIME - late), longest=1.0)
    assert found == pytest.approx(late, abs=2e-5)


def test_the_later_signal_has_the_positive_shift() -> None:
    pulse = np.exp(-((TIME - 8.0) ** 2))
    later = np.exp(-((TIME - 8.5) ** 2))
    assert correlation_shift(TIME, pulse, later, longest=2.0) == pytest.approx(0.5, abs=1e-4)
    assert correlation_shift(TIME, later, pulse, longest=2.0) == pytest.approx(-0.5, abs=1e-4)


def test_noise_hardly_moves_it() -> None:
    """Noise of a fifth of the signal, 2000 samples: less than a quarter of an interval."""
    rng = np.random.default_rng(0)
    a, b = (wave(TIME - late) + 0.2 * rng.normal(size=len(TIME)) for late in (0.0, 0.3))
    assert correlation_shift(TIME, a, b, longest=1.0) == pytest.approx(0.3, abs=0.0025)


def test_drift_of_the_means_does_not_pull_it_to_zero() -> None:
    """A ramp: any overlap correlates perfectly with any other, but a wave on it tells."""
    a, b = (10.0 * TIME + 30.0 * np.sin(3.0 * (TIME - late)) for late in (0.0, 0.5))
    assert correlation_shift(TIME, a, b - 10.0 * 0.5, longest=0.9) == pytest.approx(0.5, abs=0.02)


def test_bad_input_is_named() -> None:
    with pytest.raises(ParameterError, match=r"longest = 1.0 s: the signals grow more alike beyond it"):
        correlation_shift(TIME, wave(TIME), wave(TIME - 1.3), longest=1.0)
    with pytest.raises(ParameterError, match=r"b = 2.0 throughout: expected a signal that varies"):
        correlation_shift(TIME, wave(TIME), np.full(len(TIME), 2.0), longest=1.0)
    with pytest.raises(ParameterError, match=r"longest = 11.0: expected a value in"):
        correlation_shift(TIME, wave(TIME), wave(TIME), longest=11.0)
    with pytest.raises(ParameterError, match=r"longest = 0.001: expected a value in"):
        correlation_shift(TIME, wave(TIME), wave(TIME), longest=0.001)
    with pytest.raises(ParameterError, match=r"a has 1999 samples: expected 2000"):
        correlation_shift(TIME, TIME[1:], TIME, longest=1.0)

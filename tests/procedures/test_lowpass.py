"""Low-pass filter: its gain, its phase, its ends."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tendonlab.errors import ParameterError
from tendonlab.procedures import correlation_shift, lowpass

RATE = 100.0
TIME = np.arange(0.0, 60.0, 1.0 / RATE)
INSIDE = slice(1000, -1000)


def sine_through(frequency: float, **options: Any) -> complex:
    """Gain and phase of the filter at a frequency: complex amplitude of what comes out of sin(2 pi f t)."""
    out = lowpass(np.sin(2.0 * np.pi * frequency * TIME), cutoff=1.0, sample_rate=RATE, **options)[INSIDE]
    turn = np.exp(-2j * np.pi * frequency * TIME[INSIDE])
    return complex(2.0 * np.mean(out * turn) * 1j)


@pytest.mark.parametrize("frequency", [0.25, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("order", [1, 2, 4])
def test_gain_is_butterworths(frequency: float, order: int) -> None:
    """1 / (1 + (f/f_c)^(2 order)) both ways, its root one way; the bilinear transform bends 2 Hz of 100 by 0.1 %."""
    once = 1.0 / np.sqrt(1.0 + frequency ** (2 * order))
    assert abs(sine_through(frequency, order=order)) == pytest.approx(once**2, rel=0.02)
    assert abs(sine_through(frequency, order=order, zero_phase=False)) == pytest.approx(once, rel=0.01)


@settings(max_examples=50, deadline=None)
@given(frequency=st.floats(0.1, 2.0))
def test_forwards_and_backwards_shifts_no_phase(frequency: float) -> None:
    whole = round(40.0 * frequency) / 40.0  # whole periods between the ends
    assert abs(np.angle(sine_through(whole))) < 1e-6


def test_once_forwards_delays() -> None:
    """Second order at low frequency: the group delay is sqrt(2) / (2 pi f_c) = 0.225 s; both ways none."""
    pulse = np.exp(-(((TIME - 30.0) / 2.0) ** 2))
    once, twice = (lowpass(pulse, cutoff=1.0, sample_rate=RATE, zero_phase=z) for z in (False, True))
    assert correlation_shift(TIME, pulse, once, longest=2.0) == pytest.approx(np.sqrt(2.0) / (2.0 * np.pi), rel=0.02)
    assert correlation_shift(TIME, pulse, twice, longest=2.0) == pytest.approx(0.0, abs=1e-6)


def test_reversed_time_gives_the_reversed_record() -> None:
    noisy = np.random.default_rng(0).normal(size=len(TIME))
    forwards = lowpass(noisy, cutoff=1.0, sample_rate=RATE)
    backwards = lowpass(noisy[::-1], cutoff=1.0, sample_rate=RATE)[::-1]
    np.testing.assert_allclose(forwards[INSIDE], backwards[INSIDE], rtol=0, atol=1e-9)


@settings(max_examples=50, deadline=None)
@given(offset=st.floats(-10.0, 10.0), slope=st.floats(-5.0, 5.0))
def test_a_straight_line_passes_unchanged_to_its_ends(offset: float, slope: float) -> None:
    line = offset + slope * TIME
    np.testing.assert_allclose(lowpass(line, cutoff=1.0, sample_rate=RATE), line, rtol=0, atol=1e-8)


def test_a_constant_passes_the_causal_filter_from_its_first_sample() -> None:
    np.testing.assert_allclose(lowpass(np.full(100, 300.0), cutoff=1.0, sample_rate=RATE, zero_phase=False), 300.0)


def test_white_noise_falls_with_the_root_of_the_bandwidth() -> None:
    noise = np.random.default_rng(1).normal(size=200_000)
    wide, narrow = (np.std(lowpass(noise, cutoff=c, sample_rate=RATE)) for c in (4.0, 1.0))
    assert wide / narrow == pytest.approx(2.0, rel=0.06)  # 2000 s at 1 Hz: each sd known to 1.2 %


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cutoff": 0.0}, r"cutoff = 0.0: expected a value in \(0, 50\) Hz"),
        ({"cutoff": -1.0}, r"cutoff = -1.0: expected a value in \(0, 50\) Hz"),
        ({"cutoff": 50.0}, r"cutoff = 50.0: expected a value in \(0, 50\) Hz"),
        ({"cutoff": float("nan")}, "cutoff = nan: expected a value in"),
        ({"sample_rate": 0.0}, r"sample_rate = 0.0: expected a value in \(0, inf\) Hz"),
        ({"order": 0}, "order = 0: expected a whole number of at least 1"),
        ({"order": 1.5}, "order = 1.5: expected a whole number of at least 1"),
        ({"values": TIME[:8]}, "values has 8 samples: expected at least 9"),
        ({"values": [np.nan] * 20}, r"values\[0\] = nan: expected a finite number"),
    ],
)
def test_bad_input_is_named(options: dict[str, Any], message: str) -> None:
    given_ = {"values": TIME, "cutoff": 1.0, "sample_rate": RATE} | options
    with pytest.raises(ParameterError, match=message):
        lowpass(given_.pop("values"), **given_)

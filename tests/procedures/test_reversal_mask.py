"""Reversals and what is masked about them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tendonlab.errors import ParameterError
from tendonlab.procedures import reversal_mask, reversals

TIME = np.arange(0.0, 20.0, 0.01)


@settings(max_examples=50, deadline=None)
@given(period=st.floats(2.0, 9.0), phase=st.floats(0.05, 0.95), amplitude=st.floats(1e-6, 1e6))
def test_a_sine_reverses_twice_a_period(period: float, phase: float, amplitude: float) -> None:
    """A straight line between samples places a root of a sine to (2 pi h / T)^2 / 8 of an interval and better."""
    found = reversals(TIME, amplitude * np.sin(2.0 * np.pi * (TIME / period + phase)))
    first = np.ceil(2.0 * phase)
    expected = period * (0.5 * np.arange(first, first + 40) - phase)
    inside = (expected > 0.3) & (expected < TIME[-1] - 0.3)
    seen = found[(found > 0.3) & (found < TIME[-1] - 0.3)]
    np.testing.assert_allclose(seen, expected[inside], rtol=0, atol=1e-5)


def test_what_is_kept_of_a_sine_follows_from_its_shape() -> None:
    """|sin| stays below 0.4 for a share 2 asin(0.4) / pi = 0.262 of the time; 0.25 s of reversals is less than that."""
    velocity = np.sin(2.0 * np.pi * TIME / 10.0)
    keep = reversal_mask(TIME, velocity)
    assert keep.dtype == bool
    assert 1.0 - keep.mean() == pytest.approx(2.0 * np.arcsin(0.4) / np.pi, abs=0.002)
    np.testing.assert_array_equal(keep, np.abs(velocity) >= 0.4 * velocity.max())


def test_time_about_reversals_is_masked_on_both_sides() -> None:
    """A square wave is never slow: only the time about its reversals goes."""
    velocity = np.where(TIME < 10.005, 1.0, -1.0)  # reverses half-way between samples, at 10.005
    keep = reversal_mask(TIME, velocity, around=0.25)
    np.testing.assert_array_equal(keep, np.abs(TIME - 10.005) > 0.25)
    assert reversal_mask(TIME, velocity, around=0.0).all()


def test_a_dwell_with_a_reversal_is_masked_whole() -> None:
    """Up to 8 s, rest to 11 s, down: the reversal is the middle of the rest, and 0.5 s about the rest goes too."""
    velocity = np.where(TIME < 8.0, 1.0, np.where(TIME <= 11.0, 0.0, -1.0))
    assert reversals(TIME, velocity) == pytest.approx([9.5])
    np.testing.assert_array_equal(reversal_mask(TIME, velocity, around=0.505), (TIME < 7.495) | (TIME > 11.505))


def test_a_dwell_between_motions_of_one_sense_is_no_reversal_whatever_its_noise() -> None:
    velocity = np.where((TIME > 8.0) & (TIME < 11.0), 0.0, 1.0) + 2e-3 * np.random.default_rng(0).normal(size=len(TIME))
    assert len(reversals(TIME, velocity)) == 0
    assert len(reversals(TIME, velocity, rest=0.0)) > 10
    np.testing.assert_array_equal(reversal_mask(TIME, velocity), np.abs(velocity) > 0.4 * velocity.max())


@settings(max_examples=50, deadline=None)
@given(data=st.data())
def test_the_mask_is_what_its_words_say(data: st.DataObject) -> None:
    """On any velocity: nothing slow is kept, nothing near a reversal, and all else is."""
    speed = st.floats(-1.0, 1.0).filter(lambda v: v == 0.0 or abs(v) > 1e-6)  # else rounding moves zeros onto samples
    values = data.draw(st.lists(speed, min_size=5, max_size=40).filter(lambda v: max(map(abs, v)) > 0.1))
    velocity, time = np.array(values), np.arange(len(values)) * 0.1
    keep = reversal_mask(time, velocity, share=0.3, around=0.15, rest=0.0)
    times = reversals(time, velocity, rest=0.0)
    slow = np.abs(velocity) < 0.3 * np.max(np.abs(velocity))
    away = np.abs(time[:, None] - times)
    assume(not np.any(np.abs(away - 0.15) < 1e-9))  # on the edge rounding decides
    near = np.any(away < 0.15, axis=1)
    assert not keep[slow].any()
    assert not keep[near].any()
    if not (velocity == 0.0).any():  # else a reversal has a length
        np.testing.assert_array_equal(keep, ~slow & ~near)


def test_uneven_sampling_is_fine() -> None:
    time = np.cumsum(np.random.default_rng(1).uniform(0.001, 0.02, size=2000))
    found = reversals(time, np.cos(time))
    assert found == pytest.approx(np.pi * (np.arange(len(found)) + 0.5), abs=1e-4)


def test_where_nothing_reverses_there_is_no_reversal() -> None:
    assert reversals(TIME, np.ones(len(TIME))).shape == (0,)
    assert reversals(TIME, np.zeros(len(TIME))).shape == (0,)


@pytest.mark.parametrize(
    ("velocity", "options", "message"),
    [
        (np.zeros(2000), {}, "velocity = 0 throughout: expected a motion"),
        (TIME[1:], {}, "velocity has 1999 samples: expected 2000"),
        (TIME, {"share": 1.0}, r"share = 1.0: expected a value in \[0, 1\)"),
        (TIME, {"around": -0.1}, r"around = -0.1: expected a value in \[0, inf\) s"),
        (TIME, {"rest": 1.0}, r"rest = 1.0: expected a value in \[0, 1\)"),
        (np.full(2000, np.nan), {}, r"velocity\[0\] = nan: expected a finite number"),
    ],
)
def test_bad_input_is_named(velocity: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        reversal_mask(TIME, velocity, **options)

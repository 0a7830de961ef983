"""Jumps and how late they come: S2's dwell of two seconds, and what must not be paired."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tendonlab.errors import ParameterError
from tendonlab.procedures import jumps, lowpass, time_shift

RATE = 100.0
TIME = np.arange(0.0, 45.0, 1.0 / RATE)


def force(at: tuple[float, ...], heights: tuple[float, ...], *, noise: float = 0.0, seed: int = 0) -> np.ndarray:
    """A slow force with steps between two samples: the first sample after `at` has the new level."""
    slow = 250.0 + 20.0 * np.sin(0.3 * TIME)
    steps = sum(h * (t + 0.5 / RATE < TIME) for t, h in zip(at, heights, strict=True))
    return np.asarray(slow + steps + noise * np.random.default_rng(seed).normal(size=len(TIME)))


def test_a_jump_is_found_where_and_as_high_as_it_is() -> None:
    found = jumps(TIME, force((11.75, 34.5), (50.0, -45.0)), threshold=15.0)
    assert found["time"].to_numpy() == pytest.approx([11.755, 34.505], abs=0.5 / RATE)
    assert found["jump"].to_numpy() == pytest.approx([50.0, -45.0], abs=1.3)  # the slow force in 0.2 s


def test_dwells_of_two_seconds_are_shifts_of_two_seconds() -> None:
    """S2 Fig. 12 with noise of 1.5 N: jumps at the stop (11.75, 34.5 s) and at the next start (13.75, 36.5 s)."""
    simulated = force((11.75, 34.5), (50.0, -45.0))
    measured = force((13.75, 36.5), (52.0, -43.0), noise=1.5)
    found = time_shift(TIME, simulated, measured, threshold=15.0)
    assert found["shift"].to_numpy() == pytest.approx([2.0, 2.0], abs=0.02)
    assert found["measured_jump"].to_numpy() == pytest.approx([52.0, -43.0], abs=6.0 + 1.3)  # 4 sd of two samples


def test_a_jump_smeared_by_the_filter_stays_where_it_is() -> None:
    """At 1 Hz zero phase it takes half a second, so it is looked for within half a second."""
    sharp = force((11.75,), (50.0,))
    smeared = lowpass(sharp, cutoff=1.0, sample_rate=RATE)
    found = time_shift(TIME, sharp, smeared, threshold=15.0, within_time=0.5)
    assert found["shift"].to_numpy() == pytest.approx([0.0], abs=0.01)
    assert found["measured_jump"].to_numpy() == pytest.approx([50.0], rel=0.1)


@settings(max_examples=50, deadline=None)
@given(at=st.integers(500, 3000), late=st.integers(-400, 900), height=st.floats(16.0, 500.0), down=st.booleans())
def test_any_shift_is_recovered_to_the_sample(at: int, late: int, height: float, down: bool) -> None:
    steps = (np.where(np.arange(len(TIME)) < k, 0.0, -height if down else height) for k in (at, at + late))
    found = time_shift(TIME, *steps, threshold=15.0)
    assert found["shift"].to_numpy() == pytest.approx([late / RATE], abs=1e-9)


def test_pairs_keep_their_order_and_their_sense() -> None:
    """Shifts longer than the time between jumps: pairing crosswise would have the same total."""
    ours = force((10.0, 12.0, 20.0), (40.0, 40.0, -40.0))
    theirs = force((14.0, 16.0, 19.0), (40.0, 40.0, -40.0))
    found = time_shift(TIME, ours, theirs, threshold=15.0)
    assert found["simulated_time"].to_numpy() == pytest.approx([10.005, 12.005, 20.005], abs=0.005)
    assert found["shift"].to_numpy() == pytest.approx([4.0, 4.0, -1.0], abs=0.01)


@given(
    waits=st.lists(st.tuples(st.integers(30, 200), st.integers(30, 200)), min_size=1, max_size=12),
    late=st.integers(0, 1500),
)
def test_equal_numbers_of_jumps_are_paired_in_order(waits: list[tuple[int, int]], late: int) -> None:
    ours, theirs = (np.cumsum([w[k] for w in waits]) for k in (0, 1))
    sample = np.arange(5000)
    steps = ((sample[:, None] >= at).sum(axis=1) * 40.0 for at in (ours, theirs + late))
    found = time_shift(sample / RATE, *steps, threshold=15.0)
    assert found["simulated_time"].is_monotonic_increasing
    assert found["shift"].to_numpy() * RATE == pytest.approx(theirs + late - ours, abs=1e-6)


def test_jumps_of_one_sense_are_paired_however_late() -> None:
    """Over nearly the whole record, although a jump of the other sense is nearer."""
    long = np.arange(0.0, 2000.0, 0.1)
    ours, theirs = (
        sum(h * (at < long) for at, h in jumps_at) for jumps_at in ([(1.05, 40.0)], [(2.05, -40.0), (1990.05, 40.0)])
    )
    found = time_shift(long, ours, theirs, threshold=15.0, within_time=0.2)
    assert found["shift"].to_numpy() == pytest.approx([1989.0], abs=0.01)


def test_what_has_no_partner_stays_alone() -> None:
    ours, theirs = force((10.0, 20.0), (40.0, -40.0)), force((11.0, 30.0), (40.0, 40.0))
    assert time_shift(TIME, ours, theirs, threshold=15.0)["shift"].to_numpy() == pytest.approx([1.0], abs=0.01)
    assert time_shift(TIME, ours, theirs, threshold=15.0, longest=0.5).empty
    assert time_shift(TIME, ours, ours + 3.0, threshold=15.0)["shift"].abs().max() < 1e-12
    assert time_shift(TIME, np.zeros_like(TIME), theirs, threshold=15.0).empty


def test_a_change_below_the_threshold_is_none() -> None:
    assert jumps(TIME, force((10.0,), (14.0,)), threshold=15.0).empty
    assert len(jumps(TIME, force((10.0,), (17.0,)), threshold=15.0)) == 1


def test_bad_input_is_named() -> None:
    with pytest.raises(ParameterError, match=r"threshold = 0.0: expected a value in \(0, inf\)"):
        jumps(TIME, TIME, threshold=0.0)
    with pytest.raises(ParameterError, match=r"measured has 4499 samples: expected 4500"):
        time_shift(TIME, TIME, TIME[1:], threshold=1.0)
    with pytest.raises(ParameterError, match=r"within_time = 0.001: expected a value in"):
        jumps(TIME, TIME, threshold=1.0, within_time=0.001)
    with pytest.raises(ParameterError, match=r"within_time = 46.0: expected a value in"):
        jumps(TIME + 100.0, TIME, threshold=1.0, within_time=46.0)
    with pytest.raises(ParameterError, match=r"longest = -1.0: expected a value in"):
        time_shift(TIME, TIME, TIME, threshold=1.0, longest=-1.0)
    with pytest.raises(ParameterError, match=r"expected even sampling"):
        jumps(np.append(TIME, 60.0), np.append(TIME, 60.0), threshold=1.0)

"""Torque and pretension from load cells: the papers' numbers, calibration undone, creep taken off."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tendonlab.errors import ParameterError
from tendonlab.procedures import LoadCell, pretension_from_load_cells, reactive_torque

TIME = np.arange(0.0, 300.0, 0.5)


def test_torque_is_the_sum_of_the_forces_times_the_lever() -> None:
    """S0 eq. 6 by hand: 5.8 N at 0.06 m."""
    assert reactive_torque([3.0], [2.8], lever=0.06) == pytest.approx([0.348], rel=1e-12)


@settings(max_examples=50, deadline=None)
@given(gain=st.floats(0.1, 10.0), offset=st.floats(-5.0, 5.0), flipped=st.booleans())
def test_calibration_undoes_what_the_cell_does(gain: float, offset: float, flipped: bool) -> None:
    force = np.array([-3.0, 0.0, 2.0, 11.0])
    cell = LoadCell(gain=-gain if flipped else gain, offset=offset)
    np.testing.assert_allclose(cell.force(offset + force / cell.gain), force, rtol=0, atol=1e-12 * (1 + 10 * gain))


def test_each_cell_has_its_own_calibration() -> None:
    """Volts from a pair of unlike cells, the second counting the other way: 4 N and 6 N at 0.05 m."""
    pair = LoadCell(gain=100.0, offset=0.5), LoadCell(gain=-50.0, offset=0.1)
    torque = reactive_torque([0.54, 0.5], [-0.02, 0.1], lever=0.05, calibration=pair)
    assert torque == pytest.approx([0.5, 0.0], abs=1e-12)


@pytest.mark.parametrize("interval", [0.01, 0.5, 5.0])
def test_creep_under_a_step_of_load_is_taken_off(interval: float) -> None:
    """Reading of 10 N put on at once: 10 (1 + 0.02 (1 - exp(-t/60))). The cell saw no load before, so the error is only
    that the reading is not straight between samples: interval^2 / 8 of its curvature, 0.2 / 60^2 N/s^2 at most."""
    time = np.arange(0.0, 300.0, interval)
    reading = 10.0 * (1.0 + 0.02 * (1.0 - np.exp(-time / 60.0)))
    force = LoadCell(creep=0.02, creep_time=60.0).force(reading, time=time)
    assert np.max(np.abs(reading - 10.0)) > 0.19
    np.testing.assert_allclose(force, 10.0, rtol=0, atol=max(0.02 * interval**2 / 8.0 * 0.2 / 3600.0, 1e-12))


def test_creep_of_a_ramp_is_taken_off_exactly() -> None:
    """Force t: the lagging part of it is t - tau + tau exp(-t/tau), found by hand."""
    lagging = TIME - 20.0 + 20.0 * np.exp(-TIME / 20.0)
    force = LoadCell(creep=0.1, creep_time=20.0).force(TIME + 0.1 * lagging, time=TIME)
    np.testing.assert_allclose(force, TIME, rtol=0, atol=1e-5)  # 0.5^2 / 8 of the curvature 0.1 / 20, times 0.1


def test_creep_of_the_torque_is_taken_off_both_cells() -> None:
    reading = 10.0 * (1.0 + 0.02 * (1.0 - np.exp(-TIME / 60.0)))
    torque = reactive_torque(reading, reading, lever=0.06, calibration=LoadCell(creep=0.02), time=TIME)
    np.testing.assert_allclose(torque, 1.2, rtol=1e-6)


def test_pretension_is_a_quarter_of_both_readings() -> None:
    """S3 by hand: 54 kg on either side is 264.78 N a cable; its Fig. 5b."""
    assert pretension_from_load_cells(54.0, 54.0) == pytest.approx(264.77955, rel=1e-10)
    readings = np.array([51.83, 52.07, 53.29, 53.91, 54.08])
    expected = [254.13933475, 255.31613275, 261.29818925, 264.33825075, 265.171816]
    assert pretension_from_load_cells(readings, readings) == pytest.approx(expected, rel=1e-10)
    assert isinstance(pretension_from_load_cells(30.0, 34.0), float)
    assert pretension_from_load_cells(300.0, 340.0, g=1.0) == pytest.approx(160.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"gain": 0.0}, "gain = 0: expected a gain other than 0"),
        ({"gain": float("inf")}, "gain = inf: expected a value in"),
        ({"offset": float("nan")}, "offset = nan: expected a value in"),
        ({"creep": 1.0}, r"creep = 1.0: expected a value in \[0, 1\)"),
        ({"creep": -0.1}, r"creep = -0.1: expected a value in \[0, 1\)"),
        ({"creep_time": 0.0}, r"creep_time = 0.0: expected a value in \(0, inf\) s"),
    ],
)
def test_a_bad_calibration_is_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        LoadCell(**options)


def test_bad_input_is_named() -> None:
    with pytest.raises(ParameterError, match=r"force_2 has 1 samples: expected 2, as many as force_1"):
        reactive_torque([1.0, 2.0], [1.0], lever=0.06)
    with pytest.raises(ParameterError, match=r"lever = 0.0: expected a value in \(0, inf\) m"):
        reactive_torque([1.0], [1.0], lever=0.0)
    with pytest.raises(ParameterError, match=r"force_1\[0\] = nan: expected a finite number"):
        reactive_torque([np.nan], [1.0], lever=0.06)
    with pytest.raises(ParameterError, match=r"time = None: expected sampling times, since creep = 0.02 is corrected"):
        reactive_torque([1.0], [1.0], lever=0.06, calibration=LoadCell(creep=0.02))
    with pytest.raises(ParameterError, match=r"reading_out = -1.0: expected a value in \[0, inf\)"):
        pretension_from_load_cells(54.0, -1.0)
    with pytest.raises(ParameterError, match=r"reading_in = nan: expected a value in \[0, inf\)"):
        pretension_from_load_cells(np.nan, 54.0)
    with pytest.raises(ParameterError, match=r"reading_out has shape \(2,\): expected \(3,\)"):
        pretension_from_load_cells(np.ones(3), np.ones(2))
    with pytest.raises(ParameterError, match=r"g = 0.0: expected a value in \(0, inf\) m/s\^2"):
        pretension_from_load_cells(54.0, 54.0, g=0.0)

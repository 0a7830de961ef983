"""Samples that are missing: single ones, and rows that hold nothing or are not there."""

import numpy as np
import pandas as pd
import pytest

from tendonlab.data import load


def test_missing_outputs_stay_and_short_gaps_of_inputs_are_interpolated(draft, write):
    """u is a ramp with slope 10 in time, so its missing samples are known; equal steps are not required."""
    frame = draft.frames["one.csv"]
    frame["t"] = np.cumsum(np.linspace(0.01, 0.02, 20))
    frame["u"] = ramp = 10 * frame["t"]
    frame["u"] = ramp.where(~frame.index.isin([3, 4, 5, 6, 7, 12]))
    frame.loc[[0, 5, 19], "q"] = np.nan
    data = load(write(draft))["one"].data
    np.testing.assert_allclose(data["motor_torque"], ramp, rtol=1e-12)
    assert list(np.flatnonzero(data["joint_angle"].isna())) == [0, 5, 19]


@pytest.mark.parametrize("place", [0, 5, 12])
def test_rows_that_hold_nothing_are_as_good_as_missing_ones(draft, write, place):
    """Eight samples lost, which is more than an input may lack: at the start, in the middle, at the end."""
    lost, frame = range(place, place + 8), draft.frames["one.csv"]
    draft.frames["one.csv"] = frame.drop(index=lost)
    absent = load(write(draft))
    draft.frames["one.csv"] = frame.copy()
    draft.frames["one.csv"].loc[list(lost), frame.columns.drop("t")] = np.nan
    empty = load(write(draft))
    pd.testing.assert_frame_equal(empty["one"].data, absent["one"].data)
    assert empty.warnings == absent.warnings
    assert [w.split(";")[0] for w in absent.warnings] == (
        ["samples are missing in a row, about 8 after t = 0.04 s in one"] if place == 5 else []
    )


def test_gaps_of_several_experiments_are_one_warning(draft, write):
    for name, frame in draft.frames.items():
        draft.frames[name] = frame.drop(index=range(5, 13))
    (warning,) = load(write(draft)).warnings
    assert "about 8 after t = 0.04 s in one (such gaps in 2 experiments); inputs are held or" in warning


def test_a_log_that_was_meant_to_be_uneven_has_no_gaps(draft, write):
    """Stamps that are lost at random: the longest step is ten times the usual one."""
    frame = draft.frames["one.csv"]
    frame["t"] = np.cumsum(np.where(frame.index % 3 == 2, 0.03, 0.01)) + 0.1 * (frame.index > 10)
    assert load(write(draft)).warnings == ()

"""The check of the logs as the first step of a diagnosis."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from checking.pendulum import record
from tendonlab.checking.spikes import outliers, spikes, without_outliers
from tendonlab.fitting.floor import _shared


def test_wrong_logs_end_a_diagnosis(tmp_path: Path) -> None:
    why = tl.diagnose(record().changed(current=-1.0).write(tmp_path), progress=False)
    assert (why.verdict, why.effects, why.selected, why.sets) == ("data_fault", (), (), ())
    assert why.verdict_probability["data_fault"] == 1.0
    assert "sign" in why.sentence
    page = why.report(tmp_path / "out", figures=False)
    written = json.loads((tmp_path / "out" / "report.json").read_text())
    assert written["data"][0]["problem"] == "sign"
    assert written["gap"]["joint_angle"]["refitted"] is None
    assert "turn the sign" in page.read_text()


def test_outliers_are_missing_samples_for_a_diagnosis(tmp_path: Path) -> None:
    logs = record()
    angle = logs.runs["quick"][1]
    hit = np.arange(100, 2000, 190)
    angle[hit] += 1.0
    rig = logs.write(tmp_path)
    cleaned = without_outliers(rig)
    assert np.flatnonzero(cleaned["quick"].data["joint_angle"].isna()).tolist() == hit.tolist()
    pd.testing.assert_frame_equal(cleaned["sweep"].data, rig["sweep"].data)


@pytest.mark.parametrize("rate", [50, 1000])
def test_jumps_and_quick_motion_are_no_outliers(rate: int) -> None:
    time = np.arange(0.0, 10.0, 1 / rate)
    noise = 1e-3 * np.random.default_rng(0).standard_normal(len(time))
    assert not outliers(np.sin(20.0 * time) + noise).any()
    assert not outliers(np.sign(np.sin(3.0 * time)) + noise).any()
    assert not outliers(np.round(np.sin(3.0 * time), 2)).any()


def test_a_spike_of_an_input_is_one_sample_alone() -> None:
    """A pulse of two samples drives the rig, however small its first sample is."""
    command = 1e-3 * np.random.default_rng(0).standard_normal(200)
    command[50] += 1.0
    command[120:122] += (0.1, 1.0)
    assert np.flatnonzero(spikes(command)).tolist() == [50]


def test_repeats_of_unequal_length_share_instants() -> None:
    whole = 0.01 * np.arange(100.0)
    lost = np.delete(whole, [40, 41])
    first, second = _shared([whole, 5.0 + lost])
    np.testing.assert_allclose(whole[first], lost[second], atol=1e-12)  # one rounding of 5.0 + t
    assert len(first) == 98

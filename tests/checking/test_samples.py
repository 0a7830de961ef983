"""What the samples show without a simulator, on logs made for one finding each."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from checking.pendulum import Logs
from tendonlab.checking.copies import copy_findings
from tendonlab.checking.finding import Finding
from tendonlab.checking.samples import _longest, sample_findings

TIME = np.arange(1000) / 250
RNG = np.random.default_rng(0)
ANGLE = np.sin(3 * TIME) + 1e-4 * RNG.standard_normal(1000)
CURRENT = np.cos(2 * TIME) + 1e-3 * RNG.standard_normal(1000)


def found(folder: Path, *runs: tuple[np.ndarray, np.ndarray, np.ndarray]) -> list[Finding]:
    names = [f"run_{k + 1}" for k in range(len(runs))]
    return sample_findings(Logs(dict(zip(names, runs, strict=True))).write(folder))


def test_good_samples_have_no_finding(tmp_path: Path) -> None:
    assert found(tmp_path, (TIME, ANGLE, CURRENT)) == []


@pytest.mark.parametrize(("num", "blocks"), [(15, True), (16, False)])
def test_an_experiment_too_short_to_diagnose_blocks(num: int, blocks: bool, tmp_path: Path) -> None:
    notes = [f for f in found(tmp_path, (TIME, ANGLE, CURRENT), (TIME[:num], ANGLE[:num], CURRENT[:num])) if f.blocks]
    assert [(f.problem, f.experiment, f.count) for f in notes] == ([("sampling", "run_2", 15)] if blocks else [])


def test_samples_that_repeat_a_stamp_are_left_out_and_counted(tmp_path: Path) -> None:
    time, angle = TIME.copy(), ANGLE.copy()
    time[[400, 401, 700]] = time[[399, 399, 699]]
    angle[400] = 7.0  # of samples with one stamp the first counts
    folder = Logs({"run_1": (time, angle, CURRENT)}).write(tmp_path)
    (finding,) = [f for f in sample_findings(folder) if "repeats the one before" in f.detail]
    assert (finding.problem, finding.experiment, finding.blocks) == ("sampling", "run_1", False)
    assert finding.count == 3
    assert finding.detail.startswith("3 samples left out")
    (experiment,) = folder.experiments
    assert len(experiment.data) == 997
    assert experiment.data["joint_angle"].max() < 2.0


def test_a_gap_is_measured_in_lost_samples_and_seconds(tmp_path: Path) -> None:
    kept = np.delete(np.arange(1000), [300, 500, 501, 502])
    (gap,) = found(tmp_path, (TIME[kept], ANGLE[kept], CURRENT[kept]))
    assert (gap.problem, gap.experiment, gap.count) == ("sampling", "run_1", 4)
    assert "2 gaps in time, about 4 samples lost" in gap.detail
    assert "the longest lasts 0.016 s at a usual step of 0.004 s" in gap.detail


def test_one_lost_sample_is_one_gap(tmp_path: Path) -> None:
    kept = np.delete(np.arange(1000), 300)
    (gap,) = found(tmp_path, (TIME[kept], ANGLE[kept], CURRENT[kept]))
    assert "1 gap in time, about 1 sample lost" in gap.detail


@pytest.mark.parametrize(("ratio", "text"), [(1.05, "+5.0 %"), (0.9, "-10.0 %"), (1.008, None)])
def test_a_clock_that_changes_its_step_is_noted(ratio: float, text: str | None, tmp_path: Path) -> None:
    steps = 0.004 * np.where(np.arange(999) < 500, 1.0, ratio)
    notes = found(tmp_path, (np.concatenate([[0.0], np.cumsum(steps)]), ANGLE, CURRENT))
    drift = [f for f in notes if "last quarter" in f.detail]
    assert [text in f.detail for f in drift if text] == ([True] if text else [])
    assert bool(drift) == (text is not None)


@pytest.mark.parametrize(("share", "noted"), [(0.01, False), (0.05, True)])
def test_stamps_that_jitter_are_noted_with_their_sd(share: float, noted: bool, tmp_path: Path) -> None:
    steps = 0.004 * (1.0 + share * np.random.default_rng(1).standard_normal(999))
    jittered = (np.concatenate([[0.0], np.cumsum(steps)]), ANGLE, CURRENT)
    notes = found(tmp_path, (TIME, CURRENT, ANGLE), jittered)
    assert [(f.problem, f.experiment) for f in notes] == ([("sampling", "run_2")] if noted else [])
    if noted:
        assert "time steps differ by 5 % in run_2" in notes[0].detail
    both = found(tmp_path, (TIME, CURRENT, ANGLE), jittered, (jittered[0], -ANGLE, CURRENT))
    assert [f.experiment for f in both] == ([None] if noted else [])
    assert not noted or "in 2 of 3 experiments" in both[0].detail


def test_outliers_of_outputs_and_spikes_of_inputs_are_counted(tmp_path: Path) -> None:
    angle, current = ANGLE.copy(), CURRENT.copy()
    angle[[100, 400, 700]] += 1.0
    current[[200, 800]] += 3.0
    notes = found(tmp_path, (TIME, angle, current))
    assert {(f.problem, f.signal, f.count) for f in notes} == {
        ("outliers", "joint_angle", 3),
        ("outliers", "motor_torque", 2),
    }
    left_out, interpolated = sorted((f.detail for f in notes), key=lambda text: "interpolated" in text)
    assert "3 samples of joint_angle (0.3 %)" in left_out
    assert "2 samples of motor_torque (0.2 %)" in interpolated


def test_a_reading_that_stands_still_is_noted(tmp_path: Path) -> None:
    notes = found(tmp_path, (TIME, ANGLE, CURRENT), (TIME, np.full(1000, 0.25), CURRENT))
    assert [(f.problem, f.signal, f.experiment) for f in notes] == [("constant", "joint_angle", "run_2")]
    assert "reads 0.25" in notes[0].detail


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_command_at_its_limit_is_noted_on_either_side(side: float, tmp_path: Path) -> None:
    command = side * np.minimum(CURRENT, 0.8)
    (note,) = found(tmp_path, (TIME, ANGLE, command))
    assert (note.problem, note.signal, note.count) == ("saturation", "motor_torque", int(np.sum(CURRENT >= 0.8)))
    value = "0.8" if side > 0 else "−0.8"
    assert f"stays at {value} A for {100 * np.mean(CURRENT >= 0.8):.0f} %" in note.detail


def test_both_limits_of_a_command_are_one_note(tmp_path: Path) -> None:
    (note,) = found(tmp_path, (TIME, ANGLE, np.clip(CURRENT, -0.8, 0.8)))
    assert note.count == int(np.sum(np.abs(CURRENT) >= 0.8))
    assert "at 0.8 A for" in note.detail
    assert "and at −0.8 A for" in note.detail


def test_an_angle_that_its_sensor_cuts_off_is_noted_where_experiments_share_the_limit(tmp_path: Path) -> None:
    """A motion that rests at its farthest in one experiment alone is at no limit."""
    swings = [np.sin(0.8 * TIME) + 1e-4 * np.random.default_rng(k).standard_normal(len(TIME)) for k in range(2)]
    cut = [(TIME, np.minimum(q, 0.75), CURRENT * (1 + 0.1 * k)) for k, q in enumerate(swings)]
    notes = [f for f in found(tmp_path, *cut) if f.problem == "saturation"]
    assert [(f.signal, f.experiment) for f in notes] == [("joint_angle", "run_1"), ("joint_angle", "run_2")]
    assert "joint_angle stays at 0.75 rad for" in notes[0].detail
    assert "if the sensor clips there, leave these samples empty" in notes[0].detail
    alone = [cut[0], (TIME, 0.6 * swings[1], CURRENT * 1.1)]
    assert [f for f in found(tmp_path, *alone) if f.problem == "saturation"] == []


def test_a_smooth_step_that_rests_is_at_no_limit(tmp_path: Path) -> None:
    """It slows down before it rests; a command that is cut off does not, also where it is logged in steps."""
    phase = np.clip(TIME % 2.0 - 0.3, 0.0, 1.0)
    eased = 2.0 * np.where(TIME % 4.0 < 2.0, phase, 1.0 - phase)
    smooth = 0.5 * eased**2 * (3.0 - eased)
    assert [f for f in found(tmp_path, (TIME, ANGLE, smooth)) if f.problem == "saturation"] == []
    cut = np.round(np.minimum(CURRENT, 0.8) / 0.005) * 0.005
    assert [f.problem for f in found(tmp_path, (TIME, ANGLE, cut))] == ["saturation"]


def test_a_short_touch_of_the_extreme_and_a_command_of_few_levels_are_no_limit(tmp_path: Path) -> None:
    touch = CURRENT.copy()
    touch[np.argsort(touch)[-4:]] = 2.0
    switched = np.sign(np.sin(3 * TIME))
    for command in (touch, switched):
        assert [f for f in found(tmp_path, (TIME, ANGLE, command)) if f.problem == "saturation"] == []


@pytest.mark.parametrize(("step", "noted"), [(0.01, True), (1e-4, False)])
def test_a_coarse_reading_is_noted_with_its_step(step: float, noted: bool, tmp_path: Path) -> None:
    reading = step * np.floor(np.sin(0.5 * TIME) / step)
    notes = [f for f in found(tmp_path, (TIME, reading, CURRENT)) if f.problem == "quantisation"]
    assert [f.signal for f in notes] == (["joint_angle"] if noted else [])
    if noted:
        assert "in steps of 0.01 rad" in notes[0].detail


@pytest.mark.parametrize("num", [2, 20])
def test_an_output_that_is_read_at_a_lower_rate_and_held_is_noted(num: int, tmp_path: Path) -> None:
    held, lost = np.repeat(ANGLE[::num], num), np.delete(np.arange(1000), [77, 300, 301])
    runs = [(TIME, held, CURRENT), (TIME[lost], held[lost], CURRENT[lost])]
    (note,) = [f for f in found(tmp_path, *runs) if f.signal == "joint_angle"]
    assert (note.problem, note.experiment, note.blocks) == ("sampling", None, False)
    assert f"joint_angle changes only every {num} samples, as a sensor that is read at a lower rate" in note.detail


def test_a_run_whose_output_alone_is_held_is_named(tmp_path: Path) -> None:
    notes = found(tmp_path, (TIME, ANGLE, CURRENT), (TIME, np.repeat(ANGLE[::5], 5), CURRENT))
    assert [(f.problem, f.experiment) for f in notes] == [("sampling", "run_2")]


@pytest.mark.parametrize(
    "angle",
    [
        0.01 * np.round(100 * np.sin(0.3 * TIME)),  # a coarse encoder in slow motion
        0.01 * np.floor(0.05 * np.arange(1000) + 0.5),  # one that turns by a step in exactly 20 samples
        0.01 * np.abs(np.floor(0.05 * np.arange(-500, 500) + 0.5)),  # the same, with a reversal
        0.01 * np.round(100 * np.sin(0.3 * TIME) + 0.3 * RNG.standard_normal(1000)),  # one with noise
        np.where(np.arange(1000) % 20 == 0, ANGLE, np.nan),  # what is read at a lower rate and not held
        np.where(np.arange(1000) % 400 < 200, ANGLE, 0.3),  # a motion with rests
    ],
)
def test_a_reading_that_repeats_without_being_held_is_not_called_held(angle: np.ndarray, tmp_path: Path) -> None:
    notes = found(tmp_path, (TIME, angle, CURRENT))
    assert [f.detail for f in notes if "every" in f.detail] == []


def test_a_stated_resolution_needs_no_note(tmp_path: Path) -> None:
    rig = Logs({"a": (TIME, 0.01 * np.floor(np.sin(0.5 * TIME) / 0.01), CURRENT)}).write(tmp_path)
    spec = replace(rig.signals["joint_angle"], resolution=0.01)
    stated = replace(rig, signals={**rig.signals, "joint_angle": spec})
    assert not [f for f in sample_findings(stated) if f.problem == "quantisation"]


def test_the_longest_run_of_marks() -> None:
    assert _longest(np.array([True, True, False, True, True, True, False])) == 3
    assert _longest(np.array([False, True, True])) == 2
    assert _longest(np.zeros(4, dtype=bool)) == 0


def test_a_column_that_is_written_twice_is_a_copy(tmp_path: Path) -> None:
    (copy,) = copy_findings(Logs({"a": (TIME, CURRENT, CURRENT)}).write(tmp_path))
    assert (copy.problem, copy.blocks) == ("copy", True)
    assert {copy.signal, *copy.alternatives} == {"motor_torque", "joint_angle"}


def test_a_run_that_begins_as_another_one_is_a_copy_and_one_that_differs_is_none(tmp_path: Path) -> None:
    half = (TIME[:500], ANGLE[:500], CURRENT[:500])
    rig = Logs({"a": (TIME, ANGLE, CURRENT), "b": half, "c": (TIME, ANGLE + 0.01, CURRENT)}).write(tmp_path)
    assert [(f.problem, f.experiment) for f in copy_findings(rig)] == [("copy", "b")]


def test_runs_that_miss_the_same_samples_are_copies(tmp_path: Path) -> None:
    gone = ANGLE.copy()
    gone[:3] = np.nan
    rig = Logs({"a": (TIME, gone, CURRENT), "b": (TIME, gone, CURRENT)}).write(tmp_path)
    assert [f.experiment for f in copy_findings(rig)] == ["b"]


def test_runs_at_rest_are_no_copies(tmp_path: Path) -> None:
    rest = np.round(0.01 * np.sin(TIME), 2)  # three levels
    rig = Logs({"a": (TIME, rest, CURRENT), "b": (TIME, rest, -CURRENT)}).write(tmp_path)
    assert copy_findings(rig) == []

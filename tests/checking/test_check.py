"""`tendonlab.check` on logs with mistakes that people make: the right kind, place and size; no alarm without one."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tendonlab as tl
from checking.pendulum import CONSTANT, Logs, late_run, record
from tendonlab.checking.finding import Finding


@pytest.fixture(scope="module")
def right() -> Logs:
    """Logs without a mistake."""
    return record()


def blocking(logs: Logs, folder: Path) -> list[Finding]:
    return [finding for finding in tl.check(logs.write(folder)).findings if finding.blocks]


def test_right_logs_pass(right: Logs, tmp_path: Path) -> None:
    assert tl.check(right.write(tmp_path)).findings == ()


def test_bundled_rig_passes() -> None:
    found = tl.check(tl.load("data/two_inertia"))
    assert not found.blocks
    assert found.notes == ()


@pytest.mark.parametrize("column", ["current", "angle"])
def test_a_wrong_sign_has_two_suspects_on_a_single_joint(right: Logs, column: str, tmp_path: Path) -> None:
    (found,) = blocking(right.changed(**{column: -1.0}), tmp_path)
    assert found.problem == "sign"
    assert {found.signal, *found.alternatives} == {"motor_torque", "joint_angle"}
    assert found.factor == pytest.approx(-1.0, rel=0.1)  # the parameters are known to 10 %


DEGREES, MILLI = "degrees and radians", "a prefix such as milli"
MISTAKES = {  # the logs, the guilty signal, what is logged over what it should be, and the confusion that is suggested
    "degrees as radians": (lambda logs: logs.changed(angle=180 / np.pi), "joint_angle", 180 / np.pi, DEGREES),
    "radians as degrees": (lambda logs: replace(logs, units=("s", "deg", "A")), "joint_angle", np.pi / 180, DEGREES),
    "milliampere as ampere": (lambda logs: logs.changed(current=1000.0), "motor_torque", 1000.0, MILLI),
    "constant doubled": (lambda logs: replace(logs, constant=2 * CONSTANT), "motor_torque", 2.0, "a diameter and"),
    "line for phase": (lambda logs: logs.changed(current=3**0.5), "motor_torque", 3**0.5, "a phase and of a line"),
    "milliseconds as seconds": (lambda logs: logs.changed(time=1000.0), "time", 1000.0, MILLI),
    "seconds as milliseconds": (lambda logs: replace(logs, units=("ms", "rad", "A")), "time", 0.001, MILLI),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_wrong_scale_is_found_with_its_factor(right: Logs, mistake: str, tmp_path: Path) -> None:
    make, signal, factor, confusion = MISTAKES[mistake]
    (found,) = blocking(make(right), tmp_path)
    assert (found.problem, found.signal) == ("scale", signal)
    assert found.factor == pytest.approx(factor, rel=0.1)  # the parameters are known to 10 %
    assert confusion in found.detail


@pytest.mark.parametrize("seconds", [0.03, -0.05, 0.3])
def test_a_run_that_lags_the_others_blocks(right: Logs, seconds: float, tmp_path: Path) -> None:
    (found,) = blocking(late_run(right, "sweep", seconds), tmp_path)
    assert (found.problem, found.signal, found.experiment) == ("clock", None, "sweep")
    assert found.seconds == pytest.approx(seconds, abs=0.003)


def test_a_lag_that_all_share_is_noted_only(tmp_path: Path) -> None:
    found = tl.check(record(late=0.02).write(tmp_path))
    assert [(f.problem, f.blocks) for f in found.findings] == [("clock", False)]
    assert found.findings[0].seconds == pytest.approx(0.02, abs=0.002)


def test_uncertain_parameters_explain_a_factor(right: Logs, tmp_path: Path) -> None:
    """A torque constant that is believed to a factor of two forbids no log that is twice as large."""
    replace(right, constant=2 * CONSTANT).write(tmp_path)
    file = tmp_path / "dataset.toml"
    file.write_text(file.read_text().replace("value = 1.0, sd = 0 }", "value = 1.0, sd = 0.7 }"))
    assert not tl.check(tl.load(tmp_path)).blocks


def test_outliers_and_gaps_are_noted_and_forbid_nothing(right: Logs, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    time, angle, current = right.runs["quick"]
    hit = rng.choice(len(time), 20, replace=False)
    spoilt = angle.copy()
    spoilt[hit] += rng.choice([-1.0, 1.0], 20) * rng.uniform(0.3, 2.0, 20)
    kept = np.delete(np.arange(len(time)), [700, 701])
    runs = {**right.runs, "quick": (time[kept], spoilt[kept], current[kept])}
    found = tl.check(replace(right, runs=runs).write(tmp_path))
    assert [(f.problem, f.signal, f.experiment, f.blocks) for f in found.findings] == [
        ("sampling", None, "quick", False),
        ("outliers", "joint_angle", "quick", False),
    ]
    assert found.findings[0].count == 2
    assert found.findings[1].count == pytest.approx(20, abs=2)


def test_a_file_that_is_there_twice_blocks(right: Logs, tmp_path: Path) -> None:
    (found,) = blocking(replace(right, runs={**right.runs, "again": right.runs["quick"]}), tmp_path)
    assert (found.problem, found.experiment) == ("copy", "again")


def test_findings_are_plain_and_readable(right: Logs, tmp_path: Path) -> None:
    found = tl.check(right.changed(current=-1.0).write(tmp_path))
    entry = found.to_dict()["data"][0]
    assert {"problem", "signal", "experiment", "detail", "blocks", "or", "factor"} <= set(entry)
    assert "sign" in repr(found)
    assert "<td>sign</td>" in found._repr_html_()


@pytest.mark.parametrize("level", [0.3, 2.0, -0.3])
def test_a_command_that_any_size_suits_is_not_blamed(level: float, tmp_path: Path) -> None:
    """A current that only turns with the motion is dry friction to the regression, the larger the better."""
    logs = record()
    for _, angle, current in logs.runs.values():
        velocity = np.gradient(np.convolve(angle, np.ones(9) / 9, "same"))
        current[:] = level * np.sign(velocity) + 0.01 * np.random.default_rng(1).standard_normal(len(current))
    assert not tl.check(logs.write(tmp_path)).blocks

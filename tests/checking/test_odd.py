"""Mistakes in one experiment are found there, whatever the others say; a harder experiment is no mistake."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import tendonlab as tl
from checking.pendulum import Logs, record
from tendonlab.checking.odd import _is_friction

Run = tuple[np.ndarray, np.ndarray, np.ndarray]


def with_one(run: str, change: object) -> Logs:
    """The right logs with one run changed."""
    right = record()
    assert callable(change)
    return replace(right, runs=right.runs | {run: change(*right.runs[run])})


@pytest.mark.parametrize("run", ["quick", "sweep"])
@pytest.mark.parametrize(
    ("problem", "signals", "time", "angle", "current"),
    [
        ("sign", {"joint_angle", "motor_torque"}, 1.0, -1.0, 1.0),
        ("sign", {"joint_angle", "motor_torque"}, 1.0, 1.0, -1.0),
        ("scale", {"joint_angle"}, 1.0, 180.0 / np.pi, 1.0),
        ("scale", {"motor_torque"}, 1.0, 1.0, 1000.0),
        ("scale", {"motor_torque"}, 1.0, 1.0, 2.0),
        ("scale", {"time"}, 1000.0, 1.0, 1.0),
    ],
)
def test_a_factor_in_one_run_is_found(
    run: str, problem: str, signals: set[str], time: float, angle: float, current: float, tmp_path: Path
) -> None:
    found = tl.check(with_one(run, lambda t, q, i: (time * t, angle * q, current * i)).write(tmp_path))
    (finding,) = [f for f in found.findings if f.blocks]
    assert finding.problem == problem
    assert finding.experiment == run
    assert {finding.signal, *finding.alternatives} <= signals
    assert finding.factor == pytest.approx(time * angle * current, rel=0.1)


def test_a_current_that_stands_still_while_the_joint_moves_is_found(tmp_path: Path) -> None:
    found = tl.check(with_one("sweep", lambda t, q, i: (t, q, 0.0 * i)).write(tmp_path))
    (finding,) = [f for f in found.findings if f.blocks]
    assert (finding.problem, finding.signal, finding.experiment) == ("constant", "motor_torque", "sweep")


def test_an_angle_without_its_noise_is_dead(tmp_path: Path) -> None:
    found = tl.check(with_one("sweep", lambda t, q, i: (t, 0.0 * q + 0.1, i)).write(tmp_path))
    (finding,) = [f for f in found.findings if f.blocks]
    assert (finding.problem, finding.signal, finding.experiment) == ("constant", "joint_angle", "sweep")


def test_a_coarse_angle_may_rest(tmp_path: Path) -> None:
    step = 0.01
    coarse = {name: (t, step * np.round(q / step), i) for name, (t, q, i) in record().runs.items()}
    t, q, i = coarse["sweep"]
    found = tl.check(replace(record(), runs=coarse | {"sweep": (t, 0.0 * q, 0.01 * i)}).write(tmp_path))
    assert not found.blocks


def test_a_run_with_three_times_the_friction_is_no_mistake(tmp_path: Path) -> None:
    found = tl.check(with_one("quick", lambda t, q, i: (t, q, i + 0.3 * np.sign(np.gradient(q)))).write(tmp_path))
    assert not found.blocks


@pytest.mark.parametrize(
    ("signals", "moved", "friction"),
    [(("input_velocity",), (), True), (("input_torque",), (), False), (("input_velocity",), ("joint_angle",), False)],
)
def test_a_turned_velocity_of_one_massless_run_may_be_friction(
    signals: tuple[str, ...], moved: tuple[str, ...], friction: bool
) -> None:
    dimensions = {"input_torque": "effort", "input_velocity": "flow"}
    inputs = [SimpleNamespace(name=name, dimension=dimension) for name, dimension in dimensions.items()]
    equation: Any = SimpleNamespace(system=SimpleNamespace(info=SimpleNamespace(inputs=inputs)), moved=moved)
    factor: Any = SimpleNamespace(signals=signals)
    assert _is_friction(equation, factor) == friction

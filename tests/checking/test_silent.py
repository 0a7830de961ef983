"""An input that reads nothing but noise while the rig moves is told; torque drawn anew at each sample is not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tendonlab as tl
from checking.pendulum import record


@pytest.fixture
def rig(tmp_path: Path) -> tl.Dataset:
    return record().write(tmp_path)


def noisy(rig: tl.Dataset, **sizes: float) -> tl.Dataset:
    """The rig whose signals read nothing but noise of these sizes."""
    random = np.random.default_rng(0)
    experiments = [
        replace(e, data=e.data.assign(**{name: sd * random.normal(size=len(e.data)) for name, sd in sizes.items()}))
        for e in rig
    ]
    return replace(rig, experiments=tuple(experiments))


def told(rig: tl.Dataset) -> list[tuple[str | None, bool]]:
    return [(f.signal, f.blocks) for f in tl.check(rig).findings if f.problem == "uninformative"]


def test_a_torque_of_nothing_but_noise_blocks_while_the_joint_moves(rig: tl.Dataset) -> None:
    assert told(rig) == []
    assert told(noisy(rig, motor_torque=1e-3)) == [("motor_torque", True)]
    assert tl.diagnose(noisy(rig, motor_torque=1e-3), progress=False).verdict == "data_fault"


def test_a_rig_at_rest_tells_no_parameter(rig: tl.Dataset) -> None:
    assert told(noisy(rig, motor_torque=1e-3, joint_angle=1e-4)) == [("motor_torque", True)]


def test_torque_drawn_anew_at_each_sample_moves_the_joint(rig: tl.Dataset) -> None:
    shaken = noisy(rig, motor_torque=3.0)
    moved = []
    for e in shaken:
        angle = rig.system().simulate(e)["joint_angle"].to_numpy()
        moved.append(replace(e, data=e.data.assign(joint_angle=angle)))
    assert told(replace(shaken, experiments=tuple(moved))) == []


def test_a_motor_that_is_off_while_the_joint_swings_freely_is_no_fault(rig: tl.Dataset) -> None:
    random, swings = np.random.default_rng(3), []
    for k, e in enumerate(rig):
        still = replace(e, data=e.data.assign(motor_torque=0.0, joint_angle=0.6 + 0.2 * k))
        angle = rig.system().simulate(still)["joint_angle"].to_numpy()
        read = {"motor_torque": 2e-3 * random.normal(size=len(angle)), "joint_angle": angle}
        swings.append(replace(e, data=e.data.assign(**read)))
    free = replace(rig, experiments=tuple(swings))
    off = {
        "gravity_torque": replace(rig.parameters["gravity_torque"], value=1.05 * rig.parameters["gravity_torque"].value)
    }
    assert told(replace(free, parameters={**rig.parameters, **off})) == []


def test_a_load_that_is_held_at_several_angles_tells_gravity(rig: tl.Dataset) -> None:
    random, held = np.random.default_rng(4), []
    for k, e in enumerate(rig):
        angle, num = 0.2 + 0.3 * k, len(e.data)
        torque = rig.parameters["gravity_torque"].value * np.sin(angle) + 1e-3 * random.normal(size=num)
        read = {"motor_torque": torque, "joint_angle": angle + 1e-4 * random.normal(size=num)}
        held.append(replace(e, data=e.data.assign(**read)))
    assert told(replace(rig, experiments=tuple(held))) == []


def test_white_torque_in_a_wrong_unit_is_a_wrong_factor(rig: tl.Dataset) -> None:
    moved = []
    for e in noisy(rig, motor_torque=3.0):
        angle = rig.system().simulate(e)["joint_angle"].to_numpy()
        moved.append(replace(e, data=e.data.assign(joint_angle=angle, motor_torque=1e-3 * e.data["motor_torque"])))
    (found,) = (f for f in tl.check(replace(rig, experiments=tuple(moved))).findings if f.blocks)
    assert (found.problem, found.signal) == ("scale", "motor_torque")

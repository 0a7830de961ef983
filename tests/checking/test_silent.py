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

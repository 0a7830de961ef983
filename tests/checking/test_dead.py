"""A position that flickers in every experiment while the rig moves is told as dead, one that rests is not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tendonlab as tl
from checking.pendulum import record
from tendonlab.checking.dead import dead_outputs

STEP = 1e-3


@pytest.fixture
def rig(tmp_path: Path) -> tl.Dataset:
    return record().write(tmp_path)


def flickering(rig: tl.Dataset, *, among: int = 3) -> tl.Dataset:
    """The rig whose angle reads 0 and its neighbours at random."""
    random = np.random.default_rng(0)
    experiments = [
        replace(e, data=e.data.assign(joint_angle=STEP * random.integers(among, size=len(e.data)))) for e in rig
    ]
    return replace(rig, experiments=tuple(experiments))


def with_velocity(rig: tl.Dataset, speed: float) -> tl.Dataset:
    """The rig with a logged velocity of the joint, of noise and a sine of this size."""
    random = np.random.default_rng(1)
    spec = replace(rig.signals["joint_angle"], name="joint_velocity")
    experiments = [
        replace(
            e,
            data=e.data.assign(joint_velocity=speed * np.sin(2.0 * e.time) + 0.01 * random.normal(size=len(e.data))),
        )
        for e in rig
    ]
    return replace(rig, signals={**rig.signals, "joint_velocity": spec}, experiments=tuple(experiments))


def test_a_sensor_that_flickers_while_the_joint_moves_is_dead(rig: tl.Dataset) -> None:
    (found,) = dead_outputs(with_velocity(flickering(rig), 0.5), rig.system())
    assert (found.problem, found.signal, found.blocks) == ("constant", "joint_angle", True)
    assert (
        "stays within 0.002 rad in every experiment, though joint_velocity changes: its sensor is dead" in found.detail
    )
    assert tl.check(with_velocity(flickering(rig), 0.5)).blocks


@pytest.mark.parametrize("speed", [None, 0.0])
def test_without_a_velocity_that_moved_friction_may_hold_the_joint(rig: tl.Dataset, speed: float | None) -> None:
    still = flickering(rig) if speed is None else with_velocity(flickering(rig), speed)
    (found,) = dead_outputs(still, rig.system())
    assert not found.blocks


def test_a_sensor_that_tells_of_some_motion_or_has_none_to_tell_is_not_dead(rig: tl.Dataset) -> None:
    assert list(dead_outputs(rig, rig.system())) == []
    assert list(dead_outputs(flickering(rig, among=4), rig.system())) == []
    resting = flickering(rig)
    silent = [replace(e, data=e.data.assign(**dict.fromkeys(resting.inputs, 0.0))) for e in resting]
    hanging = replace(resting, experiments=tuple(silent))
    assert list(dead_outputs(hanging, rig.system())) == []
    unread = [replace(e, data=e.data.assign(joint_angle=np.nan)) for e in rig]
    assert list(dead_outputs(replace(rig, experiments=tuple(unread)), rig.system())) == []

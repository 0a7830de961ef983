"""The servo of the generator against limits that need no second simulator."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from driving import rigs

import tendonlab as tl
from tendonlab.blind.description import Lanes, Run, Scene
from tendonlab.blind.plant import simulate
from tendonlab.blind.rig import draw_rig
from tendonlab.blind.strength import tune
from tendonlab.blind.systems import SERVO_PENDULUM
from tendonlab.blind.write import record, write_dataset

INERTIA, CONSTANT, RESISTANCE, GAIN = 0.008, 0.4, 4.0, 10.0
STIFFNESS = CONSTANT * GAIN / RESISTANCE


def servo(num_lanes: int = 1, **parameters: float | np.ndarray) -> Lanes:
    stated = {"joint_inertia": INERTIA, "torque_constant": CONSTANT, "resistance": RESISTANCE}
    return rigs(SERVO_PENDULUM, {**stated, "proportional_gain": GAIN, **parameters}, num_lanes=num_lanes)


def follow(rig: Lanes, target: float, *, seconds: float, supply: float = 50.0, rest: int = 0) -> Run:
    """From rest at 0 to a constant target, after `rest` samples."""
    reference = np.full((round(seconds / 0.005), rig.size), target)
    reference[:rest] = 0.0
    others, start = {"supply_voltage": np.full_like(reference, supply)}, np.zeros((2, rig.size))
    return simulate(rig, Scene(reference=reference, sample_time=0.005, initial=start, others=others), step=1e-4)


def test_without_friction_it_is_a_spring_damped_by_back_emf():
    run = follow(servo(), 0.1, seconds=1.0)
    decay = 0.5 * CONSTANT**2 / RESISTANCE / INERTIA
    turn = np.sqrt(STIFFNESS / INERTIA - decay**2)
    phase = turn * run.time
    expected = 0.1 * (1.0 - np.exp(-decay * run.time) * (np.cos(phase) + decay / turn * np.sin(phase)))
    np.testing.assert_allclose(run.state[0, :, 0], expected, atol=2e-4)


def test_the_supply_limits_the_speed():
    run = follow(servo(), 1e3, seconds=1.5, supply=6.0)
    assert run.state[1, -1, 0] == pytest.approx(6.0 / CONSTANT, rel=1e-3)


@pytest.mark.parametrize("target", [0.4, -0.7])
def test_a_rig_starts_where_servo_and_gravity_balance(target: float):
    rig = servo(gravity_torque=0.4, actuation_offset=0.02)
    reference = np.full((20, 1), target)
    run = simulate(rig, Scene(reference=reference, others={"supply_voltage": np.full_like(reference, 8.0)}), step=1e-4)
    angle = run.state[0, 0, 0]
    assert STIFFNESS * (target - angle) + 0.02 == pytest.approx(0.4 * np.sin(angle), abs=1e-12)
    assert np.ptp(run.state[0]) < 1e-9


def test_dry_friction_holds_what_the_servo_cannot_pull():
    level = STIFFNESS * 0.1
    run = follow(servo(2, joint_coulomb=np.array([0.99, 1.01]) * level), 0.1, seconds=0.2)
    assert np.any(run.state[0, :, 0])
    assert not np.any(run.state[0, :, 1])


def test_a_late_servo_moves_as_late():
    late = np.array([0.0, 0.015])
    run = follow(servo(2, actuation_delay=late), 0.1, seconds=0.5, rest=10)
    moved = np.argmax(run.state[0] > 0.0, axis=0)
    assert moved[1] - moved[0] == 3


def test_the_library_explains_what_lacks_nothing(tmp_path: Path):
    """Two programs: what they leave of each other's logs is noise, most of it one count of the encoder."""
    rig = draw_rig(np.random.default_rng(3), effect="", kind="none", system=SERVO_PENDULUM, num_samples=300)
    (strength,) = tune([rig])
    write_dataset(rig, record([rig], [strength])[0], tmp_path / "servo", name="servo", description="a servo")
    logs = tl.load(tmp_path / "servo")
    for experiment in logs:
        left = experiment.data["joint_angle"] - logs.system().simulate(experiment)["joint_angle"]
        assert np.sqrt(np.mean(left**2)) < 3.0 * strength.floor[0]

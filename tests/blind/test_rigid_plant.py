"""The rigid joint of the generator against limits that need no second simulator."""

from __future__ import annotations

from functools import partial

import driving
import numpy as np
import pytest
from driving import rigs
from scipy.special import ellipk

from tendonlab.blind.description import Controller, Lanes, Scene
from tendonlab.blind.plant import simulate
from tendonlab.blind.systems import RIGID_JOINT

INERTIA, GRAVITY = 0.05, 1.8


def lanes(num_lanes: int = 1, *, form: int = 0, **parameters: float | np.ndarray) -> Lanes:
    return rigs(RIGID_JOINT, {"joint_inertia": INERTIA, **parameters}, num_lanes=num_lanes, form=form)


push = partial(driving.push, step=2e-4)


def at(position: float, velocity: float = 0.0) -> np.ndarray:
    return np.array([[position], [velocity]])


@pytest.mark.parametrize("amplitude", [0.1, 1.5])
def test_period_of_a_free_swing(amplitude: float):
    """The pendulum's period is 4 K(sin^2(a/2)) sqrt(J/g)."""
    run = push(lanes(gravity_torque=GRAVITY), 0.0, seconds=1.6, initial=at(amplitude))
    speed = run.state[1, :, 0]
    turns = np.flatnonzero((speed[:-1] < 0) & (speed[1:] >= 0))  # half a period after the start
    turn = run.time[turns[0]] + 0.002 * speed[turns[0]] / (speed[turns[0]] - speed[turns[0] + 1])
    assert 2.0 * turn == pytest.approx(4.0 * ellipk(np.sin(amplitude / 2) ** 2) * np.sqrt(INERTIA / GRAVITY), rel=1e-5)


def test_energy_is_conserved_without_friction():
    run = push(lanes(gravity_torque=GRAVITY), 0.0, seconds=2.0, initial=at(1.2))
    q, v = run.state[:, :, 0]
    energy = 0.5 * INERTIA * v**2 - GRAVITY * np.cos(q)
    assert np.ptp(energy) < 1e-5 * np.ptp(GRAVITY * np.cos(q))  # (omega h)^2 ~ 1e-6, and bounded


def test_speed_approaches_torque_over_viscous_friction_exponentially():
    run = push(lanes(joint_viscous=0.25), 0.1, seconds=1.0)
    expected = 0.1 / 0.25 * (1.0 - np.exp(-run.time * 0.25 / INERTIA))
    np.testing.assert_allclose(run.state[1, :, 0], expected, atol=4e-4)  # first order: h b / J = 1e-3 of the speed


def test_stick_is_exact_below_the_level_and_broken_above():
    run = push(lanes(2, joint_coulomb=0.15), np.array([0.149, 0.151]), seconds=0.3)
    assert np.all(run.state[:, :, 0] == 0.0)
    assert run.state[0, -1, 1] == pytest.approx(0.5 * 0.001 / INERTIA * run.time[-1] ** 2, rel=0.02)


def test_sliding_stops_after_the_work_of_friction():
    run = push(lanes(joint_coulomb=0.15), 0.0, seconds=1.0, initial=at(0.0, 2.0))
    assert run.state[0, -1, 0] == pytest.approx(0.5 * INERTIA * 4.0 / 0.15, rel=2e-3)
    assert np.all(run.state[1, -50:, 0] == 0.0)


@pytest.mark.parametrize(("dependence", "moves"), [(1.9, True), (2.1, False)])
def test_load_dependence_holds_a_hanging_load(dependence: float, moves: bool):
    """At standstill without command the load is g sin(q)/2: a load dependence above 2 holds any weight."""
    rig = lanes(gravity_torque=GRAVITY, joint_load_dependence=dependence)
    run = push(rig, 0.0, seconds=0.2, initial=at(0.5))
    assert bool(np.any(run.state[0, :, 0] != 0.5)) == moves


def test_level_by_direction():
    run = push(lanes(2, joint_coulomb=0.1, joint_level_asymmetry=0.4), np.array([0.3, -0.3]), seconds=0.2)
    acceleration = run.state[1, -1] / run.time[-1] * INERTIA
    np.testing.assert_allclose(acceleration, [0.3 - 0.14, -(0.3 - 0.06)], rtol=1e-9)


@pytest.mark.parametrize("form", [0, 1, 2])
def test_presliding_never_exceeds_its_level_when_sliding(form: int):
    run = push(lanes(joint_coulomb=0.1, joint_bristle_stiffness=20.0, form=form), 0.3, seconds=0.8)
    np.testing.assert_allclose(np.diff(run.state[1, -20:, 0]) / 0.002, (0.3 - 0.1) / INERTIA, rtol=1e-3)


def test_actuator_offset_gain_and_load_offset_add_up():
    rig = lanes(actuation_gain_error=0.1, actuation_offset=0.02, load_offset=-0.05)
    run = push(rig, 0.2, seconds=0.2)
    assert INERTIA * run.state[1, -1, 0] == pytest.approx((0.22 + 0.02 - 0.05) * run.time[-1], rel=1e-9)


@pytest.mark.parametrize(
    ("form", "passes"), [(0, [0.0, 0.0, -0.2]), (1, [0.0, 0.05 - 0.1 * np.tanh(0.5), -0.3 + 0.1 * np.tanh(3.0)])]
)
def test_deadband_of_the_actuator(form: int, passes: list[float]):
    """Nothing passes within, the rest beyond; the smooth form lets a little through."""
    run = push(lanes(3, actuation_deadband=0.1, form=form), np.array([0.0, 0.05, -0.3]), seconds=0.2)
    np.testing.assert_allclose(INERTIA * run.state[1, -1] / run.time[-1], passes, atol=1e-4)


@pytest.mark.parametrize("delay", [0.0007, 0.002, 0.0053])
def test_delays_of_actuator_and_sensors(delay: float):
    """Under a constant torque a/J from rest: v(t - d) of a late actuator; both readings of late sensors."""
    moved = push(lanes(actuation_delay=delay), np.where(np.arange(40) < 5, 0.0, 0.1)[:, None], seconds=0.08, step=1e-4)
    assert moved.state[1, -1, 0] == pytest.approx(2.0 * (moved.time[-1] - 0.01 - delay), rel=1e-9)
    late = {f"sensor.{name}_delay": delay for name in ("joint_angle", "joint_velocity")}
    read = push(lanes(**late), 0.1, seconds=0.08, step=1e-4)
    old = read.time[5:] - delay
    np.testing.assert_allclose(read.outputs[:, 5:, 0], [old**2, 2.0 * old], atol=2e-6)


def test_loop_starts_at_rest_and_converges_with_the_step():
    gains = Controller(kp=np.array([11.0]), kd=np.array([1.0]), limit=np.array([8.0]))
    time = np.arange(300) * 0.002
    reference = 0.4 + 0.3 * np.where(time < 0.1, 0.0, 1.0 - np.cos(6.0 * (time - 0.1)))[:, None]
    rig = lanes(gravity_torque=GRAVITY, joint_coulomb=0.15, joint_viscous=0.08, load_offset=0.1)
    runs = [
        simulate(rig, Scene(reference=reference, controller=gains), step=h).outputs[0, :, 0]
        for h in (1e-3, 5e-4, 6.25e-5)
    ]
    errors = [np.sqrt(np.mean((run - runs[2]) ** 2)) for run in runs[:2]]
    np.testing.assert_allclose(runs[2][:45], runs[2][0], atol=1e-12)
    assert errors[1] < 0.7 * errors[0]
    assert errors[1] < 5e-5  # the step that tunes the strength: below the angle's floor


@pytest.mark.parametrize(
    ("one", "other", "outputs"),
    [
        ("actuation_offset", "load_offset", RIGID_JOINT.output_names),
        ("actuation_delay", "sensor.joint_angle_delay", ("joint_angle",)),
    ],
)
def test_twins_give_the_same_logs(one: str, other: str, outputs: tuple[str, ...]):
    """In a loop as well: what cannot be told apart is accepted."""
    gains = Controller(kp=np.array([11.0]), kd=np.array([1.0]), limit=np.array([8.0]))
    reference = 0.4 + 0.3 * np.sin(0.02 * np.arange(200))[:, None]
    stated = {"gravity_torque": GRAVITY, "joint_coulomb": 0.15, "joint_viscous": 0.08}
    scene = Scene(reference=reference, controller=gains)
    runs = [simulate(lanes(**stated, **{name: 0.004}), scene, step=2e-4) for name in (one, other)]
    np.testing.assert_allclose(runs[0].command, runs[1].command, atol=1e-9)
    names = [name.replace("_delay", ":delay").replace("_offset", ":offset") for name in (one, other)]
    assert RIGID_JOINT.twins(names[0], outputs) == (names[1],)
    assert RIGID_JOINT.twins(names[1], outputs) == (names[0],)
    assert RIGID_JOINT.twins("joint:coulomb", outputs) == ()

"""The twins' simulator against limits that need no second simulator: conservation, terminal speed, stick, step size."""

from __future__ import annotations

from functools import partial

import driving
import numpy as np
import pytest
from driving import rigs

from tendonlab.blind.description import Controller, Lanes, Run, Scene
from tendonlab.blind.plant import simulate
from tendonlab.blind.systems import TWO_INERTIA

RIG = {
    "motor_inertia": 1.2e-4,
    "joint_inertia": 0.02,
    "gear_ratio": 10.0,
    "cable_stiffness": 50.0,
    "cable_damping": 0.0,
}


def lanes(num_lanes: int = 1, *, form: int = 0, **parameters: float | np.ndarray) -> Lanes:
    return rigs(TWO_INERTIA, {**RIG, **parameters}, num_lanes=num_lanes, form=form)


push = partial(driving.push, step=1e-4)


def follow(rig: Lanes, *, step: float, seconds: float = 0.6) -> Run:
    """Closed loop along a sine of 0.3 rad of the joint."""
    time = np.arange(round(seconds / 0.002)) * 0.002
    reference = np.repeat(3.0 * np.sin(6.0 * time)[:, None], rig.size, axis=1)
    gains = Controller(kp=np.full(rig.size, 0.5), kd=np.full(rig.size, 0.018), limit=np.full(rig.size, 0.8))
    return simulate(rig, Scene(reference=reference, controller=gains), step=step)


def test_energy_is_conserved_without_friction_and_damping():
    rig = lanes(gravity_torque=1.1)
    run = push(rig, 0.0, seconds=1.0, initial=np.array([[8.0], [0.78], [0.0], [0.0]]))
    qm, ql, vm, vl = run.state[:, :, 0]
    kinetic = 0.5 * 1.2e-4 * vm**2 + 0.5 * 0.02 * vl**2
    energy = kinetic + 0.5 * 50.0 * (qm / 10.0 - ql) ** 2 - 1.1 * np.cos(ql)
    # a midpoint rule: the error oscillates with (omega h)^2 ~ 1e-4 of the cable's energy and does not grow
    assert np.ptp(energy) < 1e-4 * np.ptp(kinetic)
    assert np.ptp(kinetic) > 0.1


def test_momentum_grows_with_the_torque():
    """J_m N qm' + J_l ql' grows at N u, whatever the cable does (no gravity, no friction)."""
    run = push(lanes(cable_damping=0.05, cable_backlash=0.02), 0.05, seconds=0.5)
    _, _, vm, vl = run.state[:, :, 0]
    momentum = 10.0 * 1.2e-4 * vm + 0.02 * vl
    np.testing.assert_allclose(momentum, 10.0 * 0.05 * run.time, rtol=1e-9, atol=1e-12)


def test_terminal_speed_with_viscous_friction():
    """Both sides turn at u N / (b_m N^2 + b_l) in the end."""
    run = push(lanes(cable_damping=0.5, motor_viscous=2e-3, joint_viscous=0.2), 0.05, seconds=1.2)
    speed = 10.0 * 0.05 / (2e-3 * 100.0 + 0.2)
    assert run.state[3, -1, 0] == pytest.approx(speed, rel=1e-6)  # 12 time constants of 0.08 s
    assert run.state[2, -1, 0] == pytest.approx(10.0 * speed, rel=1e-6)


def test_stick_is_exact_below_the_level_and_broken_above():
    torque = np.array([0.0099, 0.0101])
    run = push(lanes(2, motor_coulomb=0.01), torque, seconds=0.3)
    assert np.all(run.state[:, :, 0] == 0.0)
    assert run.state[0, -1, 1] > 0.0


def test_sliding_block_stops_and_stays():
    rig = lanes(joint_coulomb=0.3, motor_coulomb=0.02, cable_damping=0.05)
    run = push(rig, 0.0, seconds=0.6, initial=np.array([[0.0], [0.0], [10.0], [1.0]]))
    assert np.all(run.state[2:, -50:, 0] == 0.0)
    assert np.all(np.diff(run.state[0, -50:, 0]) == 0.0)


def test_coulomb_friction_takes_its_work():
    """Coasting as one body: the kinetic energy is gone after the angle E / (total level)."""
    rig = lanes(joint_coulomb=0.2, cable_stiffness=2000.0, cable_damping=1.0)
    run = push(rig, 0.0, seconds=1.0, step=5e-5, initial=np.array([[0.0], [0.0], [20.0], [2.0]]))
    energy = 0.5 * (0.02 + 100.0 * 1.2e-4) * 2.0**2
    assert run.state[1, -1, 0] == pytest.approx(energy / 0.2, rel=5e-3)  # the cable's damping takes a little


def test_load_dependent_joint_holds_a_hanging_load():
    """At standstill |f + g sin q|/2 is g sin q, so a load dependence above 1 holds any load: no motion."""
    rig = lanes(gravity_torque=1.1, contact_load_dependence=0.0, joint_load_dependence=2.5)
    run = push(rig, 0.0, seconds=0.2, initial=np.array([[5.0], [0.5], [0.0], [0.0]]))
    assert np.all(run.state[1, :, 0] == 0.5)


def test_presliding_follows_the_lugre_loop():
    """Slow torque to half the level L and back: x = -(L/sigma0) ln(1 - F/L), then (L/sigma0) ln(1 + F/L) less."""
    rig = lanes(motor_coulomb=0.05, motor_bristle_stiffness=2.0, motor_bristle_damping=0.02, motor_viscous=2e-3)
    command = 0.025 * np.interp(np.arange(751) * 0.002, [0.0, 0.75, 1.5], [0.0, 1.0, 0.0])[:, None]
    run = simulate(rig, Scene(reference=command), step=2e-4)
    turn, end = 0.025 * np.log(2.0), 0.025 * (np.log(2.0) - np.log(1.5))
    assert run.state[0, :, 0].max() == pytest.approx(turn, rel=0.02)  # inertia and viscous lag stay within this
    assert run.state[0, -1, 0] == pytest.approx(end, rel=0.06)


@pytest.mark.parametrize("form", [0, 1, 2])
def test_presliding_never_exceeds_its_level_when_sliding(form: int):
    rig = lanes(motor_coulomb=0.02, motor_bristle_stiffness=1.0, cable_stiffness=1e-6, form=form)
    run = push(rig, 0.05, seconds=0.4)
    acceleration = np.diff(run.state[2, -20:, 0]) / 0.002
    np.testing.assert_allclose(acceleration, (0.05 - 0.02) / 1.2e-4, rtol=1e-3)


def test_asymmetric_level_by_direction():
    torque = np.array([0.03, -0.03])
    run = push(lanes(2, motor_coulomb=0.01, motor_level_asymmetry=0.4, cable_stiffness=1e-6), torque, seconds=0.1)
    speeds = run.state[2, -1]
    assert speeds[0] / run.time[-1] == pytest.approx((0.03 - 0.014) / 1.2e-4, rel=1e-3)
    assert speeds[1] / run.time[-1] == pytest.approx(-(0.03 - 0.006) / 1.2e-4, rel=1e-3)


def test_backlash_opens_the_cable():
    """Within half the gap the cable carries nothing; the full gap is what the joint can be moved."""
    stretch = np.array([-0.012, -0.009, 0.009, 0.012])
    start = np.stack([10.0 * stretch, np.zeros(4), np.zeros(4), np.zeros(4)])
    run = push(lanes(4, cable_backlash=0.02), 0.0, seconds=0.002, initial=start)
    np.testing.assert_allclose(run.outputs[2, 0], 50.0 * np.array([-0.002, 0.0, 0.0, 0.002]), atol=1e-12)


@pytest.mark.parametrize("delay", [0.0007, 0.002, 0.0053])
def test_sensor_delay_reads_the_past(delay: float):
    start = np.array([[0.0], [0.0], [10.0], [1.0]])
    run = push(lanes(**{"sensor.joint_angle_delay": delay}), 0.0, seconds=0.05, initial=start)
    late = run.time > delay + 0.002
    np.testing.assert_allclose(run.outputs[1, late, 0], (run.time[late] - delay) * 1.0, atol=1e-9)
    np.testing.assert_allclose(run.outputs[0, :, 0], 10.0 * run.time, atol=1e-9)


@pytest.mark.parametrize("delay", [0.0007, 0.002, 0.0053])
def test_actuation_delay_shifts_the_impulse(delay: float):
    """A torque step after 10 ms acts `delay` later: the momentum at the end is short by N u delay."""
    command = np.where(np.arange(50) < 5, 0.0, 0.05)[:, None]
    run = simulate(lanes(actuation_delay=delay), Scene(reference=command), step=1e-4)
    momentum = 10.0 * 1.2e-4 * run.state[2, -1, 0] + 0.02 * run.state[3, -1, 0]
    assert momentum == pytest.approx(10.0 * 0.05 * (run.time[-1] - 0.010 - delay), rel=1e-9)


def test_actuation_gain_offset_and_sensor_bias():
    extra = {"actuation_gain_error": 0.1, "actuation_offset": 0.02, "sensor.motor_angle_bias": 0.3}
    run = push(lanes(**extra), 0.05, seconds=0.1)
    momentum = 10.0 * 1.2e-4 * run.state[2, -1, 0] + 0.02 * run.state[3, -1, 0]
    assert momentum == pytest.approx(10.0 * (0.05 * 1.1 + 0.02) * run.time[-1], rel=1e-9)
    np.testing.assert_allclose(run.outputs[0] - run.state[0], 0.3, atol=1e-12)


def test_converges_with_the_step():
    rig = lanes(
        gravity_torque=1.1,
        cable_damping=0.05,
        motor_coulomb=3e-3,
        joint_coulomb=0.05,
        joint_viscous=0.02,
        joint_static_excess=0.03,
        joint_stribeck_velocity=0.05,
    )
    fine = follow(rig, step=2.5e-5).outputs[0]
    errors = [np.sqrt(np.mean((follow(rig, step=step).outputs[0] - fine) ** 2)) for step in (4e-4, 2e-4, 1e-4)]
    assert errors[2] < 0.5 * errors[1] < 0.35 * errors[0]  # first order at least, stick and slip included
    assert errors[1] < 8e-5  # the step that tunes the strength: a tenth of the motor angle's floor


def test_lanes_do_not_see_one_another():
    rig = lanes(3, gravity_torque=1.1, joint_coulomb=np.array([0.02, 0.05, 0.1]), cable_damping=0.05)
    together = follow(rig, step=2e-4, seconds=0.1).outputs
    alone = follow(lanes(gravity_torque=1.1, joint_coulomb=0.05, cable_damping=0.05), step=2e-4, seconds=0.1).outputs
    np.testing.assert_allclose(together[:, :, 1], alone[:, :, 0], rtol=0, atol=1e-12)


def test_step_must_divide_the_sample_time():
    with pytest.raises(ValueError, match="whole fraction"):
        push(lanes(), 0.0, seconds=0.1, step=3e-4)


@pytest.mark.parametrize("backlash", [0.0, 0.01])
@pytest.mark.parametrize("known", [0.0, 0.4])
def test_a_run_begins_in_equilibrium_with_its_controller(backlash: float, known: float) -> None:
    """Whatever gravity, load, actuator and sensor do: nothing moves before the reference does."""
    rig = lanes(
        2, gravity_torque=1.1, load_offset=known, cable_backlash=backlash, actuation_offset=0.02,
        actuation_gain_error=0.2, cable_damping=0.05, joint_coulomb=1e-9, motor_viscous=1e-4,
        **{"sensor.motor_angle_bias": 0.3},
    )  # fmt: skip
    reference = np.tile([5.0, -8.0], (400, 1))
    gains = Controller(kp=np.full(2, 0.5), kd=np.full(2, 0.018), limit=np.full(2, 0.8))
    run = simulate(rig, Scene(reference=reference, controller=gains), step=1e-4)
    assert np.abs(run.state[:2] - run.state[:2, :1]).max() < 1e-4
    motor, joint = run.state[:2, 0]
    torque = 1.1 * np.sin(joint) - known
    assert np.abs(torque).min() > 0.05
    assert run.outputs[2, 0] == pytest.approx(torque, abs=1e-4)
    assert run.command[0] * 1.2 + 0.02 == pytest.approx(torque / 10.0, abs=1e-5)
    assert motor / 10.0 - joint == pytest.approx(torque / 50.0 + np.sign(torque) * backlash / 2.0, abs=1e-5)


def test_a_torque_that_is_known_acts_on_the_joint() -> None:
    """As a load that is constant does, sample by sample."""
    torque = np.repeat(0.05 * np.sin(0.1 * np.arange(250))[:, None], 2, axis=1)
    run = push(lanes(2, load_offset=[0.0, 0.03]), 0.0, seconds=0.5, known=torque)
    momentum = 10.0 * 1.2e-4 * run.state[2] + 0.02 * run.state[3]
    given = np.concatenate([[0.0], np.cumsum(torque[:-1, 0])]) * 0.002
    np.testing.assert_allclose(momentum[:, 0], given, atol=1e-12)
    np.testing.assert_allclose(momentum[:, 1] - momentum[:, 0], 0.03 * run.time, atol=1e-12)


@pytest.mark.parametrize("delay", [0.0007, 0.0053])
def test_a_late_torque_sensor_reads_the_past_of_the_cable(delay: float) -> None:
    """The cable of two bodies that swing against each other: a sine whose phase is late."""
    start = np.array([[0.02], [0.0], [0.0], [0.0]])
    run, late = (
        push(lanes(**more), 0.0, seconds=0.2, initial=start, step=2e-5)
        for more in ({}, {"sensor.cable_torque_delay": delay})
    )
    frequency = np.sqrt(50.0 * (1.0 / 0.02 + 1.0 / (100.0 * 1.2e-4)))
    after = run.time > delay + 0.002
    expected = 50.0 * 0.002 * np.cos(frequency * (run.time - delay))
    np.testing.assert_allclose(run.outputs[2, :, 0], 50.0 * 0.002 * np.cos(frequency * run.time), atol=2e-3)
    np.testing.assert_allclose(late.outputs[2, after, 0], expected[after], atol=2e-3)


def test_readings_are_rounded_and_noise_is_added_before() -> None:
    noise = np.zeros((3, 50, 1))
    noise[1] = 0.0041
    resolution = np.array([[0.0], [0.01], [0.0]])
    start = np.array([[0.0], [0.0], [1.0], [0.1]])
    run = push(lanes(), 0.0, seconds=0.1, initial=start, noise=noise, resolution=resolution)
    np.testing.assert_allclose(run.outputs[1, :, 0], 0.01 * np.round((0.1 * run.time + 0.0041) / 0.01), atol=1e-9)
    np.testing.assert_allclose(run.outputs[0, :, 0], run.time, atol=1e-9)


def test_what_settles_is_not_logged_and_strides_skip_samples() -> None:
    command = np.full((100, 1), 0.05)
    whole = simulate(lanes(), Scene(reference=command), step=1e-4)
    part = simulate(lanes(), Scene(reference=command, num_settle=30), step=1e-4, stride=7)
    np.testing.assert_array_equal(part.state, whole.state[:, 30::7])
    np.testing.assert_allclose(part.time, 0.014 * np.arange(10))
    with pytest.raises(ValueError, match="reference has 100 samples: expected more than num_settle = 100"):
        simulate(lanes(), Scene(reference=command, num_settle=100), step=1e-4)


def test_a_controller_differentiates_its_error_and_is_limited() -> None:
    """From the second sample on: backward over one sample."""
    reference = np.array([0.0, 0.0, 0.01, 0.01, 5.0])[:, None]
    gains = Controller(kp=np.array([0.5]), kd=np.array([0.018]), limit=np.array([0.8]))
    run = simulate(lanes(), Scene(reference=reference, controller=gains), step=1e-4)
    error = reference[:, 0] - run.outputs[0, :, 0]
    rate = np.concatenate([[0.0], np.diff(error)]) / 0.002
    np.testing.assert_allclose(run.command[:, 0], np.clip(0.5 * error + 0.018 * rate, -0.8, 0.8), atol=1e-12)
    assert run.command[2, 0] == pytest.approx(0.005 + 0.018 * 5.0)
    assert run.command[4, 0] == 0.8

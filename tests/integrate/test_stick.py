"""Dry friction holds what is pushed less than its level: exactly, cheaply, and lets go at the right instant."""

import numpy as np
import pytest

from integrate.rig import FRICTION, NOMINAL, joint, pair, run

DRY = ("joint:coulomb",)


@pytest.mark.parametrize("push", [0.9, -0.9, 0.0, 0.999999])
def test_block_pushed_below_its_level_stays_exactly_at_rest(push):
    t = np.linspace(0.0, 10.0, 1001)
    done = run(joint(DRY, coulomb=1.0), t, push, position=[0.3])
    assert np.all(done["joint_velocity"] == 0.0)
    assert np.all(done["joint_angle"] == 0.3)
    assert done.attempts < 50


def test_block_stays_at_rest_under_changing_push_and_gravity():
    """The push wanders over 95 % of the level in both directions; a hanging mass adds its part."""
    t = np.linspace(0.0, 10.0, 1001)
    system = joint((*DRY, "joint:stribeck", "joint:viscous"), coulomb=1.0, viscous=0.1, gravity_torque=0.4,
                   joint_static_excess=0.5, joint_stribeck_velocity=0.01)  # fmt: skip
    gravity = 0.4 * np.sin(0.5)
    done = run(system, t, gravity + 0.95 * 1.5 * np.sin(2 * np.pi * t), position=[0.5])
    assert np.all(done["joint_velocity"] == 0.0)
    assert np.all(done["joint_angle"] == 0.5)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_ramp_releases_at_the_level(sign):
    """J q'' = r t - F_c from t* = F_c / r on: q' = r (t - t*)^2 / 2 J."""
    t = np.linspace(0.0, 2.0, 401)
    rate, level, inertia = 1.3, 1.0, 0.5
    done = run(joint(DRY, coulomb=level).with_parameters({"inertia": inertia}), t, sign * rate * t, kind="linear")
    after = np.maximum(t - level / rate, 0.0)
    assert np.all(done["joint_velocity"][after == 0.0] == 0.0)
    # the step that follows the release starts within 1e-13 of the level: only rounding is left of the cubic
    assert done["joint_velocity"] == pytest.approx(sign * rate * after**2 / (2 * inertia), abs=1e-9)
    assert done["joint_angle"] == pytest.approx(sign * rate * after**3 / (6 * inertia), abs=1e-9)
    assert done.events == 1


@pytest.mark.parametrize(("sign", "level"), [(1.0, 1.5 * 1.2), (-1.0, 1.5 * 0.8)])
def test_stribeck_excess_and_asymmetry_count_at_release(sign, level):
    """(F_c + F_e)(1 + a s): 1.8 forwards, 1.2 backwards."""
    t = np.linspace(0.0, 4.0, 4001)
    system = joint((*DRY, "joint:stribeck", "joint:asymmetry"), coulomb=1.0, joint_static_excess=0.5,
                   joint_stribeck_velocity=0.01, joint_level_asymmetry=0.2, joint_viscous_asymmetry=0.0)  # fmt: skip
    done = run(system, t, sign * t, kind="linear")
    moving = np.flatnonzero(done["joint_velocity"])
    assert t[moving[0]] == pytest.approx(level, abs=1.1e-3)  # samples are 1 ms apart


def test_load_dependence_counts_at_release():
    """Level F_c + c (u + L) / 2 against a push u - L: it lets go at u = (F_c + L (1 + c/2)) / (1 - c/2)."""
    t = np.linspace(0.0, 4.0, 4001)
    load, c, level = 1.0, 0.2, 0.5
    system = joint((*DRY, "joint:load_dependence"), coulomb=level, joint_load_dependence=c)
    done = run(system, t, t, known=-load, kind="linear")
    moving = np.flatnonzero(done["joint_velocity"])
    # u = 0 at the start: the load of 1 pushes back by more than 0.5 + 0.1, so it first slides backwards
    assert moving[0] == 1
    held = run(system, t, np.maximum(t, 0.8), known=-load, kind="linear")
    moving = np.flatnonzero(held["joint_velocity"])
    assert t[moving[0]] == pytest.approx((level + load * (1 + c / 2)) / (1 - c / 2), abs=1.1e-3)


def test_constant_friction_stops_a_moving_block():
    """From v_0 it stops after v_0 J / F_c, having gone v_0^2 J / 2 F_c, and does not move again."""
    t = np.linspace(0.0, 3.0, 301)
    done = run(joint(DRY, coulomb=0.8), t, 0.0, velocity=[-1.2])
    stop = 1.2 / 0.8
    assert done["joint_velocity"] == pytest.approx(-np.maximum(1.2 - 0.8 * t, 0.0), abs=1e-12)  # a polynomial: exact
    assert np.all(done["joint_velocity"][t > stop + 1e-9] == 0.0)
    assert done["joint_angle"][-1] == pytest.approx(-(1.2**2) / (2 * 0.8), rel=1e-12)
    assert done.attempts < 60


def test_both_ports_of_a_pair_stick_at_once():
    """A stretched cable and gravity, neither above the level of motor or joint."""
    t = np.linspace(0.0, 10.0, 501)
    system = pair(NOMINAL, **FRICTION, gravity_torque=0.2)
    tension = 0.02
    start = [10.0 * (0.1 + tension / 50.0), 0.1]
    done = run(system, t, 0.002, position=start, ports=True)
    assert np.all(done["motor_angle"] == start[0])
    assert np.all(done["joint_angle"] == start[1])
    assert done["cable_torque"] == pytest.approx(tension, abs=1e-12)
    assert done.attempts < 50
    # what holds them balances what pushes: motor u - f/N, joint f - g sin q
    assert done.ports["motor"][3] == pytest.approx(0.002 - tension / 10.0, abs=1e-12)
    assert done.ports["joint"][3] == pytest.approx(tension - 0.2 * np.sin(0.1), abs=1e-12)


def test_joint_waits_until_the_cable_pulls_enough():
    """A slow ramp on the motor: the motor lets go at its level, the joint when the cable carries the joint's."""
    t = np.linspace(0.0, 1.0, 10001)
    system = pair(NOMINAL, **FRICTION)
    done = run(system, t, 0.02 * t, kind="linear", tolerance=1e-10)
    motor, joint_ = (np.flatnonzero(done[name]) for name in ("motor_angle", "joint_angle"))
    assert t[motor[0]] == pytest.approx(0.003 / 0.02, abs=1.1e-4)
    pull = done["cable_torque"][joint_[0] - 2 : joint_[0] + 1]
    assert pull[0] <= 0.05 * (1 + 1e-9)
    assert pull[-1] >= 0.05 * (1 - 1e-9)
    assert np.all(done["joint_angle"][: joint_[0] - 1] == 0.0)


def test_a_held_kick_releases_and_stops_again():
    """A step of the command above the level for 0.1 s: up v = a t, then down to rest, by polynomials."""
    t = np.linspace(0.0, 1.0, 101)
    command = np.where((t >= 0.2 - 1e-9) & (t < 0.3 - 1e-9), 1.5, 0.0)
    done = run(joint(DRY, coulomb=1.0), t, command, kind="hold")
    up = np.clip(t - 0.2, 0.0, 0.1) * 0.5
    expected = np.maximum(up - np.clip(t - 0.3, 0.0, None), 0.0)
    assert done["joint_velocity"] == pytest.approx(expected, abs=1e-12)
    assert np.all(done["joint_velocity"][t > 0.36] == 0.0)


def test_a_short_push_moves_a_block_that_has_rested_for_long():
    """While everything rests, steps grow; yet none may pass over a smooth push that is gone at its end."""
    time = np.linspace(0.0, 10.0, 1001)
    push = 2.0 * np.exp(-(((time - 7.0) / 0.03) ** 2))
    found = run(joint(("joint:coulomb",), coulomb=1.0), time, push)
    force = np.maximum(2.0 * np.exp(-((np.linspace(-0.2, 0.2, 40001) / 0.03) ** 2)) - 1.0, 0.0)
    assert found["joint_angle"][600] == 0.0
    assert found["joint_angle"][-1] > 0.5 * np.trapezoid(force, dx=1e-5) ** 2 / 2.0  # work against friction: v^2 / 2 mu

"""Where effects act, as docs/effects.md has it: on which torque, load and velocity."""

import numpy as np
import pytest

import tendonlab as tl
from integrate.rig import joint, run
from systems.test_servo_pendulum import servo

TIME = np.linspace(0.0, 0.5, 501)


def test_the_deadband_of_a_servo_swallows_its_back_emf() -> None:
    """Behind a deadband that no torque leaves, a servo coasts at its first speed: nothing brakes it."""
    wide = servo("actuation:deadband", actuation_deadband=100.0)
    done = run(wide, TIME, {"target_angle": 0.0 * TIME}, position=[0.0], velocity=[2.0])
    assert done["joint_velocity"] == pytest.approx(2.0, abs=1e-9)


def test_the_delay_of_a_servo_is_that_of_its_target() -> None:
    late = servo("actuation:delay", actuation_delay=0.1)
    first = np.where(TIME < 0.2, 0.0, 0.3)
    shifted = np.where(TIME < 0.3, 0.0, 0.3)
    done, expected = (
        run(of, TIME, {"target_angle": target}, position=[0.0], velocity=[2.0])["joint_angle"]
        for of, target in ((late, first), (servo(), shifted))
    )
    assert done == pytest.approx(expected, abs=1e-5)  # tolerance of the stepper


def test_deadband_then_gain_then_offset() -> None:
    """At the first instant, from rest: J q'' = 1.5 (2 - 0.5) + 0.25."""
    values = {"actuation_deadband": 0.5, "actuation_gain_error": 0.5, "actuation_offset": 0.25}
    effects = [f"actuation:{name}" for name in ("deadband", "gain_error", "offset")]
    done = run(joint(effects, **values), TIME, {"motor_torque": np.full_like(TIME, 2.0)})
    assert done["joint_velocity"] == pytest.approx(2.5 * TIME, abs=1e-9)


def test_the_load_of_a_rigid_joint_is_half_of_what_motor_and_gravity_give() -> None:
    inputs = {"motor_torque": np.full_like(TIME, 2.0), "known_torque": np.full_like(TIME, 0.5)}
    _, angle, load, _ = run(joint(gravity_torque=3.0), TIME, inputs, ports=True).ports["joint"]
    assert load == pytest.approx(0.5 * (2.0 + 3.0 * np.sin(angle) - 0.5), abs=1e-9)


def test_inside_the_gap_of_a_cable_nothing_damps() -> None:
    """The motor runs freely until it has crossed half of the gap, however strong the damper."""
    values = {"motor_inertia": 1.0, "joint_inertia": 1.0, "gear_ratio": 1.0, "gravity_torque": 0.0}
    values |= {"cable_stiffness": 100.0, "cable_damping": 50.0, "cable_backlash": 1.0}
    done = run(
        tl.System(kind="two_inertia", parameters=values, effects=["cable:backlash"]),
        TIME,
        {"motor_torque": 0.0 * TIME},
        velocity=[0.9, 0.0],
    )
    assert done["motor_angle"] == pytest.approx(0.9 * TIME, abs=1e-9)


def test_the_gate_of_a_sheath_takes_its_period_from_a_loop_at_1_khz() -> None:
    """Between two logs of one motion at 1 and 2 kHz the held torque decays alike."""
    found = []
    for rate in (1000, 2000):
        time = np.arange(rate // 10) / rate
        drive = {"input_torque": np.where(time < 0.02, 0.0, 1.0), "input_velocity": np.full_like(time, 0.5)}
        found.append(run(pair(), time, drive)["output_torque"][:: rate // 1000])
    assert 0.1 < found[0][30] < 0.9  # on the way
    assert found[0][25:] == pytest.approx(found[1][25:], abs=0.05)  # a step between two samples is no step of both


def pair() -> tl.System:
    values = {"input_radius": 0.05, "output_radius": 0.05, "sheath_length": 1.0, "cable_stiffness": 1e5}
    values |= {"pretension": 100.0, "wrap_angle": 1.0, "threshold_velocity": 1.0, "threshold_slope": 2.0}
    return tl.System(kind="bowden_pair", parameters=values)

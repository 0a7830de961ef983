"""Errors of actuator and sensors: what they do to the command and to what is read, exactly."""

import numpy as np
import pytest

from examples.bowden_pair import EXAMPLE
from integrate.rig import FRICTION, NOMINAL, joint, pair, run
from tendonlab.simulation.system import System

T = np.linspace(0.0, 1.0, 501)


def pulses(t):
    return np.where((t > 0.0995) & (t < 0.2995), 0.04, 0.0) - np.where((t > 0.4995) & (t < 0.5995), 0.06, 0.0)


@pytest.mark.parametrize("kind", ["hold", "linear", "smooth"])
def test_delay_of_the_command_shifts_the_response(kind):
    """A rig at rest that is late by ten samples does the same ten samples later."""
    on_time = run(pair(NOMINAL, **FRICTION), T, pulses(T), kind=kind, tolerance=1e-11)
    late = run(
        pair((*NOMINAL, "actuation:delay"), **FRICTION, actuation_delay=0.02), T, pulses(T), kind=kind, tolerance=1e-11
    )
    assert np.ptp(on_time["joint_angle"]) > 0.05
    for name in ("motor_angle", "joint_angle", "cable_torque"):
        assert np.all(late[name][:55] == 0.0)
        assert late[name][10:] == pytest.approx(on_time[name][:-10], abs=1e-8)


def test_gain_error_and_offset_of_the_actuator():
    """u (1 + e) + o: a free mass tells."""
    system = joint(("actuation:gain_error", "actuation:offset"), actuation_gain_error=0.25, actuation_offset=-0.3)
    done = run(system, T, 2.0)
    assert done["joint_velocity"] == pytest.approx(2.2 * T, rel=1e-12, abs=1e-14)


def test_gain_error_comes_before_the_offset():
    system = joint(("actuation:gain_error", "actuation:offset"), actuation_gain_error=-0.5, actuation_offset=3.5)
    assert run(system, T, 7.0)["joint_velocity"] == pytest.approx(7.0 * T, rel=1e-12, abs=1e-14)


def test_bias_adds_to_its_sensor_alone():
    plain = run(pair(NOMINAL, **FRICTION), T, pulses(T), kind="hold")
    biased = run(
        pair((*NOMINAL, "sensor.joint_angle:bias"), **FRICTION, sensor__joint_angle_bias=0.25),
        T,
        pulses(T),
        kind="hold",
    )
    assert np.array_equal(biased["joint_angle"], plain["joint_angle"] + 0.25)
    assert np.array_equal(biased["motor_angle"], plain["motor_angle"])


def test_delay_of_a_sensor_shifts_its_reading_alone():
    effects = (*NOMINAL, "sensor.motor_angle:delay")
    plain = run(pair(NOMINAL, **FRICTION), T, pulses(T), kind="hold")
    late = run(pair(effects, **FRICTION, sensor__motor_angle_delay=0.03), T, pulses(T), kind="hold")
    assert late["motor_angle"][15:] == pytest.approx(plain["motor_angle"][:-15], abs=1e-12)
    assert np.all(late["motor_angle"][:15] == 0.0)  # before the start it read what it reads at the start
    assert np.array_equal(late["joint_angle"], plain["joint_angle"])


@pytest.mark.parametrize("delay", [0.0, 0.0004, 0.0137, 0.1003])
def test_a_late_sensor_of_a_system_without_motion_goes_straight_between_samples(delay):
    """A system that answers at once: its reading is that of the samples before, from the first one on."""
    effect, name = "sensor.output_torque:delay", "sensor.output_torque_delay"
    info = System(kind="bowden_pair", parameters=EXAMPLE.parameters, effects=("sheath:capstan",))
    late = info.with_effects({effect: {name: delay}})
    time = np.linspace(0.0, 1.0, len(EXAMPLE.inputs["input_torque"]))
    found = run(late, time, EXAMPLE.inputs, by=[name], keep_zero=True)
    plain = run(info, time, EXAMPLE.inputs)["output_torque"]
    assert found["output_torque"] == pytest.approx(np.interp(time - delay, time, plain), rel=1e-12)
    step = 1e-7  # the reading is straight between samples: its rate is that of the samples around
    slope = np.interp(time - delay - step, time, plain) - np.interp(time - delay, time, plain)
    inside = time > delay + 1e-4
    assert found.gradient[name][0][inside] == pytest.approx(slope[inside] / step, rel=1e-5, abs=1e-6)


def test_delay_of_a_sensor_between_samples():
    """Constant speed: the reading lags by speed times delay, from the start on: the part moved before the record."""
    system = joint(("sensor.joint_angle:delay",), sensor__joint_angle_delay=0.0137)
    done = run(system, T, 0.0, velocity=[2.0])
    assert done["joint_angle"] == pytest.approx(2.0 * (T - 0.0137), abs=1e-12)

"""A servo under its own position control: what pen and paper give, exact derivatives, and a measured servo."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import tendonlab as tl
from integrate.rig import differences, relative, run

TIGHT = 1e-11
SERVO = {
    "inertia": 0.005,
    "armature": 0.003,
    "gravity_torque": 0.0,
    "torque_constant": 0.5,
    "resistance": 4.0,
    "proportional_gain": 20.0,
    "voltage_limit": 6.0,
    "angle_offset": 0.0,
}


def servo(*effects: str, **parameters: float) -> tl.System:
    return tl.System(kind="servo_pendulum", parameters={**SERVO, **parameters}, effects=effects)


def test_it_sags_where_its_torque_balances_gravity() -> None:
    """k_t k_p (target - q - offset) / R = g sin q, once viscous friction has damped the swing."""
    time = np.linspace(0.0, 20.0, 201)
    system = servo("joint:viscous", gravity_torque=0.4, angle_offset=0.1, viscous=0.05)
    done = run(system, time, {"target_angle": np.full_like(time, 1.0)}, position=[0.7], tolerance=TIGHT)
    rest = brentq(lambda q: 0.5 * 20.0 * (1.0 - q - 0.1) / 4.0 - 0.4 * np.sin(q), 0.0, 1.0, xtol=1e-14)
    assert done["joint_angle"][-1] == pytest.approx(rest, abs=1e-8)


@pytest.mark.parametrize("supply", [None, 9.0])
def test_at_the_limit_of_voltage_back_emf_limits_the_speed(supply: float | None) -> None:
    """q' = V/k_t (1 - exp(-t/T)), T = (J + J_a) R / k_t^2; a logged supply voltage is the limit in place of V_max."""
    time = np.linspace(0.0, 1.0, 201)
    inputs = {"target_angle": np.full_like(time, 1e3)}
    if supply is not None:
        inputs["supply_voltage"] = np.full_like(time, supply)
    done = run(servo(), time, inputs, tolerance=TIGHT)
    late = time / (0.008 * 4.0 / 0.25)
    assert done["joint_velocity"] == pytest.approx((supply or 6.0) / 0.5 * (1.0 - np.exp(-late)), abs=1e-7)


def test_within_the_limit_it_rings_like_a_damped_spring() -> None:
    """(J + J_a) q'' = -k_t k_p/R q - k_t^2/R q', from 0.1 rad at rest."""
    time = np.linspace(0.0, 1.0, 201)
    done = run(servo(), time, {"target_angle": np.zeros_like(time)}, position=[0.1], tolerance=TIGHT)
    decay = 0.5 * 0.25 / 4.0 / 0.008
    frequency = np.sqrt(0.5 * 20.0 / 4.0 / 0.008 - decay**2)
    phase = frequency * time
    expected = 0.1 * np.exp(-decay * time) * (np.cos(phase) + decay / frequency * np.sin(phase))
    assert done["joint_angle"] == pytest.approx(expected, abs=1e-7)


def test_without_torque_it_coasts_and_keeps_its_energy() -> None:
    """Driven for 1 s, then a pendulum without friction, whatever the target asks."""
    time = np.linspace(0.0, 20.0, 2001)
    enabled = np.where(time < 0.995, 1.0, 0.0)
    inputs = {"target_angle": 1.5 * np.sin(5.0 * time), "torque_enable": enabled}
    done = run(servo(gravity_torque=0.4), time, inputs, kind="hold", tolerance=TIGHT)
    energy = 0.5 * 0.008 * done["joint_velocity"] ** 2 - 0.4 * np.cos(done["joint_angle"])
    assert np.ptp(energy[:100]) > 0.1
    assert energy[100:] == pytest.approx(energy[100], abs=0.4 * 1e-6)  # 1e-10 a step, a few thousand steps


@pytest.mark.parametrize("name", [*SERVO, "coulomb", "viscous"])
def test_derivatives_match_differences(name: str) -> None:
    """On a record that meets the limit, sticks, reverses and ends coasting. The stepper does not land on the clip, a
    kink: that leaves 1e-5 of the derivative at this tolerance, and 1e-6 of differences over this step."""
    time = np.linspace(0.0, 1.0, 201)
    inputs = {
        "target_angle": 1.2 * np.sin(7.0 * time),
        "torque_enable": np.where(time < 0.8, 1.0, 0.0),
    }
    system = servo("joint:coulomb", "joint:viscous", gravity_torque=0.4, angle_offset=0.05, coulomb=0.04, viscous=0.01)
    asked = 20.0 * (inputs["target_angle"] - run(system, time, inputs, kind="hold")["joint_angle"] - 0.05)
    assert np.max(np.abs(asked)) > 6.0 > np.min(np.abs(asked))
    exact = run(system, time, inputs, kind="hold", by=[name], tolerance=TIGHT)
    step = 1e-4 * abs(system.parameters[name])
    answer = differences(system, name, time, inputs, kind="hold", tolerance=TIGHT, step=step)
    for got, wanted in zip(exact.gradient[name], answer, strict=True):
        assert relative(got, wanted) < 1e-4


# A measured servo: Duclusaud, Passault, Padois, Ly, ICRA 2025. A pendulum of 0.49 kg at 0.10 m.


def test_a_measured_servo_with_another_gain_is_predicted_better_than_guessed(measured_servo: Path) -> None:
    logged = tl.load(measured_servo)
    some = tuple(e for e in logged.experiments if e.name.startswith(("sin_sin", "lift_and_drop")))
    rig = replace(logged, experiments=some)
    fit = tl.identify(rig, progress=False)
    assert fit.converged
    assert errors(fit.system, rig) < 0.75 * errors(rig.system(), rig)


def test_no_log_of_a_measured_servo_is_blamed(measured_servo: Path) -> None:
    """Its motor is known from a data sheet only, and its friction depends on the load."""
    assert not tl.check(tl.load(measured_servo)).blocks


def errors(system: tl.System, rig: tl.Dataset) -> float:
    """Root mean square error of the joint angle over the records that were held out, rad."""
    squares = []
    for experiment in [e for e in rig.experiments if e.split == "test"]:
        error = system.simulate(experiment)["joint_angle"].to_numpy() - experiment.data["joint_angle"].to_numpy()
        squares.append(np.mean(error**2))
    return float(np.sqrt(np.mean(squares)))

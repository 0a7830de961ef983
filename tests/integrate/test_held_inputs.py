"""Inputs held from sample to sample: short explicit steps where nothing is stiff, Rosenbrock steps elsewhere."""

import numpy as np
import pytest

from integrate.rig import FRICTION, NOMINAL, controller, joint, pair, relative, run
from tendonlab.simulation.signals import smooth

T = np.linspace(0.0, 2.0, 2001)
COMMAND = 0.06 * np.sin(2 * np.pi * T) + 0.03 * np.sin(2 * np.pi * 2.3 * T + 1.0)
STIFF = {"coulomb": 1.0, "viscous": 0.4, "joint_bristle_stiffness": 1e5, "joint_bristle_damping": 300.0}
CASES = {
    "stick and slip": (pair(NOMINAL, **FRICTION), COMMAND),
    "backlash": (pair((*NOMINAL, "cable:backlash"), **FRICTION, cable_backlash=0.01), COMMAND),
    "stiff bristle": (joint(("joint:coulomb", "joint:viscous", "joint:presliding"), **STIFF), 40.0 * COMMAND),
}


def damped(command: np.ndarray, inertia: float, viscous: float) -> np.ndarray:
    """Exact motion of a damped mass from rest, its force held from sample to sample."""
    step, rate = T[1] - T[0], viscous / inertia
    decay = np.exp(-rate * step)
    q = np.zeros(len(T))
    v = 0.0
    for k, force in enumerate(command[:-1]):
        final = force / viscous
        q[k + 1] = q[k] + final * step + (v - final) * (1.0 - decay) / rate
        v = final + (v - final) * decay
    return q


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-9])
def test_damped_mass_moves_as_its_exact_solution(tolerance):
    found = run(joint(("joint:viscous",), viscous=0.4), T, COMMAND, kind="hold", tolerance=tolerance)
    assert relative(found["joint_angle"], damped(COMMAND, 1.0, 0.4)) < 0.01 * tolerance
    assert found.attempts < 1.02 * len(T)  # one step per sample


@pytest.mark.parametrize("case", CASES)
def test_error_falls_with_the_tolerance(case):
    system, command = CASES[case]
    best = run(system, T, command, kind="hold", tolerance=1e-13).table
    for tolerance in (1e-4, 1e-6, 1e-8):
        found = run(system, T, command, kind="hold", tolerance=tolerance).table
        assert max(relative(a, b) for a, b in zip(found, best, strict=True)) < 100.0 * tolerance


def test_a_stiff_memory_costs_few_rejected_steps():
    """What is too stiff for explicit steps is seen by their error and left to Rosenbrock steps."""
    system, command = CASES["stiff bristle"]
    found = run(system, T, command, kind="hold", tolerance=1e-6)
    assert found.rejected < 0.1 * found.attempts


def test_noise_that_turns_a_joint_costs_few_steps():
    """A step that ends on an event is followed by explicit ones up to the next sample, not by a short Rosenbrock step:
    with those, 1.6 steps for each sample and event."""
    draw = np.random.default_rng(1)
    system, command = pair(NOMINAL, **FRICTION), 0.05 * draw.standard_normal(len(T))
    logged = smooth(T, 0.02 * np.sin(2 * np.pi * 0.8 * T) + 1.1e-4 * draw.standard_normal(len(T)))
    loop = controller(logged, kind="injection", proportional=0.64, derivative=0.03)
    found, best = (run(system, T, command, kind="hold", loop=loop, tolerance=t) for t in (1e-4, 1e-9))
    assert found.events > 0.2 * len(T)
    assert found.attempts < 1.5 * (len(T) + found.events)
    assert max(relative(a, b) for a, b in zip(found.table, best.table, strict=True)) < 1e-4


def test_a_late_sensor_of_an_injection_costs_one_more_step_per_sample():
    """The knots of the log that the injection reads ahead in lie between the samples of the command."""
    draw = np.random.default_rng(0)
    command = COMMAND + 0.05 * draw.standard_normal(len(T))
    system = pair((*NOMINAL, "sensor.motor_angle:delay"), **{**FRICTION, "motor_coulomb": 0.0, "joint_coulomb": 0.0},
                  sensor__motor_angle_delay=3.3e-4)  # fmt: skip
    logged = smooth(T, 2.0 * np.sin(2 * np.pi * 0.8 * T) + 3e-4 * draw.standard_normal(len(T)))
    loop = controller(logged, kind="injection", proportional=0.5, derivative=0.02)
    found = run(system, T, command, kind="hold", loop=loop, tolerance=1e-4, velocity=[10.0, 1.0])
    assert found.attempts < 2.2 * len(T)

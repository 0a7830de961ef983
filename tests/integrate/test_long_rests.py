"""Where everything sticks, steps pass over the samples of smooth inputs, and end where something may break away."""

import numpy as np
import pytest

from integrate.rig import FRICTION, NOMINAL, Run, controller, joint, pair, run, run_many
from tendonlab.simulation.signals import linear
from tendonlab.simulation.system import System

T = np.linspace(0.0, 4.0, 4001)
DRY = ("joint:coulomb", "joint:viscous")
JOINT = joint(DRY, coulomb=1.0, viscous=0.5)
RAMP = 0.4 * T  # reaches the joint's friction at 2.5 s


def pushed(command: np.ndarray, *, kind: str = "linear", system: System = JOINT, ports: bool = False) -> Run:
    return run(system, T, command, kind=kind, tolerance=1e-6, ports=ports)


@pytest.mark.parametrize("kind", ["linear", "smooth"])
def test_a_joint_at_rest_costs_no_step_per_sample(kind: str) -> None:
    found = pushed(0.9 * np.sin(2.0 * np.pi * T), kind=kind)
    assert np.all(found["joint_angle"] == 0.0)
    assert found.attempts < 5


def test_a_joint_breaks_away_when_the_push_on_it_reaches_its_friction() -> None:
    """J v' = 0.4 (t - 2.5) - 0.5 v from there on."""
    since = np.maximum(T - 2.5, 0.0)
    exact = 0.8 * (since - 2.0 * (1.0 - np.exp(-0.5 * since)))
    found = pushed(RAMP)
    np.testing.assert_allclose(found["joint_velocity"], exact, atol=1e-5)
    assert np.all(found["joint_velocity"][T < 2.5] == 0.0)
    assert found.attempts < 100


def test_a_push_that_is_gone_at_the_end_of_the_rest_is_not_passed_over() -> None:
    """One sample above the friction, in four seconds below it."""
    command = np.full(T.size, 0.5)
    command[2000] = 2.0
    found = pushed(command)
    assert found.events == 2
    # Above 1 N m for 2/3 of a sample on each side, by 1 N m at most; then below it for 1/3 of one, by 0.5 N m at most.
    assert np.max(found["joint_velocity"]) == pytest.approx((2.0 / 3.0 - 1.0 / 12.0) * 1e-3, rel=1e-3)


def test_forces_are_those_of_each_sample() -> None:
    command = 0.9 * np.sin(2.0 * np.pi * T)
    velocity, position, _, force = pushed(command, ports=True).ports["joint"]
    np.testing.assert_allclose(force, command, rtol=0.0, atol=1e-12)
    assert np.all(velocity == 0.0)
    assert np.all(position == 0.0)


def test_a_limit_is_met_in_the_middle_of_a_rest() -> None:
    """A controller that pushes on a joint at rest up to its limit, below the friction, and beyond: the port shows what
    it commands."""
    reference = 0.5 * np.sin(2.0 * np.pi * T)
    closed = controller(linear(T, reference), proportional=1.0, derivative=0.0, limit=0.3)
    found = run(JOINT, T, loop=closed, ports=True)
    np.testing.assert_allclose(found.ports["joint"][3], np.clip(reference, -0.3, 0.3), rtol=0.0, atol=1e-12)
    assert found.attempts < 0.02 * T.size


@pytest.mark.parametrize("late", [0.0, 5e-5, 0.02])
def test_a_late_push_breaks_away_later(late: float) -> None:
    system = joint((*DRY, "actuation:delay"), coulomb=1.0, viscous=0.5, actuation_delay=late)
    begins = T[np.argmax(pushed(RAMP, system=system)["joint_velocity"] > 0.0)]
    assert begins == pytest.approx(2.5 + late, abs=2.1e-3)


def test_two_parts_at_rest_and_one_of_them() -> None:
    """The motor breaks away first, winds up the cable, and stops again: the joint never moves."""
    system = pair(NOMINAL, **FRICTION)
    command = 0.0045 * np.sin(2.0 * np.pi * 0.5 * T)
    found = pushed(command, system=system)
    best = run(system, T, command, kind="linear", tolerance=1e-11)
    assert np.all(found["joint_angle"] == 0.0)
    np.testing.assert_allclose(found["motor_angle"], best["motor_angle"], atol=1e-5 * np.max(best["motor_angle"]))
    assert found.attempts < 0.8 * T.size


def test_derivatives_pass_a_rest() -> None:
    """By the friction that a ramp has to overcome: v = 0.8 (s - 2 (1 - exp(-s / 2))), s = t - F / 0.4."""
    found = run(JOINT, T, RAMP, kind="linear", tolerance=1e-8, by=("coulomb", "velocity0"))
    since = np.maximum(T - 2.5, 0.0)
    np.testing.assert_allclose(found.gradient["coulomb"][1], -2.0 * (1.0 - np.exp(-0.5 * since)), atol=1e-6)


def test_lanes_rest_as_long_as_each_alone() -> None:
    systems = [joint(DRY, coulomb=level, viscous=0.5) for level in (0.3, 0.7, 1.0, 1.2, 2.0)]
    command = 1.5 * np.sin(2.0 * np.pi * 0.5 * T)
    many = run_many(systems, T, {"motor_torque": command}, kind="linear", tolerance=1e-6)
    for found, system in zip(many, systems, strict=True):
        alone = run(system, T, command, kind="linear", tolerance=1e-6).table
        np.testing.assert_allclose(found, alone, rtol=0.0, atol=1e-5 * max(np.abs(alone).max(), 1e-9))

"""The points of a sweep take their steps together, eight at a time: with every effect of every system, and under every
kind of loop, each agrees with its own simulation to ten times the tolerance."""

from typing import Any

import numpy as np
import pytest

from examples import T, example, with_effect
from integrate.rig import FRICTION, INERTIAS, NOMINAL, controller, joint, pair, run, run_many
from tendonlab.simulation.catalog import kinds, system_info
from tendonlab.simulation.signals import averaged, hold, linear, smooth
from tendonlab.simulation.system import System

SLOWEST = ("cable_joint", "ccsrm")
TOLERANCE = 1e-8
STEPPED = [kind for kind in kinds() if not system_info(kind).sampled]
WAVE = 0.4 * np.sin(9.0 * T) + 0.1 * np.sin(31.0 * T)


def assert_each_is_alone(systems: list[System], time: np.ndarray, inputs: dict[str, np.ndarray], **how: Any) -> None:
    together = run_many(systems, time, inputs, tolerance=TOLERANCE, **how)
    assert np.isfinite(together).all()
    for k, system in enumerate(systems):
        alone = run(system, time, inputs, tolerance=TOLERANCE, **how).table
        scale = np.abs(alone).max(axis=1, keepdims=True) + 1e-9
        assert np.abs((together[k] - alone) / scale).max() < 10 * TOLERANCE, (k, system.effects)


def scattered(system: System, effect: str) -> list[System]:
    """The system with the parameters of the effect a few per cent apart: lanes that take different steps."""
    names = [n for n in system.info.effect(effect).parameters if system.parameters.get(n, 0.0) != 0.0]
    rows = [system.info.parameter(n) for n in names]
    return [
        system.with_parameters(
            {r.name: float(np.clip(factor * system.parameters[r.name], r.lower, r.upper)) for r in rows}
        )
        for factor in (1.0, 0.97, 0.9)
    ]


@pytest.mark.parametrize(("kind", "effect"), [(kind, e.name) for kind in STEPPED for e in system_info(kind).effects])
def test_every_effect_in_lanes(kind: str, effect: str) -> None:
    of, samples = example(kind).run_of(effect), 31 if kind in SLOWEST else 101
    inputs = {name: values[:samples] for name, values in of.inputs.items()}
    assert_each_is_alone(scattered(with_effect(kind, effect), effect), T[:samples], inputs, kind=of.between)


@pytest.mark.parametrize("late", [False, True], ids=["prompt", "late"])
@pytest.mark.parametrize("kind", STEPPED)
def test_an_output_alone_is_the_same_to_the_last_bit(kind: str, late: bool) -> None:
    """Forces that no wanted output is made of are not computed."""
    names = [output.name for output in system_info(kind).outputs]
    system = with_effect(kind, f"sensor.{names[0]}:delay")
    if not late:
        system = system.with_parameters({f"sensor.{names[0]}_delay": 0.0})
    of = example(kind).run_of(f"sensor.{names[0]}:delay")
    inputs = {name: values[:31] for name, values in of.inputs.items()}
    everything = run_many([system], T[:31], inputs, kind=of.between)
    for k in range(len(names)):
        alone = run_many([system], T[:31], inputs, kind=of.between, outputs=[k])
        np.testing.assert_array_equal(alone[:, 0], everything[:, k])


@pytest.mark.parametrize(
    "loop",
    [
        controller(smooth(T, WAVE), proportional=3.0, derivative=0.2),
        controller(smooth(T, WAVE), proportional=3.0, derivative=0.2, limit=0.3),
        controller(hold(T, np.sign(WAVE)), proportional=3.0, derivative=0.2, disturbance=smooth(T, 0.1 * WAVE)),
        controller(smooth(T, WAVE), proportional=3.0, derivative=0.2, sample_time=0.0137, limit=0.4),
        controller(smooth(T, WAVE), kind="injection", proportional=3.0, derivative=0.2),
    ],
    ids=["continuous", "limited", "held reference", "sampled", "injection"],
)
@pytest.mark.parametrize("late", [(), ("actuation:delay", "sensor.joint_angle:delay")], ids=["prompt", "late"])
def test_every_loop_in_lanes(loop: Any, late: tuple[str, ...]) -> None:
    delays = dict(zip(("actuation_delay", "sensor.joint_angle_delay"), (0.004, 0.003), strict=True)) if late else {}
    values = {"inertia": 0.02, "gravity_torque": 0.3, "coulomb": 0.05, "viscous": 0.02, **delays}
    one = joint(("joint:coulomb", "joint:viscous", *late), **values)
    systems = [one.with_parameters({"coulomb": 0.05 * k, "inertia": 0.02 * (1 + 0.1 * k)}) for k in (1.0, 0.5, 2.0)]
    assert_each_is_alone(systems, T, {"motor_torque": 0.1 * WAVE}, loop=loop, position=[0.1])


@pytest.mark.parametrize("jitter", [1e-9, 0.01, 0.09], ids=["rounded", "uneven", "very uneven"])
@pytest.mark.parametrize("between", [smooth, averaged, linear])
def test_uneven_stamps_in_lanes(between: Any, jitter: float) -> None:
    """The pieces of an input are found by their mean length: lanes look into the same ones as a single simulation."""
    stamps = T + jitter * (T[1] - T[0]) * np.sin(1e4 * T)
    loop = controller(between(stamps, WAVE), kind="injection", proportional=3.0, derivative=0.2)
    one = joint(("joint:viscous",), inertia=0.02, viscous=0.02)
    systems = [one.with_parameters({"inertia": 0.02 * factor}) for factor in (1.0, 0.93, 1.11)]
    assert_each_is_alone(systems, stamps, {"motor_torque": 0.1 * WAVE}, loop=loop)


def test_points_with_different_effects_and_modes_in_one_call() -> None:
    """Backlash with a flank to find, ports that stick, held inputs: whatever flags and modes, each point is its own."""
    plain = pair(NOMINAL, **{**INERTIAS, **FRICTION})
    loose = pair((*NOMINAL, "cable:backlash"), **{**INERTIAS, **FRICTION, "cable_backlash": 0.02})
    systems = [
        system.with_parameters({"joint_coulomb": level})
        for level in (0.05, 0.0, 0.2, 0.1, 0.01)
        for system in (plain, loose)
    ]
    assert_each_is_alone(systems, T, {"motor_torque": 0.05 * np.sign(WAVE)}, kind="hold")

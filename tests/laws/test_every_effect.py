"""What holds for every law in every place of every system: off means off, and derivatives are those of the motion."""

import numpy as np
import pytest

from integrate.rig import FRICTION, INERTIAS, differences, relative, run
from tendonlab.catalog import kinds, system_info
from tendonlab.system import System

T = np.linspace(0.0, 1.0, 201)
COMMAND = np.sin(2 * np.pi * T) + 0.5 * np.sin(2 * np.pi * 2.3 * T + 1.0)
OWN = {
    "rigid_joint": {"inertia": 0.02, "gravity_torque": 0.3, "torque_constant": 1.0, "coulomb": 0.05, "viscous": 0.02},
    "two_inertia": {**INERTIAS, **FRICTION, "gravity_torque": 0.3},
}
PUSH = {"rigid_joint": 0.6, "two_inertia": 0.06}  # N·m
MOTOR_SIDE = ("motor", "actuation", "sensor.motor_angle")


def scale(kind: str, element: str, dimension: str) -> float:
    """What is of the order of the motion; at the motor N times or 1/N of it. A delay does not end on a sample: the
    start of the record is a kink there."""
    ratio = 10.0 if kind == "two_inertia" and element in MOTOR_SIDE else 1.0
    effort, displacement, flow = 0.5 / ratio, 0.1 * ratio, 1.0 * ratio
    return {
        "effort": effort,
        "displacement": displacement,
        "output": displacement,
        "flow": flow,
        "stiffness": effort / displacement,
        "damping": effort / flow,
        "time": 0.94,
    }.get(dimension, 1.0)


def pairs() -> list[tuple[str, str]]:
    return [(kind, e.name) for kind in kinds() for e in system_info(kind).effects if not e.structural]


def rig(kind: str, effect: str, *, off: bool = False) -> System:
    """The nominal system with `effect`, its parameters at their typical values, or its amplitudes at 0."""
    info = system_info(kind)
    values = {}
    for name in info.effect(effect).parameters:
        row = info.parameter(name)
        typical = row.typical * scale(kind, row.element or "", row.dimension)
        values[name] = 0.0 if off and row.amplitude else OWN[kind].get(name, typical)
    nominal = info.default_nominal_effects
    effects = nominal if effect in nominal else (*nominal, effect)
    known = {n: v for n, v in OWN[kind].items() if n in {p.name for p in info.parameters}}
    return System(kind=kind, parameters={**known, **values}, effects=effects)


@pytest.mark.parametrize(("kind", "effect"), pairs())
def test_off_means_the_bits_of_the_system_without_it(kind: str, effect: str) -> None:
    off = rig(kind, effect, off=True)
    without = System(
        kind=kind,
        parameters={n: v for n, v in off.parameters.items() if n not in off.info.effect(effect).parameters},
        effects=tuple(e for e in off.effects if e != effect),
    )
    found = run(off, T, PUSH[kind] * COMMAND, tolerance=1e-6).table
    assert np.array_equal(found, run(without, T, PUSH[kind] * COMMAND, tolerance=1e-6).table)


@pytest.mark.parametrize(("kind", "effect"), pairs())
def test_derivatives_match_central_differences(kind: str, effect: str) -> None:
    """From rest, through stick and reversals. Kinks of |load| are not landed on: that leaves 1e-5 at this tolerance."""
    system = rig(kind, effect)
    by = list(system.info.effect(effect).parameters)
    exact = run(system, T, PUSH[kind] * COMMAND, by=by, tolerance=1e-11)
    assert exact.events > 0
    for name in by:
        step = 1e-4 * (abs(system.parameters[name]) or 1.0)
        if name.endswith("presliding_share"):  # at its upper bound
            continue
        found = differences(system, name, T, PUSH[kind] * COMMAND, step=step, tolerance=1e-12)
        for got, wanted, output in zip(exact.gradient[name], found, exact.table, strict=True):
            noise = 1e-11 * np.sqrt(np.mean(output**2)) / step
            assert relative(got, wanted) < 1e-4 or np.max(abs(got - wanted)) < noise, name

"""What holds for every law in every place of every system: off means off, and every derivative is the difference."""

from collections.abc import Sequence, Set

import numpy as np
import pytest

from examples import T, example, with_effect
from integrate.rig import Run, relative, run
from tendonlab.simulation.catalog import LEVEL, REFINES, ParameterInfo, kinds, system_info
from tendonlab.simulation.system import System

SLOWEST = ("cable_joint", "ccsrm")  # simulated for 0.3 s only, which holds reversals as well
TOLERANCE = 1e-10
TIGHT = 1e-12  # of the differenced runs
STEP = 1e-3  # of each parameter: the differences are of order four
STENCILS = (  # weights of the values at so many steps: central, or to one side of a bound
    {-2: 1 / 12, -1: -2 / 3, 1: 2 / 3, 2: -1 / 12},
    {0: -25 / 12, 1: 4.0, 2: -3.0, 3: 4 / 3, 4: -1 / 4},
    {0: 25 / 12, -1: -4.0, -2: 3.0, -3: -4 / 3, -4: 1 / 4},
)


def pairs(*, structural: bool) -> list[tuple[str, str]]:
    """All effects of all systems; `structural`: also those that are part of their system."""
    return [(kind, e.name) for kind in kinds() for e in system_info(kind).effects if structural or not e.structural]


def without_effects(system: System, effects: Set[str]) -> System:
    gone = {name for effect in effects for name in system.info.effect(effect).parameters}
    return System(
        kind=system.kind,
        parameters={n: v for n, v in system.parameters.items() if n not in gone},
        effects=tuple(e for e in system.effects if e not in effects),
    )


def dependants(kind: str, effect: str) -> set[str]:
    """Nominal effects that need `effect`: those that share its parameters, and those that refine the dry friction of
    which it is the only level."""
    info = system_info(kind)
    of = info.effect(effect)
    nominal = [info.effect(name) for name in info.default_nominal_effects]
    here = [e for e in nominal if e.element == of.element and e.name != effect]
    alone = of.roles & LEVEL and not any(e.roles & LEVEL for e in here)
    return {e.name for e in here if effect in e.needs or (alone and e.roles & REFINES)}


def below_one(system: System, name: str) -> System:
    """The same with that share below 1: at 1 nothing of the dry friction is left to stick, a kink of the model."""
    row = system.info.parameter(name)
    full = row.purpose == "share" and system.parameters[name] == row.upper
    return system.with_parameters({name: 0.9}) if full else system


def simulate(system: System, effect: str, *, by: Sequence[str] = (), tolerance: float = TOLERANCE) -> Run:
    of, samples = example(system.kind).run_of(effect), 61 if system.kind in SLOWEST else T.size
    inputs = {name: values[:samples] for name, values in of.inputs.items()}
    return run(system, T[:samples], inputs, kind=of.between, by=by, tolerance=tolerance)


def difference(system: System, effect: str, row: ParameterInfo, step: float) -> np.ndarray:
    """Derivative of all outputs by a parameter, (outputs, samples), from values inside its bounds."""
    value = system.parameters[row.name]
    stencil = next(of for of in STENCILS if all(row.lower <= value + k * step <= row.upper for k in of))
    moved = {k: system.with_parameters({row.name: value + k * step}) for k in stencil}
    values = [w * simulate(moved[k], effect, tolerance=TIGHT).table for k, w in stencil.items()]
    return np.asarray(sum(values) / step)


@pytest.mark.parametrize(("kind", "effect"), pairs(structural=False))
def test_off_means_the_bits_of_the_system_without_it(kind: str, effect: str) -> None:
    off = without_effects(with_effect(kind, effect, off=True), dependants(kind, effect))
    without = without_effects(off, {effect})
    answer = simulate(off, effect, tolerance=1e-6).table
    assert np.array_equal(answer, simulate(without, effect, tolerance=1e-6).table)


@pytest.mark.parametrize(("kind", "effect"), pairs(structural=True))
def test_derivatives_by_all_its_parameters_match_differences(kind: str, effect: str) -> None:
    """From rest, through stick and reversals. Kinks of |load| are not landed on: that leaves 1e-5 at this tolerance."""
    system = with_effect(kind, effect)
    by = system.info.effect(effect).parameters
    exact = simulate(system, effect, by=by)
    assert exact.events > 0 or not example(kind).events
    assert list(exact.gradient) == list(by) != []
    for name in by:
        there = below_one(system, name)
        of = exact if there == system else simulate(there, effect, by=[name])
        share = 0.1 * STEP if system.info.sampled else STEP  # a sampled system has no error of a stepper
        step = share * (abs(there.parameters[name]) or 1.0)
        answer = difference(there, effect, system.info.parameter(name), step)
        noise = TOLERANCE * np.sqrt(np.mean(of.table**2, axis=1)) / step
        moved = np.max(abs(answer), axis=1) > 10.0 * noise
        assert np.any(moved), f"{name} moves no output of the example: state a run in its `acting`"
        for got, wanted, error in zip(of.gradient[name], answer, noise, strict=True):
            assert relative(got, wanted) < 1e-4 or np.max(abs(got - wanted)) < error, name

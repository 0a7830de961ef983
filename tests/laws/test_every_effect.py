"""What holds for every law in every place of every system: off means off, and derivatives are those of the motion."""

from collections.abc import Set

import numpy as np
import pytest

from examples import T, example, with_effect
from integrate.rig import differences, relative, run
from tendonlab.simulation.catalog import LEVEL, REFINES, kinds, system_info
from tendonlab.simulation.system import System


def pairs() -> list[tuple[str, str]]:
    return [(kind, e.name) for kind in kinds() for e in system_info(kind).effects if not e.structural]


def without_effects(system: System, effects: Set[str]) -> System:
    gone = {name for effect in effects for name in system.info.effect(effect).parameters}
    return System(
        kind=system.kind,
        parameters={n: v for n, v in system.parameters.items() if n not in gone},
        effects=tuple(e for e in system.effects if e not in effects),
    )


def dependants(kind: str, effect: str) -> set[str]:
    """Nominal effects that cannot do without `effect`: what shares its parameters, and what refines the dry friction of
    which it is the only level."""
    info = system_info(kind)
    of = info.effect(effect)
    nominal = [info.effect(name) for name in info.default_nominal_effects]
    here = [e for e in nominal if e.element == of.element and e.name != effect]
    alone = of.roles & LEVEL and not any(e.roles & LEVEL for e in here)
    return {e.name for e in here if effect in e.needs or (alone and e.roles & REFINES)}


@pytest.mark.parametrize(("kind", "effect"), pairs())
def test_off_means_the_bits_of_the_system_without_it(kind: str, effect: str) -> None:
    of = example(kind)
    off = without_effects(with_effect(kind, effect, off=True), dependants(kind, effect))
    without = without_effects(off, {effect})
    found = run(off, T, of.inputs, kind=of.between, tolerance=1e-6).table
    assert np.array_equal(found, run(without, T, of.inputs, kind=of.between, tolerance=1e-6).table)


@pytest.mark.parametrize(("kind", "effect"), pairs())
def test_derivatives_match_central_differences(kind: str, effect: str) -> None:
    """From rest, through stick and reversals. Kinks of |load| are not landed on: that leaves 1e-5 at this tolerance."""
    of, system = example(kind), with_effect(kind, effect)
    by = list(system.info.effect(effect).parameters)
    exact = run(system, T, of.inputs, kind=of.between, by=by, tolerance=1e-11)
    assert exact.events > 0 or not of.events
    for name in by:
        row = system.info.parameter(name)
        value = system.parameters.get(name, row.typical)
        step = 1e-4 * (abs(value) or 1.0)
        if not row.lower < value - 2 * step < value + 2 * step < row.upper:
            continue  # at a bound there are no central differences
        found = differences(system, name, T, of.inputs, kind=of.between, step=step, tolerance=1e-12)
        for got, wanted, output in zip(exact.gradient[name], found, exact.table, strict=True):
            noise = 1e-11 * np.sqrt(np.mean(output**2)) / step
            assert relative(got, wanted) < 1e-4 or np.max(abs(got - wanted)) < noise, name

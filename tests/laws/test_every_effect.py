"""What holds for every law in every place of every system: off means off, and derivatives are those of the motion."""

import numpy as np
import pytest

from examples import T, example, with_effect
from integrate.rig import differences, relative, run
from tendonlab.catalog import kinds, system_info
from tendonlab.system import System


def pairs() -> list[tuple[str, str]]:
    return [(kind, e.name) for kind in kinds() for e in system_info(kind).effects if not e.structural]


@pytest.mark.parametrize(("kind", "effect"), pairs())
def test_off_means_the_bits_of_the_system_without_it(kind: str, effect: str) -> None:
    of = example(kind)
    off = with_effect(kind, effect, off=True)
    without = System(
        kind=kind,
        parameters={n: v for n, v in off.parameters.items() if n not in off.info.effect(effect).parameters},
        effects=tuple(e for e in off.effects if e != effect),
    )
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

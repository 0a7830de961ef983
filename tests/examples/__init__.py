"""One running example of every system, in a module of its name: what the tests of all systems simulate."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module

import numpy as np

from tendonlab.catalog import system_info
from tendonlab.system import System

T = np.linspace(0.0, 1.0, 201)


@dataclass(frozen=True, kw_only=True)
class Example:
    """`parameters`: of the system with its default nominal effects. `inputs`: by name, given at T. `scale(element,
    dimension)`: what is of the order of the motion there, 1 for ratios. `events`: whether modes change on the way.
    `between`: what the inputs are between samples."""

    parameters: Mapping[str, float]
    inputs: Mapping[str, np.ndarray]
    scale: Callable[[str, str], float]
    events: bool = True
    between: str = "smooth"


def example(kind: str) -> Example:
    """That of a system; a new system needs a module tests/examples/<kind>.py with EXAMPLE."""
    found = import_module(f"examples.{kind}").EXAMPLE
    assert isinstance(found, Example)
    return found


def with_effect(kind: str, effect: str, *, off: bool = False) -> System:
    """The nominal system with `effect`, its parameters at their typical values, or its amplitudes at 0."""
    info, of = system_info(kind), example(kind)
    values = {}
    for name in info.effect(effect).parameters:
        row = info.parameter(name)
        typical = row.typical * of.scale(row.element or "", row.dimension)
        values[name] = 0.0 if off and row.amplitude else of.parameters.get(name, typical)
    nominal = info.default_nominal_effects
    effects = nominal if effect in nominal else (*nominal, effect)
    return System(kind=kind, parameters={**of.parameters, **values}, effects=effects)

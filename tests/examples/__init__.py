"""One running example of every system, in a module of its name: what the tests of all systems simulate."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module

import numpy as np

from tendonlab.simulation.catalog import FACTOR, LEVEL, MEMORY, SystemInfo, system_info
from tendonlab.simulation.system import System

T = np.linspace(0.0, 1.0, 201)


@dataclass(frozen=True, kw_only=True)
class Acting:
    """A run on which all parameters of one effect act. `parameters` replace the typical ones. `inputs`, where there are
    any, replace those of the example; `between` says what they are between samples."""

    parameters: Mapping[str, float] = field(default_factory=dict)
    inputs: Mapping[str, np.ndarray] = field(default_factory=dict)
    between: str = "smooth"


@dataclass(frozen=True, kw_only=True)
class Example:
    """`parameters`: of the system with its default nominal effects and `effects`. `inputs`: by name, given at T.
    `scale(element, dimension)`: what is of the order of the motion there, 1 for ratios. `events`: whether modes change
    on the way. `between`: what the inputs are between samples. `acting`: by effect, a run on which it acts, where the
    example at typical values shows less than all of its parameters."""

    parameters: Mapping[str, float]
    inputs: Mapping[str, np.ndarray]
    scale: Callable[[str, str], float]
    events: bool = True
    between: str = "smooth"
    effects: tuple[str, ...] = ()
    acting: Mapping[str, Acting] = field(default_factory=dict)

    def run_of(self, effect: str) -> Acting:
        """The inputs that make `effect` act."""
        own = self.acting.get(effect, Acting())
        return own if own.inputs else Acting(inputs=self.inputs, between=self.between)


def example(kind: str) -> Example:
    """That of a system; a new system needs a module tests/examples/<kind>.py with EXAMPLE."""
    found = import_module(f"examples.{kind}").EXAMPLE
    assert isinstance(found, Example)
    return found


def ground(info: SystemInfo, effect: str) -> tuple[str, ...]:
    """A level of dry friction for an effect that only shapes one, where the nominal system has none in its element."""
    one = info.effect(effect)
    levels = [e.name for e in info.effects if e.element == one.element and e.roles & LEVEL]
    bare = one.roles & (MEMORY | FACTOR) and levels and not set(levels) & set(info.default_nominal_effects)
    return (levels[0],) if bare else ()


def with_effect(kind: str, effect: str, *, off: bool = False) -> System:
    """The nominal system with `effect`, its parameters at values that act, or its amplitudes at 0."""
    info, of = system_info(kind), example(kind)
    effects = [*info.default_nominal_effects, *of.effects]
    added = [] if info.effect(effect).structural else [*ground(info, effect), effect]
    effects += [name for name in added if name not in effects]
    values = {}
    for added in effects:
        for name in info.effect(added).parameters:
            row = info.parameter(name)
            if name in of.parameters and not (off and added == effect):
                continue
            typical = row.typical * (1.0 if row.purpose == "share" else of.scale(row.element or "", row.dimension))
            values[name] = 0.0 if off and added == effect and row.amplitude else of.parameters.get(name, typical)
    if not off and effect in of.acting:
        values.update(of.acting[effect].parameters)
    return System(kind=kind, parameters={**of.parameters, **values}, effects=tuple(effects))

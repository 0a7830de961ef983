"""A model with one effect more. A law that is the whole friction of its element replaces what friction is there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from tendonlab.simulation.catalog import WHOLE, EffectInfo
from tendonlab.simulation.system import System


def extended(system: System, effects: Mapping[str, Mapping[str, float]]) -> System:
    """The simulator with `effects` added; where one is a whole friction, all other effects of its element give way.

    Raises ParameterError as `System.with_effects` does."""
    for name in effects:
        effect = system.info.effect(name)
        if effect.roles & WHOLE and name not in system.effects:
            system = _without(system, effect.element)
    return system.with_effects(effects)


def can_replace(effect: EffectInfo, system: System, added: Sequence[str]) -> bool:
    """Whether a whole friction has another one to replace that the simulator had from the start."""
    there = [system.info.effect(name) for name in system.effects]
    own = [other for other in there if other.element == effect.element]
    return any(other.roles & WHOLE for other in own) and not any(other.name in added for other in own)


def _without(system: System, element: str) -> System:
    """The simulator without any effect of one element, nor the parameters that only these have."""
    info = system.info
    kept = tuple(name for name in system.effects if info.effect(name).element != element)
    on = {e.name for e in info.effects if e.structural} | set(kept)
    known = {name for effect in on for name in info.effect(effect).parameters}
    known |= {p.name for p in info.parameters if p.effect is None}
    parameters = {name: value for name, value in system.parameters.items() if name in known}
    return System(kind=system.kind, parameters=parameters, effects=kept, axis=system.axis, controller=system.controller)

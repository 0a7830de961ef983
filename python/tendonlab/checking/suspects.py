"""Channels that may share one wrong factor, and the factors that they may have."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tendonlab.checking.equation import Equation
from tendonlab.checking.logs import TIME, VELOCITIES

LARGEST, RATIO = 2.0**18, 8.0  # factors that are tried, and from one to the next
# Ratios of the units that a quantity is logged in.
UNITS = {
    "N": (9.81, 4.448, 1000.0),
    "N*m": (9.81, 100.0, 1000.0),
    "rad": (180.0 / np.pi, 2.0 * np.pi),
    "rad/s": (180.0 / np.pi, 30.0 / np.pi),
    "m": (1000.0,),
    "m/s": (1000.0,),
    "A": (1000.0,),
    "V": (1000.0,),
}


@dataclass(frozen=True)
class Suspect:
    """Channels that may share a factor; `values`: those that a search begins from, or, where `exact`, the only one."""

    signals: tuple[str, ...]
    values: tuple[float, ...]
    exact: bool = False


def suspects(equation: Equation, level: np.ndarray) -> Iterator[Suspect]:
    """Every suspect: of any size with each sign, and in each other unit; `level`: what each equation leaves, relative
    to what it predicts. Of the size of a velocity that moves nothing
    and only turns friction the logs say nothing. All tensions together may be in another unit, but not of any size: as
    friction adds to them what the equation does not know, any smaller factor suits a little better."""
    axes, sizes = tuple(equation.axes.values()), _sizes()
    for signals in [*_alone(equation), *([axes] if len(axes) > 1 else [])]:
        alone = only_turns(equation, signals)
        if not alone:
            yield Suspect(signals, sizes)
        yield Suspect(signals, (-1.0,) if alone else tuple(-v for v in sizes))
    yield Suspect((TIME,), sizes)
    yield from in_other_units(equation, level)


def in_other_units(equation: Equation, level: np.ndarray) -> Iterator[Suspect]:
    """Each channel, all axes, and all other outputs of one unit, by each ratio of units. The latter where none of their
    equations explains anything: where some balance, their unit is right."""
    known = equation.dataset.signals
    lost = {names for names, left in zip(equation.predicted, level, strict=True) if left > 1.0}
    axes = tuple(equation.axes.values())
    alike = [axes, *(tuple(name for name in equation.others if known[name].si_unit == unit) for unit in UNITS)]
    shared = [
        names for names in alike if len(names) > 1 and (names is axes or lost.issuperset((name,) for name in names))
    ]
    for signals in [*_alone(equation), *shared]:
        for ratio in () if only_turns(equation, signals) else UNITS.get(known[signals[0]].si_unit, ()):
            yield Suspect(signals, (ratio,), exact=True)
            yield Suspect(signals, (1.0 / ratio,), exact=True)


def turned(equation: Equation) -> Iterator[Suspect]:
    """Each channel with its sign turned, and all axes."""
    axes = tuple(equation.axes.values())
    for signals in [*_alone(equation), *([axes] if len(axes) > 1 else [])]:
        yield Suspect(signals, (-1.0,), exact=True)


def _alone(equation: Equation) -> list[tuple[str, ...]]:
    """Each channel that may have a factor. A limit is none: what it does not bound says nothing of its size."""
    info, known = equation.system.info, equation.dataset.signals
    inputs = [s.name for s in info.inputs if s.name in known and s.dimension != "ratio" and not s.limit]
    return [(name,) for name in (*inputs, *equation.measured)]


def only_turns(equation: Equation, signals: tuple[str, ...]) -> bool:
    """Whether channels are velocities that move nothing and only turn friction: at any other size they would shut or
    open a gate instead."""
    info = equation.system.info
    turning = {s.name for s in info.inputs if s.dimension in VELOCITIES and not info.dof}
    return not turning.isdisjoint(signals)


def _sizes() -> tuple[float, ...]:
    """Factors far apart, and a usual mistake."""
    num = int(np.log(LARGEST) / np.log(RATIO))
    return (*(RATIO ** np.arange(-num, num + 1.0)).tolist(), 2.0, 0.5)

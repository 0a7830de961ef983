"""What every case of a draw is to be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from . import unknown
from .systems import SYSTEMS

MIXED = "mixed"


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """A case to draw: its system, kind, the effect that its simulator lacks ("" for none, "unknown:bump" for a cause
    that the library lacks as well), whether it repeats an experiment, whether it lacks a second effect, and whether
    its logs have a mistake; ranges of the gap/noise of its effect and of the second one.
    """

    system: str
    kind: str
    effect: str
    has_repeats: bool
    is_pair: bool = False
    has_fault: bool = False
    strengths: tuple[float, float] = (1.0, 6.0)
    second: tuple[float, float] = (1.0, 6.0)


def plan(
    seed: int,
    count: int,
    *,
    system: str = "two_inertia",
    repeats: float = 1.0,
    unknown_share: float = 0.0,
    pairs: float = 0.0,
    faults: float = 0.0,
    strengths: tuple[float, float] = (1.0, 6.0),
    second: tuple[float, float] | None = None,
) -> list[Wanted]:
    """What every case is to be, shuffled; effects go round in turn, so that all appear once `count` allows it.

    `pairs`: share of the cases that lack an effect which lack a second one. `faults`: share of all cases whose logs
    have a mistake. The draws of repeats and mistakes change nothing else: the rigs of a seed are the same with and
    without. `second`: strengths of second effects, those of the first ones unless given. Raises ValueError if
    count < 1, if a share is none, if strengths are no range, and for another system.
    """
    if count < 1:
        raise ValueError(f"count = {count}: expected at least 1")
    shares = {"repeats": repeats, "unknown_share": unknown_share, "pairs": pairs, "faults": faults}
    for name, share in shares.items():
        if not 0.0 <= share <= 1.0:
            raise ValueError(f"{name} = {share}: expected a share from 0 to 1")
    second = strengths if second is None else second
    for name, (least, largest) in (("strengths", strengths), ("second", second)):
        if not 0.0 < least < largest < np.inf:
            raise ValueError(f"{name} = {least}, {largest}: expected two numbers, 0 < least < largest")
    if system not in (*SYSTEMS, MIXED):
        raise ValueError(f"system = {system!r}: expected one of {', '.join((*SYSTEMS, MIXED))}")
    repeated, faulty = _some(seed, 1, count=count, share=repeats), _some(seed, 4, count=count, share=faults)
    kinds = _mixed_kinds if system == MIXED else partial(_kinds, system=system)
    drawn = kinds(seed, count, unknown_share=unknown_share)
    singles = [i for i, (_, kind, _) in enumerate(drawn) if kind == "effect"]
    paired = {singles[k] for k in _some(seed, 3, count=len(singles), share=pairs)}
    return [
        Wanted(
            system=name,
            kind=kind,
            effect=effect,
            has_repeats=i in repeated,
            is_pair=i in paired,
            has_fault=i in faulty,
            strengths=strengths,
            second=second,
        )
        for i, (name, kind, effect) in enumerate(drawn)
    ]


def _some(seed: int, stream: int, *, count: int, share: float) -> set[int]:
    """Places of a share of the cases."""
    places = np.random.default_rng([seed, 0, stream]).permutation(count)
    return set(places[: round(share * count)].tolist())


def _mixed_kinds(seed: int, count: int, *, unknown_share: float) -> list[tuple[str, str, str]]:
    """As many cases of each system, within one, in random order."""
    names = list(SYSTEMS)
    order = [names[i % len(names)] for i in np.random.default_rng([seed, 0, 2]).permutation(count)]
    queues = {
        name: iter(_kinds(seed, order.count(name), system=name, unknown_share=unknown_share)) for name in set(order)
    }
    return [next(queues[name]) for name in order]


def _kinds(seed: int, count: int, *, system: str, unknown_share: float) -> list[tuple[str, str, str]]:
    """(system, kind, effect) of the cases of one system: of those without unknown cause 70 % lack an effect, 15 %
    nothing.
    """
    draw, num_unknown = np.random.default_rng([seed, 0]), round(unknown_share * count)
    known = count - num_unknown
    singles = min(known, max(1, round(0.7 * known)))
    none = round(0.15 * known)
    kinds = [("effect", effect) for effect in _in_turn(SYSTEMS[system].effects, singles, draw)] + [("none", "")] * none
    kinds += [("parameters_only", "")] * (known - len(kinds))
    kinds += [("unknown", cause) for cause in _in_turn(unknown.named(SYSTEMS[system].causes), num_unknown, draw)]
    return [(system, *kinds[i]) for i in draw.permutation(count)]


def _in_turn(names: Sequence[str], count: int, draw: np.random.Generator) -> list[str]:
    """`count` of the names, each round of them shuffled."""
    order: list[str] = []
    while len(order) < count:
        order += [names[i] for i in draw.permutation(len(names))]
    return order[:count]

"""What every case of a draw is to be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .systems import SYSTEMS

MIXED = "mixed"


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """A case to draw: its system, kind, the effect that it lacks ("" for none), whether it repeats an experiment."""

    system: str
    kind: str
    effect: str
    has_repeats: bool


def plan(seed: int, count: int, *, system: str = "two_inertia", repeats: float = 1.0) -> list[Wanted]:
    """What every case is to be, shuffled; effects go round in turn, so that all appear once `count` allows it.

    The draw of the repeats changes nothing else: the cases of a seed are the same with and without repeats. Raises
    ValueError if count < 1, if `repeats` is no share, and for another system.
    """
    if count < 1:
        raise ValueError(f"count = {count}: expected at least 1")
    if not 0.0 <= repeats <= 1.0:
        raise ValueError(f"repeats = {repeats}: expected a share from 0 to 1")
    if system not in (*SYSTEMS, MIXED):
        raise ValueError(f"system = {system!r}: expected one of {', '.join((*SYSTEMS, MIXED))}")
    repeated = _some(seed, 1, count=count, share=repeats)
    drawn = iter(_mixed_kinds(seed, count) if system == MIXED else _kinds(seed, count, system=system))
    return [
        Wanted(system=name, kind=kind, effect=effect, has_repeats=i in repeated)
        for i, (name, kind, effect) in enumerate(drawn)
    ]


def _some(seed: int, stream: int, *, count: int, share: float) -> set[int]:
    """Places of a share of the cases."""
    places = np.random.default_rng([seed, 0, stream]).permutation(count)
    return set(places[: round(share * count)].tolist())


def _mixed_kinds(seed: int, count: int) -> list[tuple[str, str, str]]:
    """Half of the cases of each system, in random order."""
    names = list(SYSTEMS)
    first = _some(seed, 2, count=count, share=0.5)
    queues = {
        name: iter(_kinds(seed, number, system=name) if number else [])
        for name, number in zip(names, (len(first), count - len(first)), strict=True)
    }
    return [next(queues[names[0] if i in first else names[1]]) for i in range(count)]


def _kinds(seed: int, count: int, *, system: str) -> list[tuple[str, str, str]]:
    """(system, kind, effect) of the cases of one system."""
    draw, effects = np.random.default_rng([seed, 0]), SYSTEMS[system].effects
    singles = max(1, round(0.7 * count))
    none = round(0.15 * count)
    order: list[str] = []
    while len(order) < singles:
        order += [effects[i] for i in draw.permutation(len(effects))]
    kinds = [("effect", effect) for effect in order[:singles]] + [("none", "")] * none
    kinds += [("parameters_only", "")] * (count - len(kinds))
    return [(system, *kinds[i]) for i in draw.permutation(count)]

"""Rigs whose simulator lacks two effects: each is as strong as wanted where it is alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from .rig import Rig
from .strength import Strength, tune


def paired(rig: Rig, draw: np.random.Generator, *, strengths: tuple[float, float]) -> Rig:
    """The rig with a second effect of another kind, no rival of the first; its amplitude waits for `tuned`."""
    kind, rivals = rig.effect.partition(":")[2], rig.system.rivals
    others = [
        name
        for name in rig.system.effects
        if name.partition(":")[2] != kind and name not in rivals.get(rig.effect, ()) and _can_be_seen(name, rig)
    ]
    target = float(np.exp(draw.uniform(*np.log(strengths))))
    return replace(rig, second=str(draw.choice(others)), second_target=target)


def _can_be_seen(effect: str, rig: Rig) -> bool:
    name, _, invisible_without = rig.system.optional
    return name in rig.outputs or effect not in invisible_without


def tuned(rigs: Mapping[int, Rig]) -> dict[int, tuple[Rig, list[Strength]]]:
    """Every rig with the strength of each effect, the second one's amplitude set."""
    pairs = {i: rig for i, rig in rigs.items() if rig.second}
    firsts = [replace(rig, second="") for rig in rigs.values()]
    seconds = [replace(rig, effect=rig.second, target=rig.second_target, second="") for rig in pairs.values()]
    found = tune([*firsts, *seconds])
    strengths = {i: [strength] for i, strength in zip(rigs, found[: len(rigs)], strict=True)}
    for i, strength in zip(pairs, found[len(rigs) :], strict=True):
        strengths[i].append(strength)
    set_ = {i: replace(rig, second_amplitude=strengths[i][1].amplitude) for i, rig in pairs.items()}
    return {i: (set_.get(i, rig), strengths[i]) for i, rig in rigs.items()}

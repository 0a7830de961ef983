"""From the search to a verdict and to probabilities: tempered evidence, not yet calibrated on blind cases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tendonlab.diagnosis.search.contest import MATTERS, Round
from tendonlab.diagnosis.search.halves import NEAR_FLOOR
from tendonlab.diagnosis.search.select import Search
from tendonlab.fitting.noise import Floor

NO_GAP = 1.15  # whitened mean square below which the nominal simulator is at the floor
FAR = 10.0  # mean square, in units of a floor that is only assumed, from which on it is no noise
EXPLAINED = 0.85  # share of the held-out excess that library effects must remove to be the whole answer
SOFT, SAME_GROUP = 0.05, 0.2


@dataclass(frozen=True)
class Verdict:
    """The verdict, the probabilities of all four, and those of effects and of sets of effects."""

    verdict: str
    probability: dict[str, float]
    effects: dict[str, float]
    sets: list[dict[str, Any]]
    indistinguishable: list[list[str]]


def decide(found: Search, *, nominal: float, refitted: float, explained: float | None, floor: Floor) -> Verdict:
    """`nominal`: mean square over the floor at the untouched simulator (whitened, or plain where nothing repeats);
    `refitted`: the plain one of the refitted simulator on held-out experiments, which decides where nothing repeats.
    `explained`: share of the held-out excess that the selected effects remove, None where there is none."""
    nothing_to_tune = floor.repeated and NEAR_FLOOR > found.null.mean_square > (1 - MATTERS) * nominal
    at_floor = nominal < NO_GAP or (nothing_to_tune and not found.selected)
    room = NEAR_FLOOR - found.null.mean_square if floor.repeated else min(SOFT, FAR - refitted)
    none = float(np.prod([one.probability[None] for one in found.rounds[: max(1, len(found.selected))]]))
    weight = {
        "no_gap": _step(SOFT if at_floor else NO_GAP - nominal) * (1.0 if not found.selected else none),
        "parameters_only": _step(nominal - NO_GAP) * none * _step(room),
        "effect": (1.0 - none) * (_step((explained or 0.0) - EXPLAINED) if found.selected else 0.1),
        "unknown_effect": (1.0 - none) * (_step(EXPLAINED - (explained or 0.0)) if found.selected else 0.5)
        + (0.0 if room > 0 else none),
    }
    if at_floor:
        verdict = "no_gap"
    elif not found.selected:
        verdict = "parameters_only" if room > 0 else "unknown_effect"
    else:
        verdict = "effect" if explained is not None and explained >= EXPLAINED else "unknown_effect"
    weight[verdict] = max(weight[verdict], 1.05 * max(weight.values()), 1e-9)
    total = sum(weight.values())
    effects, sets = _marginals(found.rounds)
    groups = [g for r in found.rounds if (g := _group(r))]
    return Verdict(verdict, {k: v / total for k, v in weight.items()}, effects, sets, groups)


def _step(x: float) -> float:
    return float(1.0 / (1.0 + np.exp(-np.clip(x / SOFT, -50, 50))))


def _marginals(rounds: Sequence[Round]) -> tuple[dict[str, float], list[dict[str, Any]]]:
    """Probabilities of effects, each beside the others, and of sets; of a further effect only as far as those that were
    selected are the cause."""
    chosen = [one.probability[one.accepted.effect] if one.accepted else 1.0 for one in rounds]
    effects: dict[str, float] = {}
    sets: list[dict[str, Any]] = []
    for k, one in enumerate(rounds):
        beside = float(np.prod(chosen[:k] + chosen[k + 1 :]))
        for name, p in one.probability.items():
            if name is not None:
                effects[name] = min(1.0, effects.get(name, 0.0) + (p if one.accepted else beside * p))
            together = [*one.base, *([name] if name is not None else [])]
            is_own = one.accepted is not None and name == one.accepted.effect
            if together and not (is_own and k + 1 < len(rounds)):  # all that were selected together count once
                sets.append({"effects": together, "probability": beside * p})
    sets.sort(key=lambda s: -float(s["probability"]))
    return effects, [s for s in sets if s["probability"] > 1e-4][:12]


def _group(one: Round) -> list[str]:
    """Effects that these data cannot tell from the accepted one, most probable first."""
    if one.accepted is None:
        return []
    top = one.probability[one.accepted.effect]
    members = [(p, n) for n, p in one.probability.items() if n is not None and p >= SAME_GROUP * top]
    return [n for _, n in sorted(members, reverse=True)] if len(members) > 1 else []

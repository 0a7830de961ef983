"""Which simulated rigs are diagnosed, in which order, and how many of them fit the time."""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

NOTHING = ""  # in place of an effect: none is withheld
NOTHING_SHARE = 6  # effects for each rig from which nothing is withheld
MARGIN = 0.95  # of the time that is planned for diagnoses


@dataclass(frozen=True)
class RehearsalCase:
    """One simulated rig: `effect` is withheld from the simulator, at the size that leaves `gap` noise floors after
    tuning and with the parameters `values`; it is number `repeat` of its kind. `effect` "": nothing is withheld."""

    effect: str
    gap: float
    repeat: int
    values: tuple[tuple[str, float], ...] = ()

    @property
    def key(self) -> str:
        """A name that no other case of a rehearsal has."""
        return f"{self.effect or 'nothing'} {self.gap:g} {self.repeat}"

    @property
    def effects(self) -> dict[str, dict[str, float]]:
        """As `System.with_effects` takes it."""
        return {self.effect: dict(self.values)} if self.effect else {}

    def random(self, seed: int) -> np.random.Generator:
        """Its own random numbers, whatever other cases there are."""
        return np.random.default_rng([seed, zlib.crc32(self.key.encode())])


def ordered_cases(
    known: Mapping[str, Mapping[float, Mapping[str, float]]], sizes: Sequence[float], repeats: int
) -> list[RehearsalCase]:
    """Every case, in an order of which any beginning is balanced: round by round, in each the middle sizes first, at
    each size all effects and a few rigs from which nothing is withheld. `known`: effect -> gap -> parameters."""
    per_size = max(1, round(len(known) / NOTHING_SHARE))
    middle = (len(sizes) - 1) / 2
    order = sorted(range(len(sizes)), key=lambda k: (abs(k - middle - 0.25), k))
    cases, nothing = [], 0
    for repeat in range(repeats):
        for k in order:
            for _ in range(per_size):
                cases.append(RehearsalCase(NOTHING, 0.0, nothing))
                nothing += 1
            for effect, by_gap in known.items():
                if sizes[k] in by_gap:
                    values = tuple(sorted(by_gap[sizes[k]].items()))
                    cases.append(RehearsalCase(effect, float(sizes[k]), repeat, values))
    return cases


def number_that_fits(durations: Sequence[float], seconds_left: float, jobs: int) -> int:
    """How many further cases end within `seconds_left`, judged by how long the first ones took, s, with `jobs` at a
    time."""
    mean = float(np.mean(durations))
    return max(0, int(MARGIN * seconds_left * jobs / mean)) if mean > 0 else len(durations)


def case_row(case: RehearsalCase, **found: Any) -> dict[str, Any]:
    """What is stored of a case: one line of JSON."""
    return {"case": case.key, "effect": case.effect, "gap": case.gap, "repeat": case.repeat, **found}

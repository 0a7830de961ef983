"""The map from evidence to probability, fitted on blind cases by `tendonlab blind calibrate` and shipped as data."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files

import numpy as np

from tendonlab.diagnosis.answer.verdict import Verdict

FILE = "calibration.json"
FORMAT = "tendonlab-calibration/1"
LEAST = 1e-6  # probability; evidence beyond it says no more


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """How evidence becomes probability, with or without repeats.

    Verdicts: p^(1/`temperature`), normalised, and a share `lapse` spread over all of them: what goes wrong however
    clear the evidence is. The most probable verdict stays. Effects, groups of effects and sets: log odds times
    `slope` plus `shift`, which keeps their order. `systems`: kinds of rigs on which other cases confirmed the map,
    with at least `least_runs` training experiments each."""

    temperature: float = 1.0
    lapse: float = 0.0
    slope: float = 1.0
    shift: float = 0.0
    systems: tuple[str, ...] = ()
    least_runs: int = 0

    def holds(self, system: str, *, runs: int) -> bool:
        """Whether the map was confirmed on rigs of this kind with as few training experiments."""
        return system in self.systems and runs >= self.least_runs

    def verdicts(self, raw: Mapping[str, float]) -> dict[str, float]:
        """Probabilities of the verdicts; what the check of the logs has excluded stays so."""
        able = {name: p for name, p in raw.items() if p > 0.0 or name != "data_fault"}
        sharp = {name: max(p, LEAST) ** (1.0 / self.temperature) for name, p in able.items()}
        total = sum(sharp.values())
        mixed = {name: (1.0 - self.lapse) * p / total + self.lapse / len(sharp) for name, p in sharp.items()}
        return {name: mixed.get(name, 0.0) for name in raw}

    def effect(self, raw: float) -> float:
        """Probability of an effect, or of a set."""
        p = min(max(raw, LEAST), 1.0 - LEAST)
        return float(1.0 / (1.0 + np.exp(-(self.slope * np.log(p / (1.0 - p)) + self.shift))))

    def applied(self, verdict: Verdict) -> Verdict:
        """The same answer with calibrated probabilities. Effects that the data cannot tell apart share that of their
        group, and sets share that of all of them."""
        effects = {name: self.effect(p) for name, p in verdict.effects.items()}
        for group in verdict.indistinguishable:
            effects |= self._shared({name: verdict.effects[name] for name in group})
        shares = self._shared({str(k): float(entry["probability"]) for k, entry in enumerate(verdict.sets)})
        sets = [{**entry, "probability": p} for entry, p in zip(verdict.sets, shares.values(), strict=True)]
        return replace(verdict, probability=self.verdicts(verdict.probability), effects=effects, sets=sets)

    def _shared(self, raw: Mapping[str, float]) -> dict[str, float]:
        total = sum(raw.values())
        factor = self.effect(min(total, 1.0)) / total if total > 0.0 else 1.0
        return {name: factor * p for name, p in raw.items()}


@cache
def shipped(*, repeats: bool) -> Calibration:
    """The map that comes with this version; evidence as it is where there is none."""
    path = files("tendonlab.diagnosis.answer") / FILE
    if not path.is_file():
        return Calibration()
    given = json.loads(path.read_text(encoding="utf-8"))["with repeats" if repeats else "without repeats"]
    return Calibration(**given["map"], systems=tuple(given["confirmed"]), least_runs=given["least runs"])

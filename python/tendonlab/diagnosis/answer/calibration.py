"""The map from evidence to probability, fitted on blind cases by `tendonlab blind calibrate` and shipped as data."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from tendonlab.diagnosis.answer.verdict import Verdict

FILE = "calibration.json"
FORMAT = "tendonlab-calibration/1"
LEAST = 1e-6  # probability; evidence beyond it says no more


@dataclass(frozen=True, kw_only=True)
class Tempering:
    """p^(1/`temperature`), normalised, less a share `lapse`: what goes wrong however clear the evidence is.
    `near_noise`: what goes wrong besides where tuning leaves no more than noise, in which one cause looks like another.
    `missed`: probability of an effect that the evidence excludes."""

    temperature: float = 1.0
    lapse: float = 0.0
    near_noise: float = 0.0
    missed: float = 0.0

    def at(self, left: float) -> Tempering:
        """The same where tuning leaves a mean square of `left`, in units of the noise."""
        lapse = self.lapse + self.near_noise / max(1.0, left) ** 2
        return replace(self, lapse=min(lapse, 1.0 - self.missed), near_noise=0.0)

    def of(self, raw: Mapping[str, float]) -> dict[str, float]:
        """Probabilities of what excludes each other; the lapse is spread over all of them, so their order stays."""
        sharp = {name: max(p, LEAST) ** (1.0 / self.temperature) for name, p in raw.items()}
        total = sum(sharp.values())
        return {name: (1.0 - self.lapse) * p / total + self.lapse / len(sharp) for name, p in sharp.items()}

    def of_one(self, raw: float) -> float:
        """Probability that something is there; the lapse says that it is not, `missed` that it is."""
        there, not_there = (max(p, LEAST) ** (1.0 / self.temperature) for p in (raw, 1.0 - raw))
        return float(self.missed + (1.0 - self.lapse - self.missed) * there / (there + not_there))


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """How evidence becomes probability, with or without repeats: that of the verdicts, and that of effects, of groups
    of effects and of all sets together. `systems`: kinds of rigs on which other cases confirmed the map, with at least
    `least_runs` training experiments each."""

    verdicts: Tempering = Tempering()
    effects: Tempering = Tempering()
    systems: tuple[str, ...] = ()
    least_runs: int = 0

    def holds(self, system: str, *, runs: int) -> bool:
        """Whether the map was confirmed on rigs of this kind with as few training experiments."""
        return system in self.systems and runs >= self.least_runs

    def at(self, left: float) -> Calibration:
        """The map where tuning leaves a mean square of `left`, in units of the noise."""
        return replace(self, verdicts=self.verdicts.at(left), effects=self.effects.at(left))

    def of_verdicts(self, raw: Mapping[str, float]) -> dict[str, float]:
        """Probabilities of the verdicts. Only the check of the logs tells whether these are at fault."""
        checked = {name: p for name, p in raw.items() if name == "data_fault"}
        return checked | self.verdicts.of({name: p for name, p in raw.items() if name not in checked})

    def applied(self, verdict: Verdict) -> Verdict:
        """The same answer with calibrated probabilities. Effects that the data cannot tell apart share that of their
        group. Sets share that of all of them, each as much less or more as its least likely effect became."""
        effects = {name: self.effects.of_one(p) for name, p in verdict.effects.items()}
        for group in verdict.indistinguishable:
            effects |= self._shared({name: verdict.effects[name] for name in group})
        raw = [float(entry["probability"]) for entry in verdict.sets]
        changed = {name: effects[name] / p if p > 0.0 else 1.0 for name, p in verdict.effects.items()}
        weight = [
            p * min(changed.get(name, 1.0) for name in entry["effects"])
            for p, entry in zip(raw, verdict.sets, strict=True)
        ]
        factor = self.effects.of_one(min(sum(raw), 1.0)) / sum(weight) if sum(weight) > 0.0 else 1.0
        sets = [{**entry, "probability": factor * w} for entry, w in zip(verdict.sets, weight, strict=True)]
        sets.sort(key=lambda entry: -float(entry["probability"]))
        return replace(verdict, probability=self.of_verdicts(verdict.probability), effects=effects, sets=sets)

    def _shared(self, raw: Mapping[str, float]) -> dict[str, float]:
        total = sum(raw.values())
        factor = self.effects.of_one(min(total, 1.0)) / total if total > 0.0 else 1.0
        return {name: factor * p for name, p in raw.items()}


def shipped_content() -> dict[str, Any]:
    """All that calibration.json of this version says."""
    return dict(json.loads((files("tendonlab.diagnosis.answer") / FILE).read_text(encoding="utf-8")))


def read_content(path: Path) -> dict[str, Any]:
    """All that another calibration.json says. Raises ValueError where the file is none."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"{path}: {error}; expected a {FILE}") from error
    found = content.get("format") if isinstance(content, dict) else None
    if found != FORMAT:
        raise ValueError(f"{path}: format = {found!r}: expected {FORMAT!r}")
    return dict(content)


def calibration_of(content: Mapping[str, Any], *, repeats: bool) -> Calibration:
    """The map that the content of a calibration.json holds."""
    given = content["with repeats" if repeats else "without repeats"]
    maps = {name: Tempering(**given["map"][name]) for name in ("verdicts", "effects")}
    return Calibration(**maps, systems=tuple(given["confirmed"]), least_runs=given["least runs"])


@cache
def shipped(*, repeats: bool) -> Calibration:
    """The map that comes with this version."""
    return calibration_of(shipped_content(), repeats=repeats)

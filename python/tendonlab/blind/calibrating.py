"""Fit the map from evidence to probability on scored cases, and test it on others."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit, logit

from tendonlab.diagnosis.answer.calibration import FORMAT, LEAST, Calibration
from tendonlab.version import version

from .reliability import Array, error_beyond_chance, reliability_line, too_far_off
from .runner import REPORT

LEAST_CASES = 20  # of a kind of rig, to confirm the map there
FALSE = 1.96  # Spiegelhalter's z beyond which probabilities are false
Folders = Sequence[tuple[Path, Path]]  # truths and reports


@dataclass(frozen=True)
class Judged:
    """A diagnosed case: the true verdict, effects that count as right, the evidence of the report, the verdict that was
    told, and the number of training runs."""

    system: str
    repeats: bool
    verdict: str
    right: frozenset[str]
    verdicts: dict[str, float]
    effects: dict[str, float]
    told: str
    runs: int

    def events(self) -> list[tuple[float, bool]]:
        """Evidence of the right effects, together, and of each other one, and whether they are there."""
        others = [(p, False) for name, p in self.effects.items() if name not in self.right]
        mine = [p for name, p in self.effects.items() if name in self.right]
        return [*others, (min(1.0, sum(mine)), True)] if mine else others


def judged(folders: Folders) -> list[Judged]:
    """All cases that have a report with evidence; those that were refused as a fault of the data have none. Raises
    ValueError where a truth has no report, or a report comes from a version that did not write evidence."""
    return [case for sealed, reports in folders for case in _judged(Path(sealed), Path(reports))]


def _judged(sealed: Path, reports: Path) -> Iterable[Judged]:
    for path in sorted(sealed.glob("*.toml")):
        truth, report = tomllib.loads(path.read_text(encoding="utf-8")), reports / path.stem / REPORT
        if not report.exists():
            raise ValueError(f"{report} is missing: expected a report of every case below {sealed}")
        found: dict[str, Any] = json.loads(report.read_text(encoding="utf-8"))
        if found["verdict"] == "data_fault":
            continue
        if "evidence" not in found["details"]:
            raise ValueError(f"{report}: details.evidence is missing: expected a report of this version")
        evidence = found["details"]["evidence"]
        yield Judged(
            system=truth["draw"]["system"],
            repeats=bool(truth["draw"]["repeats"]),
            verdict=truth["verdict"],
            right=frozenset([*truth["effects"], *truth["accept"]]),
            verdicts=evidence["verdict"],
            effects=evidence["effects"],
            told=found["verdict"],
            runs=len(found["split"]["train"]),
        )


def fitted(cases: Sequence[Judged]) -> Calibration:
    """The map of most likelihood, held near no change by weak priors: a few cases change little."""

    def verdict_cost(x: Array) -> float:
        of = Calibration(temperature=float(np.exp(x[0])), lapse=float(0.5 * expit(x[1])))
        surprise = -sum(np.log(max(of.verdicts(case.verdicts).get(case.verdict, 0.0), LEAST)) for case in cases)
        return float(surprise + 0.5 * x[0] ** 2 + 0.125 * (x[1] + 3.0) ** 2)

    events = [event for case in cases for event in case.events()]
    stated = logit(np.clip([p for p, _ in events], LEAST, 1.0 - LEAST))
    there = np.array([hit for _, hit in events])

    def effect_cost(x: Array) -> float:
        odds = np.exp(x[0]) * stated + x[1]
        surprise = np.sum(np.logaddexp(0.0, np.where(there, -odds, odds)))
        return float(surprise + 0.5 * (x[0] ** 2 + x[1] ** 2))

    temperature, lapse = minimize(verdict_cost, np.array([0.0, -3.0]), method="Nelder-Mead").x
    slope, shift = minimize(effect_cost, np.zeros(2), method="Nelder-Mead").x
    return Calibration(
        temperature=_rounded(np.exp(temperature)),
        lapse=_rounded(0.5 * expit(lapse)),
        slope=_rounded(np.exp(slope)),
        shift=_rounded(shift),
    )


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")


def stated(cases: Sequence[Judged], of: Calibration) -> tuple[Array, Array]:
    """Under a map: the probability of every verdict that was told, and whether the verdict is right."""
    probability = np.array([of.verdicts(case.verdicts)[case.told] for case in cases])
    return probability, np.array([float(case.told == case.verdict) for case in cases])


def results_on(cases: Sequence[Judged], of: Calibration) -> dict[str, float]:
    """How true the probabilities of the verdicts are on these cases."""
    probability, came_true = stated(cases, of)
    slope, _ = reliability_line(probability, came_true)
    return {
        "cases": len(cases),
        "verdict right": float(came_true.mean()),
        "mean probability": float(probability.mean()),
        "calibration error beyond chance": error_beyond_chance(probability, came_true),
        "reliability slope": slope,
        "z": too_far_off(probability, came_true),
    }


def calibrate(on: Folders, test: Folders = ()) -> dict[str, Any]:
    """The content of calibration.json: with and without repeats the map, from how many cases of which rigs, what test
    cases say of the map, and the kinds of rigs on which these confirm the map. Raises ValueError as `judged` does."""
    cases, tests = judged(on), judged(test)
    content: dict[str, Any] = {"format": FORMAT, "tendonlab": version()}
    for name, repeats in (("with repeats", True), ("without repeats", False)):
        mine, others = ([case for case in given if case.repeats == repeats] for given in (cases, tests))
        content[name] = _one_map(mine, others)
    return content


def _one_map(cases: Sequence[Judged], tests: Sequence[Judged]) -> dict[str, Any]:
    found = fitted(cases) if cases else Calibration()
    results = {kind: results_on(of, found) for kind, of in _by_system(tests).items()}
    return {
        "map": {name: value for name, value in asdict(found).items() if name not in ("systems", "least_runs")},
        "fitted on": {kind: len(of) for kind, of in _by_system(cases).items()},
        "tested on": {kind: {name: _rounded(x) for name, x in result.items()} for kind, result in results.items()},
        "least runs": min((case.runs for case in tests), default=0),
        "confirmed": [kind for kind, of in results.items() if of["cases"] >= LEAST_CASES and abs(of["z"]) < FALSE],
    }


def _by_system(cases: Sequence[Judged]) -> dict[str, list[Judged]]:
    return {kind: [case for case in cases if case.system == kind] for kind in sorted({case.system for case in cases})}

"""Fit the map from evidence to probability on scored cases, or keep the shipped one, and test it on others."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit

from tendonlab.diagnosis.answer.calibration import (
    FORMAT,
    LEAST,
    Calibration,
    Tempering,
    shipped,
    shipped_content,
)
from tendonlab.version import version

from .reliability import Array, error_beyond_chance, reliability_line, spread_of_error, too_far_off
from .runner import REPORT, VERDICTS

LEAST_CASES = 20  # of a kind of rig, to confirm the map there
FALSE = 1.96  # Spiegelhalter's z beyond which probabilities are false
USUAL, SPREAD = -2.94, 1.4  # log odds of twice the lapse that is believed before any case, 2.5 %, and their sd
USUAL_NEAR_NOISE = -1.4  # log odds of what goes wrong besides near the noise, 20 %
SELDOM = -5.3  # log odds of twice the share of effects that are missed, 0.25 %
Folders = Sequence[tuple[Path, Path]]  # truths and reports


@dataclass(frozen=True)
class Judged:
    """A diagnosed case: the true verdict, effects that count as right, the evidence of the report, the verdict that it
    states, the mean square that tuning leaves, in units of the noise, and the number of training runs."""

    system: str
    repeats: bool
    verdict: str
    right: frozenset[str]
    verdicts: dict[str, float]
    effects: dict[str, float]
    told: str
    left: float
    runs: int

    def events(self) -> list[tuple[float, bool]]:
        """Evidence of the right effects, together, and of each other one, and whether they are there."""
        others = [(p, False) for name, p in self.effects.items() if name not in self.right]
        mine = [p for name, p in self.effects.items() if name in self.right]
        return [*others, (min(1.0, sum(mine)), True)] if mine else others


def judged(folders: Folders) -> list[Judged]:
    """All cases that have a report with evidence; those that were refused as a fault of the data have none, nor have
    those whose diagnosis failed. Raises ValueError where a truth has no report, or a report comes from a version that
    did not write evidence."""
    return [case for sealed, reports in folders for case in _judged(Path(sealed), Path(reports))]


def _judged(sealed: Path, reports: Path) -> Iterable[Judged]:
    told = _told(reports)
    for path in sorted(sealed.glob("*.toml")):
        truth, report = tomllib.loads(path.read_text(encoding="utf-8")), reports / path.stem / REPORT
        if told.get(path.stem) == "failed":
            continue
        if not report.exists():
            raise ValueError(f"{report} is missing: expected a report of every case below {sealed}")
        found: dict[str, Any] = json.loads(report.read_text(encoding="utf-8"))
        if "data_fault" in (found["verdict"], truth["verdict"]):
            continue
        for name in ("evidence", "mean_square"):
            if name not in found["details"]:
                raise ValueError(f"{report}: details.{name} is missing: expected a report of this version")
        evidence = found["details"]["evidence"]
        yield Judged(
            system=truth["draw"]["system"],
            repeats=bool(truth["draw"]["repeats"]),
            verdict=truth["verdict"],
            right=frozenset([*truth["effects"], *truth["accept"]]),
            verdicts=evidence["verdict"],
            effects=evidence["effects"],
            told=found["verdict"],
            left=float(found["details"]["mean_square"]["refitted"]),
            runs=len(found["split"]["train"]),
        )


def _told(reports: Path) -> dict[str, str]:
    """The verdict of every case that was run, or "failed"."""
    path = reports / VERDICTS
    if not path.exists():
        return {}
    return {name: of["verdict"] for name, of in json.loads(path.read_text(encoding="utf-8"))["reports"].items()}


def fitted(cases: Sequence[Judged]) -> Calibration:
    """The map of most likelihood, held near no change by weak priors: a few cases change little."""

    events = [(case.left, case.events()) for case in cases]

    def of_verdicts(by: Tempering) -> float:
        told = (Calibration(verdicts=by.at(case.left)).of_verdicts(case.verdicts)[case.verdict] for case in cases)
        return -sum(math.log(max(p, LEAST)) for p in told)

    def of_effects(by: Tempering) -> float:
        told = (pair for left, of in events for pair in _tempered(of, by.at(left)))
        return -sum(math.log(max(p if there else 1.0 - p, LEAST)) for p, there in told)

    return Calibration(verdicts=_best(of_verdicts, misses=False), effects=_best(of_effects, misses=True))


def _tempered(events: Iterable[tuple[float, bool]], by: Tempering) -> list[tuple[float, bool]]:
    return [(by.of_one(p), there) for p, there in events]


def _best(surprise: Callable[[Tempering], float], *, misses: bool) -> Tempering:
    """The tempering of least surprise; priors: temperature 1 within a factor of e; within factors of 4 a lapse of
    2.5 %, 20 % near the noise and, if it `misses` effects, 0.25 % of these."""
    usual = np.array([0.0, USUAL, USUAL_NEAR_NOISE, SELDOM][: 4 if misses else 3])
    spread = np.array([1.0, SPREAD, SPREAD, SPREAD][: len(usual)])

    def tempering(x: Array) -> Tempering:
        lapse, near_noise, missed = (float(expit(of)) for of in (*x[1:], -np.inf)[:3])
        return Tempering(temperature=float(np.exp(x[0])), lapse=lapse / 2, near_noise=near_noise, missed=missed / 2)

    def cost(x: Array) -> float:
        return surprise(tempering(x)) + 0.5 * float(np.sum(np.square((x - usual) / spread)))

    steps = np.diag([0.5, *(1.0 for _ in usual[1:])])
    simplex = usual + np.vstack([np.zeros(len(usual)), steps])
    best = tempering(minimize(cost, usual, method="Nelder-Mead", options={"initial_simplex": simplex}).x)
    return Tempering(**{name: _rounded(value) for name, value in asdict(best).items()})


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")


def _truth_of(stated: Iterable[tuple[float, bool]]) -> dict[str, float]:
    """How true these probabilities are: how many came out, and how far off they are."""
    probability, came_true = (np.array(column, dtype=float) for column in zip(*stated, strict=True))
    slope, _ = reliability_line(probability, came_true)
    found = {
        "number": float(probability.size),
        "came true": float(came_true.mean()),
        "mean probability": float(probability.mean()),
        "calibration error beyond chance": error_beyond_chance(probability, came_true),
        "reliability slope": slope,
        "z": too_far_off(probability, came_true),
    }
    return {name: _rounded(value) for name, value in found.items()}


def results_on(cases: Sequence[Judged], of: Calibration) -> dict[str, dict[str, float]]:
    """How true the probabilities of the reported verdicts, and of all effects, are on these cases."""
    return {"verdicts": _truth_of(stated_verdicts(cases, of)), "effects": _truth_of(stated_effects(cases, of))}


def stated_verdicts(cases: Sequence[Judged], of: Calibration) -> list[tuple[float, bool]]:
    """The probability of each reported verdict, and whether that is the true one."""
    return [(of.at(case.left).of_verdicts(case.verdicts)[case.told], case.told == case.verdict) for case in cases]


def stated_effects(cases: Sequence[Judged], of: Calibration) -> list[tuple[float, bool]]:
    """The probability of each effect of each case, and whether the effect is there."""
    return [pair for case in cases for pair in _tempered(case.events(), of.at(case.left).effects)]


def spreads_on(cases: Sequence[Judged], of: Calibration) -> dict[str, float]:
    """Standard deviations of the calibration errors of `results_on`, by bootstrap of the cases."""
    verdicts = [[stated] for stated in stated_verdicts(cases, of)]
    effects = [stated_effects([case], of) for case in cases]
    return {"verdicts": spread_of_error(verdicts), "effects": spread_of_error(effects)}


def calibrate(on: Folders = (), test: Folders = ()) -> dict[str, Any]:
    """The content of calibration.json: the series of cases by the names of their sealed folders; with and without
    repeats the map, from how many cases of which rigs, what test cases say of the map, and the kinds of rigs on which
    these confirm the map. Where no case is given to fit `on`, the shipped map stays and is tested. Raises ValueError as
    `judged` does, where cases were drawn to test and are to be fitted, or the other way round, and where no case that
    is given to fit has evidence."""
    origins = [*_origins(on, but="test"), *_origins(test, but="calibration")]
    cases, tests = judged(on), judged(test)
    if on and not cases:
        raise ValueError(f"{', '.join(str(reports) for _, reports in on)}: expected reports with evidence, found none")
    series = _names(on) or shipped_content()["series"]["fitted on"]
    content: dict[str, Any] = {"format": FORMAT, "tendonlab": version()}
    content["series"] = {"fitted on": series, "tested on": _names(test)}
    if origins:
        content["series"]["protocols"] = sorted({f"{origin['version']} {origin['sha256']}" for origin in origins})
        content["series"]["changed"] = sorted({name for origin in origins for name in origin["changed"]})
    for name, repeats in (("with repeats", True), ("without repeats", False)):
        mine, others = ([case for case in given if case.repeats == repeats] for given in (cases, tests))
        numbers = {kind: len(of) for kind, of in by_system(mine).items()} or shipped_content()[name]["fitted on"]
        content[name] = _one_map(fitted(mine) if mine else shipped(repeats=repeats), numbers, others)
    return content


def _origins(folders: Folders, *, but: str) -> list[dict[str, Any]]:
    """By which protocol the cases were drawn. Raises ValueError where they were drawn for the purpose `but`."""
    paths = [path for sealed, _ in folders for path in sorted(Path(sealed).glob("*.toml"))]
    origins = [(path, tomllib.loads(path.read_text(encoding="utf-8")).get("protocol")) for path in paths]
    for path, origin in origins:
        if origin and origin["purpose"] == but:
            raise ValueError(f"{path}: this case was drawn for {but}; expected a series that serves another purpose")
    return [origin for _, origin in origins if origin]


def write_map(content: Mapping[str, Any], path: Path) -> None:
    """Write the content of a calibration.json."""
    path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def _names(folders: Folders) -> list[str]:
    return [Path(sealed).absolute().name for sealed, _ in folders]


def _one_map(found: Calibration, numbers: Mapping[str, int], tests: Sequence[Judged]) -> dict[str, Any]:
    results = {kind: results_on(of, found) for kind, of in by_system(tests).items()}
    return {
        "map": {"verdicts": asdict(found.verdicts), "effects": asdict(found.effects)},
        "fitted on": dict(numbers),
        "tested on": results,
        "least runs": min((case.runs for case in tests), default=0),
        "confirmed": [kind for kind, of in results.items() if _confirms(of)],
    }


def _confirms(results: Mapping[str, Mapping[str, float]]) -> bool:
    return results["verdicts"]["number"] >= LEAST_CASES and all(abs(of["z"]) < FALSE for of in results.values())


def by_system(cases: Sequence[Judged]) -> dict[str, list[Judged]]:
    return {kind: [case for case in cases if case.system == kind] for kind in sorted({case.system for case in cases})}

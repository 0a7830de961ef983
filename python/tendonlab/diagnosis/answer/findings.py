"""The candidates as the report lists them: probability, parameters with intervals, what they do to held-out data."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from tendonlab.diagnosis.answer import heldout
from tendonlab.diagnosis.answer.heldout import Replayed
from tendonlab.diagnosis.answer.judged import Judged
from tendonlab.diagnosis.search.delays import value_and_interval
from tendonlab.diagnosis.search.select import Search
from tendonlab.diagnosis.search.trial import Trial
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.report.diagnosis import EffectFinding


def findings(
    search: Search, probability: Mapping[str, float], weighed: Judged, shown: Judged, seed: int
) -> tuple[EffectFinding, ...]:
    """Every candidate considered, most probable first, of equally probable ones those that were selected; those that
    were refitted with their numbers: what they gain where models were `weighed`, and how far they shrink the gap that
    is `shown`."""
    screened = {s.effect: s for contest in reversed(search.rounds) for s in contest.screened}
    trials = _telling_trials(search)
    rows = []
    for name in {**screened, **trials}:
        element, _, effect = name.rpartition(":")
        extra: dict[str, Any] = {}
        if name in screened:
            extra = {"screened_gain": screened[name].gain, "visibility": screened[name].visibility}
        about: dict[str, Any] = {}
        if name in trials:
            about = _numbers(search, trials[name], weighed, shown, seed)
            extra |= _evidence(trials[name], search)
        rows.append(
            EffectFinding(effect=effect, element=element, probability=probability.get(name, 0.0), extra=extra, **about)
        )
    return tuple(sorted(rows, key=lambda r: (-round(r.probability, 6), r.name not in search.selected, -_worth(r))))


def _telling_trials(search: Search) -> dict[str, Trial]:
    """Of each effect the trial in the round that accepted it, else in the first of those where it is most probable."""
    chosen: dict[str, tuple[float, Trial]] = {}
    for contest in search.rounds:
        for trial in contest.trials:
            accepted = trial is contest.accepted
            share = math.inf if accepted else contest.probability.get(trial.effect, 0.0)
            if trial.effect not in chosen or accepted or share > chosen[trial.effect][0]:
                chosen[trial.effect] = share, trial
    return {name: trial for name, (_, trial) in chosen.items()}


def _numbers(search: Search, trial: Trial, weighed: Judged, shown: Judged, seed: int) -> dict[str, Any]:
    fitter = search.fitter
    told = search.final if trial.effect in search.selected else trial.fitted  # the last fit knows all that is there
    about: dict[str, Any] = {"parameters": _parameters(fitter.case, told, trial.effect)}
    try:
        replayed = _replayed(weighed, trial, search)
    except NumericalError:  # a candidate that the training experiments already speak against
        return about
    of, refitted = weighed.case, weighed.stages["refitted"]
    gain = heldout.predictive_gain(of, fitter.whitening, fitter.floor, refitted, replayed, weighed.experiments)
    about["held_out_gain"] = gain
    try:
        seen = replayed if shown.case is weighed.case else _replayed(shown, trial, search)
    except NumericalError:  # it runs in the injection only
        return about
    before, rng = shown.stages["refitted"], np.random.default_rng(seed)
    shrinkage = heldout.shrinkage(shown.case, before, seen, shown.floor, shown.experiments, rng)
    return about | {"shrinkage": shrinkage}


def _replayed(of: Judged, trial: Trial, search: Search) -> Replayed:
    """The model of a trial; where that is the whole answer, as the answer fitted it last."""
    if trial.effect in search.selected and set(_kept(trial, search)) == set(search.selected):
        return of.stages["with_effect"]
    return heldout.replay(of.case, heldout.models(of.case, trial.fitted, of.experiments), of.experiments)


def _kept(trial: Trial, search: Search) -> list[str]:
    """The effects of a trial, without those that held-out experiments refuted since."""
    return [name for name in trial.fitted.added if name == trial.effect or name not in search.refuted]


def _parameters(case: Case, fitted: Fitted, effect: str) -> dict[str, dict[str, Any]]:
    info = fitted.system.info
    free = {f.name for f in fitted.free}
    rows = {}
    for name in info.effect(effect).parameters:
        if name in free:
            value, interval = value_and_interval(case, fitted, name)
            rows[info.parameter(name).own] = {
                "value": value,
                "ci95": list(interval),
                "unit": fitted.system.unit(name),
            }
    return rows


def _evidence(trial: Trial, search: Search) -> dict[str, Any]:
    return {
        "evidence_gain": trial.evidence_gain,
        "left_out_gain": trial.left_out_gain,
        "beside": [name for name in _kept(trial, search) if name != trial.effect],
    }


def _worth(row: EffectFinding) -> float:
    return float(row.extra.get("evidence_gain", row.extra.get("screened_gain", 0.0)))

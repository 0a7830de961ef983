"""Puts the answers together: gaps and shrinkage on held-out experiments, findings, maps, warnings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from tendonlab.catalog import unit
from tendonlab.diagnose import heldout, where
from tendonlab.diagnose.advise import advise
from tendonlab.diagnose.case import Case
from tendonlab.diagnose.fits import Fitted, Fitter
from tendonlab.diagnose.floor import RUN_TO_RUN_UNKNOWN, Floor
from tendonlab.diagnose.heldout import Replayed
from tendonlab.diagnose.result import Diagnosis, EffectFinding, Overlay
from tendonlab.diagnose.screen import INVISIBLE
from tendonlab.diagnose.search import Search, Trial
from tendonlab.diagnose.verdict import Verdict, decide


def compose(fitter: Fitter, nominal: Fitted, found: Search, *, seed: int, seconds: Callable[[], float]) -> Diagnosis:
    """The Diagnosis of a finished search."""
    case, floor = fitter.case, fitter.floor
    judged = case.test or case.train
    stages = {
        "nominal": heldout.replay(case, case.system, judged),
        "refitted": heldout.replay(case, found.null.system, judged),
    }
    stages["with_effect"] = heldout.replay(case, found.best.system, judged) if found.selected else stages["refitted"]
    explained = _explained(stages, floor) if found.selected else None
    level = nominal.mean_square if floor.repeated else _plain_level(stages["nominal"], floor)
    verdict = decide(found, nominal=level, explained=explained, floor=floor)
    records = where.PortRecords(case, stages["with_effect"], judged)
    rng = np.random.default_rng(seed)
    return Diagnosis(
        dataset=case.dataset.name,
        system=case.system.kind,
        seed=seed,
        verdict=verdict.verdict,
        verdict_probability=verdict.probability,
        replay=case.replay.to_dict(),
        gap=_gap(case, stages, floor),
        where={
            "signals": where.signals(case, stages["refitted"], floor),
            "elements": where.elements(verdict.effects, case),
            "regimes": where.regimes(case, stages["refitted"], floor, records),
        },
        effects=_findings(fitter, floor, found, verdict, stages["refitted"], judged, seed),
        sets=tuple(verdict.sets),
        selected=found.selected,
        explained=explained,
        indistinguishable=verdict.indistinguishable,
        invisible=_invisible(found),
        shrinkage={
            "from_nominal": heldout.shrinkage(case, stages["nominal"], stages["with_effect"], floor, judged, rng),
            "from_refitted": heldout.shrinkage(case, stages["refitted"], stages["with_effect"], floor, judged, rng),
        },
        next_experiments=_next(case, found),
        warnings=_warnings(case, floor, found, nominal),
        units=_units(case),
        overlay=_overlay(case, stages, floor, judged),
        where_map=where.maps(case, stages["refitted"], stages["with_effect"], floor, records),
        held_out=_per_experiment(case, stages, floor, judged),
        split={"train": [case.experiments[i].name for i in case.train], "test": [case.experiments[i].name for i in case.test]},
        details=_details(case, floor, nominal, found),
        seconds=seconds(),
    )


def _gap(case: Case, stages: dict[str, Replayed], floor: Floor) -> dict[str, dict[str, float]]:
    errors = {stage: heldout.rms(of) for stage, of in stages.items()}
    return {
        case.outputs[c]: {"noise_floor": float(floor.rms[c]), **{stage: float(e[c]) for stage, e in errors.items()}}
        for c in case.measured
    }


def _plain_level(of: Replayed, floor: Floor) -> float:
    error = heldout.rms(of)
    there = np.isfinite(floor.rms)
    return float(np.mean(np.square(error[there] / floor.rms[there])))


def _explained(stages: dict[str, Replayed], floor: Floor) -> float | None:
    """Share of the refitted simulator's held-out excess mean square that the effects remove."""
    before = _plain_level(stages["refitted"], floor) - 1.0
    after = _plain_level(stages["with_effect"], floor) - 1.0
    return None if before <= 0 else float(np.clip(1.0 - max(0.0, after) / before, 0.0, 1.0))


def _findings(
    fitter: Fitter, floor: Floor, found: Search, verdict: Verdict, refitted: Replayed, judged: Sequence[int], seed: int
) -> tuple[EffectFinding, ...]:
    """Every candidate considered, most probable first; those that were refitted with their numbers."""
    best: dict[str, Trial] = {}
    for one in found.rounds:
        for trial in one.trials:
            if trial.effect not in best or (one.accepted is not None and trial is one.accepted):
                best[trial.effect] = trial
    rows = []
    for one in found.rounds[:1]:
        for lead in one.leads:
            element, _, effect = lead.effect.rpartition(":")
            p = verdict.effects.get(lead.effect, 0.0)
            extra: dict[str, Any] = {"screened_gain": lead.gain, "visibility": lead.visibility}
            trial = best.get(lead.effect)
            if trial is None:
                rows.append(EffectFinding(effect=effect, element=element, probability=p, extra=extra))
                continue
            replayed = heldout.replay(fitter.case, trial.fitted.system, judged)
            rng = np.random.default_rng(seed)
            extra |= {"evidence_gain": trial.evidence_gain, "left_out_gain": trial.left_out_gain, "beside": list(trial.fitted.added[:-1])}
            rows.append(
                EffectFinding(
                    effect=effect, element=element, probability=p, parameters=_parameters(fitter.case, trial),
                    held_out_gain=heldout.predictive_gain(fitter.case, fitter.whitening, floor, refitted, replayed, judged),
                    shrinkage=heldout.shrinkage(fitter.case, refitted, replayed, floor, judged, rng), extra=extra,
                )  # fmt: skip
            )
    known = {r.name for r in rows}
    for name, trial in best.items():  # effects that only a later round considered
        if name not in known:
            element, _, effect = name.rpartition(":")
            rows.append(EffectFinding(effect=effect, element=element, probability=verdict.effects.get(name, 0.0), parameters=_parameters(fitter.case, trial)))
    return tuple(sorted(rows, key=lambda r: (-r.probability, -float(r.extra.get("evidence_gain", r.extra.get("screened_gain", 0.0))))))


def _parameters(case: Case, trial: Trial) -> dict[str, dict[str, Any]]:
    free = {f.name for f in trial.fitted.free}
    rows = {}
    for name in case.system.info.effect(trial.effect).parameters:
        if name in free:
            value, interval = trial.fitted.value(name)
            own = case.system.info.parameter(name).own
            rows[own] = {"value": value, "ci95": list(interval), "unit": trial.fitted.system.unit(name)}
    return rows


def _invisible(found: Search) -> list[str]:
    return [lead.effect for lead in found.rounds[0].leads if lead.visibility < INVISIBLE] if found.rounds else []


def _next(case: Case, found: Search) -> list[dict[str, Any]]:
    """Between the two leading explanations of the first round, with what was found beside them left out."""
    if not found.rounds or not found.rounds[0].trials or found.rounds[0].accepted is None:
        return []
    trials = found.rounds[0].trials
    return advise(case, trials[0].fitted, trials[1].fitted if len(trials) > 1 else found.null)


def _overlay(case: Case, stages: dict[str, Replayed], floor: Floor, judged: Sequence[int]) -> Overlay:
    """The held-out experiment on which the refitted simulator is worst."""
    squares = [np.nanmean(np.square(r[case.measured] / floor.rms[case.measured, None])) for r in stages["refitted"].residuals]
    k = int(np.argmax(squares))
    ready = case.prepared[judged[k]]

    def by_signal(rows: np.ndarray) -> dict[str, np.ndarray]:
        return {case.outputs[c]: rows[c] for c in case.measured}

    return Overlay(
        name=ready.name,
        time=np.asarray(case.experiments[judged[k]].time),
        measured=by_signal(ready.measured),
        nominal=by_signal(stages["nominal"].outputs[k]),
        refitted=by_signal(stages["refitted"].outputs[k]),
        with_effect=by_signal(stages["with_effect"].outputs[k]),
        floor={case.outputs[c]: float(floor.rms[c]) for c in case.measured},
    )


def _per_experiment(case: Case, stages: dict[str, Replayed], floor: Floor, judged: Sequence[int]) -> pd.DataFrame:
    squares = {stage: [heldout.row_mean_squares(r) for r in of.residuals] for stage, of in stages.items()}
    rows = {stage: [heldout.gap(s, floor.rms) for s in values] for stage, values in squares.items()}
    return pd.DataFrame(rows, index=pd.Index([case.experiments[i].name for i in judged], name="experiment"))


def _warnings(case: Case, floor: Floor, found: Search, nominal: Fitted) -> list[str]:
    said = list(case.dataset.warnings)
    if not floor.repeated:
        said.append(
            "no repeats: the floor is estimated from the sensors' noise and an assumed run-to-run variation of friction of "
            f"{RUN_TO_RUN_UNKNOWN:.0%}, and the colour of the noise from the refitted simulator's own residuals, which "
            "overstates it: what is found is established conservatively, what is not found may still be there"
        )
    if not case.test:
        said.append("no experiment is held out: gaps and shrinkage are those of the experiments that were fitted")
    if len(case.train) < 4:
        said.append(f"{len(case.train)} training experiment(s): contiguous blocks of at least 2 s stand for experiments where one is left out")
    bound = [f.name for f, at in zip(found.best.free, found.best.at_bound, strict=True) if at]
    if bound:
        said.append(f"at a bound or the edge of its range: {', '.join(bound)}")
    if floor.repeated and floor.tau > 0.03:
        said.append(f"friction differs by {floor.tau:.1%} from run to run: repeatability limits what can be said")
    said += [f"the fit of {', '.join(m.added) or 'the refitted simulator'} stopped early: {m.message}" for m in (found.null, found.best) if not m.converged]
    return said


def _units(case: Case) -> dict[str, str]:
    info, axis = case.system.info, case.system.axis
    found = {s.name: unit(s.dimension, axis) for s in info.outputs}
    for port in info.ports:
        found |= {f"{port}_{quantity}": unit(d, axis) for quantity, d in where.COORDINATES.items()}
    return found | {"time": "s"}


def _details(case: Case, floor: Floor, nominal: Fitted, found: Search) -> dict[str, Any]:
    return {
        "run_to_run_friction": floor.tau,
        "noise": {case.outputs[c]: float(case.noise[c]) for c in case.measured},
        "mean_square": {"nominal": nominal.mean_square, "refitted": found.null.mean_square, "with_effect": found.best.mean_square},
        "parameters": {f.name: {"value": found.best.value(f.name)[0], "ci95": list(found.best.value(f.name)[1]), "nominal": case.system.parameters.get(f.name)} for f in found.best.free},
    }  # fmt: skip

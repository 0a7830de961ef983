"""The answers put together: gaps and shrinkage on held-out experiments, findings, maps, warnings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from tendonlab.diagnosis import confusions
from tendonlab.diagnosis.answer import heldout, notes, where
from tendonlab.diagnosis.answer.allowed import allowed
from tendonlab.diagnosis.answer.beliefs import strain
from tendonlab.diagnosis.answer.calibration import shipped
from tendonlab.diagnosis.answer.caveats import caveats
from tendonlab.diagnosis.answer.explore import explore
from tendonlab.diagnosis.answer.findings import findings
from tendonlab.diagnosis.answer.heldout import Replayed
from tendonlab.diagnosis.answer.inverse import inverse_dynamics
from tendonlab.diagnosis.answer.next_experiments import advise
from tendonlab.diagnosis.answer.outlier_run import OutlierRun, find_outlier_run
from tendonlab.diagnosis.answer.overlays import overlays
from tendonlab.diagnosis.answer.verdict import Levels, Verdict, decide
from tendonlab.diagnosis.discrepancy import followed, scattered
from tendonlab.diagnosis.drift import Drift, over_session
from tendonlab.diagnosis.search.screen import INVISIBLE
from tendonlab.diagnosis.search.select import Search
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import Floor
from tendonlab.report.diagnosis import Diagnosis

OPEN = 0.02  # probability from which a rival of the first effect is worth an experiment
MOST_RIVALS = 3  # an exact twin or two may come before the first rival that a motion can tell apart


def answer(
    search: Search, nominal: Fitted, *, library: Sequence[str] | None, seed: int, seconds: Callable[[], float]
) -> Diagnosis:
    """The Diagnosis of a finished search. `nominal`: the untouched simulator, fitted in its initial states alone;
    `library`: names of the effects that were asked for (None: all)."""
    fitter, case, floor = search.fitter, search.fitter.case, search.fitter.floor
    everywhere = case.test or case.train
    models = [[case.system] * len(everywhere), *(heldout.models(case, model, everywhere) for model in search.path)]
    (untouched, *steps), judged, failed = heldout.replay_all(case, models, everywhere)
    if search.selected:  # an effect that was established stands out of the floor
        floor = floor.reached_by(heldout.rms(steps[-1]))
    stages = {"nominal": untouched, "refitted": steps[0], "with_effect": steps[-1]}
    drift = over_session(case, search.final)
    outlier = None if search.selected else find_outlier_run(case, search.tuned, floor)
    near = allowed(case, {"refitted": search.path[0], "with_effect": search.path[-1]}, floor, stages, judged)
    levels = _levels(search, nominal, stages, near, floor, drift, outlier)
    raw, calibration = decide(search.rounds, search.selected, levels), shipped(repeats=floor.repeated)
    verdict = calibration.applied(raw)
    held_out = _per_experiment(case, stages, floor, judged)
    how = notes.details(case, floor, nominal, search, drift) | _steps(case, search, steps)
    records = where.PortRecords(case, stages["with_effect"], judged)
    located = _where(case, stages["refitted"], floor, records, verdict)
    proposed, references = _what_next(case, floor, search, verdict, located["regimes"])
    return Diagnosis(
        dataset=case.dataset.name,
        system=case.system.kind,
        seed=seed,
        verdict=verdict.verdict,
        verdict_probability=verdict.probability,
        calibrated=calibration.holds(case.system.kind, runs=len(case.train)),
        replay=notes.replay(case),
        gap=_gap(case, stages, floor),
        where=located,
        effects=findings(fitter, search, verdict.effects, stages["refitted"], judged, seed),
        sets=tuple(verdict.sets),
        selected=search.selected,
        explained=levels.explained,
        indistinguishable=tuple(tuple(group) for group in verdict.indistinguishable),
        invisible=_invisible(search),
        shrinkage=_shrinkage(case, stages, floor, judged, seed),
        next_experiments=proposed,
        references=references,
        caveats=caveats(case, search.final, stages, floor, judged, drift, outlier),
        warnings=(
            *notes.warnings(case, floor, search),
            *notes.not_simulated(failed),
            *notes.not_asked(case, search, library),
            *notes.not_improved(held_out, search.selected),
            *notes.allowed_more(case, stages["with_effect"], near["with_effect"], floor, judged),
            *notes.no_noise(levels),
        ),
        units=notes.units(case),
        overlays=overlays(case, stages, floor, judged),
        where_map=where.maps(case, stages["refitted"], stages["with_effect"], floor, records),
        held_out=held_out,
        table=inverse_dynamics(case, [model.system for model in search.path], judged),
        split={name: [case.experiments[i].name for i in of] for name, of in _splits(case)},
        details=how | {"evidence": raw.evidence},
        seconds=seconds(),
    )


def _where(
    case: Case, refitted: Replayed, floor: Floor, records: where.PortRecords, verdict: Verdict
) -> dict[str, list[dict[str, Any]]]:
    return {
        "signals": where.signals(case, refitted, floor),
        "elements": where.elements(verdict.effects, verdict.sets, case),
        "regimes": where.regimes(case, refitted, floor, records),
    }


def _levels(
    search: Search,
    nominal: Fitted,
    stages: dict[str, Replayed],
    near: dict[str, Replayed],
    floor: Floor,
    drift: Drift | None,
    outlier: OutlierRun | None = None,
) -> Levels:
    case, final, doubtful = search.fitter.case, search.final, not floor.repeated
    levels = Levels(
        nominal=nominal.mean_square if floor.repeated else heldout.level(stages["nominal"], floor),
        tuned=search.tuned.mean_square,
        refitted=heldout.level(near["refitted"], floor),
        foretold=heldout.level(stages["refitted"], floor),
        explained=heldout.explained(stages["refitted"], near["with_effect"], floor) if search.selected else None,
        left=heldout.level(near["with_effect"], floor),
        repeated=floor.repeated,
        whitened=final.mean_square,
        trained=final.over_scatter(len(case.scatter)) if doubtful else 1.0,
        followed=followed(case, final) if doubtful else 0.0,
        scattered=scattered(case, final) if doubtful and not search.selected else 0.0,
        strained=0.0 if search.selected else strain(case, final),
        drifted=drift.chance if drift and drift.tells else 1.0,
    )
    return outlier.left_out(levels, nominal) if outlier else levels


def _splits(case: Case) -> list[tuple[str, Sequence[int]]]:
    return [("train", case.train), ("test", case.test)]


def _gap(case: Case, stages: dict[str, Replayed], floor: Floor) -> dict[str, dict[str, float]]:
    errors = {stage: heldout.rms(replayed) for stage, replayed in stages.items()}
    return {
        case.outputs[c]: {"noise_floor": float(floor.rms[c]), **{stage: float(e[c]) for stage, e in errors.items()}}
        for c in case.measured
    }


def _shrinkage(
    case: Case, stages: dict[str, Replayed], floor: Floor, judged: Sequence[int], seed: int
) -> dict[str, dict[str, Any]]:
    rng = np.random.default_rng(seed)
    return {
        f"from_{stage}": heldout.shrinkage(case, stages[stage], stages["with_effect"], floor, judged, rng)
        for stage in ("nominal", "refitted")
    }


def _steps(case: Case, search: Search, replayed: Sequence[Replayed]) -> dict[str, Any]:
    """Held-out rms of every output after the refit and after each effect that was added, as `steps`."""
    steps = [
        {"effects": list(model.added), "rms": {case.outputs[c]: float(heldout.rms(run)[c]) for c in case.measured}}
        for model, run in zip(search.path, replayed, strict=True)
    ]
    return {"steps": steps}


def _invisible(search: Search) -> tuple[str, ...]:
    """Effects that leave no trace in these data; of one that could not be simulated nothing is known."""
    screened = search.rounds[0].screened if search.rounds else ()
    faint = (s for s in screened if s.simulated and max(s.visibility, s.gain) < INVISIBLE)
    return tuple(s.effect for s in faint if s.effect not in search.selected)


def _next(case: Case, floor: Floor, search: Search) -> list[dict[str, Any]]:
    """Between the first effect and the likeliest of what is still open in its place that a motion separates from it."""
    if not search.rounds or (own := search.rounds[0].accepted) is None:
        return []
    share = search.rounds[0].probability
    rivals = [(share[t.effect], t.fitted) for t in search.rounds[0].trials if t is not own]
    likeliest = sorted([*rivals, (share[None], search.tuned)], key=lambda pair: -pair[0])[:MOST_RIVALS]
    proposals = (advise(case, floor, own.fitted, other) for probability, other in likeliest if probability > OPEN)
    return next(filter(None, proposals), [])


def _what_next(
    case: Case, floor: Floor, search: Search, verdict: Verdict, regimes: Sequence[Mapping[str, Any]]
) -> tuple[tuple[dict[str, Any], ...], dict[str, pd.DataFrame]]:
    """The proposed experiments, best first, and the references of those that are motions, by name."""
    motions, references = _numbered(_next(case, floor, search))
    is_unknown = verdict.verdict == "unknown_effect"
    kind = case.system.kind
    explored = explore(regimes, notes.units(case), kind, repeated=floor.repeated) if is_unknown else []
    return (*motions, *explored, *_measurements(case, verdict.indistinguishable)), references


def _numbered(found: list[dict[str, Any]]) -> tuple[list[dict[str, Any]], dict[str, pd.DataFrame]]:
    """The proposed experiments with names in place of their references, and the references by name."""
    references = {f"next-{k}.csv": row["reference"] for k, row in enumerate(found, start=1)}
    return [{**row, "reference": name} for name, row in zip(references, found, strict=True)], references


def _measurements(case: Case, ties: Sequence[Sequence[str]]) -> list[dict[str, Any]]:
    """What is known to separate tied causes, whether or not the simulator can make it."""
    return [
        {"description": known.separates, "separates": list(known.effects), "expected_gain": None}
        for group in ties
        for known in confusions.among(case.system.info, group)
    ]


def _per_experiment(case: Case, stages: dict[str, Replayed], floor: Floor, judged: Sequence[int]) -> pd.DataFrame:
    squares = {stage: [heldout.row_mean_squares(r) for r in run.residuals] for stage, run in stages.items()}
    rows = {stage: [heldout.gap(s, floor.rms) for s in values] for stage, values in squares.items()}
    return pd.DataFrame(rows, index=pd.Index([case.experiments[i].name for i in judged], name="experiment"))

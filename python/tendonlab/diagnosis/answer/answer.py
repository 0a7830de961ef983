"""The answers put together: gaps and shrinkage on held-out experiments, findings, maps, warnings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pandas as pd

from tendonlab.diagnosis import confusions
from tendonlab.diagnosis.answer import heldout, notes, where
from tendonlab.diagnosis.answer.allowed import allowed
from tendonlab.diagnosis.answer.by_noise import NO_NOISE, left_by_noise
from tendonlab.diagnosis.answer.calibration import shipped
from tendonlab.diagnosis.answer.caveats import caveats, drowned
from tendonlab.diagnosis.answer.explore import explore
from tendonlab.diagnosis.answer.findings import findings
from tendonlab.diagnosis.answer.followed import advise_unknown
from tendonlab.diagnosis.answer.heldout import Replayed
from tendonlab.diagnosis.answer.inverse import inverse_dynamics
from tendonlab.diagnosis.answer.judged import Judged
from tendonlab.diagnosis.answer.next_experiments import advise
from tendonlab.diagnosis.answer.outlier_run import OutlierRun, find_outlier_run
from tendonlab.diagnosis.answer.overlays import overlays
from tendonlab.diagnosis.answer.verdict import Levels, Verdict, decide
from tendonlab.diagnosis.beliefs import strain
from tendonlab.diagnosis.discrepancy import ENOUGH, NO_PATTERNS, patterns, scattered
from tendonlab.diagnosis.drift import Drift, held_out_factors, over_session
from tendonlab.diagnosis.search.screen import INVISIBLE
from tendonlab.diagnosis.search.select import Search
from tendonlab.diagnosis.search.trial import restores_belief
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import NEAR_FLOOR, Floor
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.simulation.prepare import Replay

OPEN = 0.02  # probability from which a rival of the first effect is worth an experiment
Seconds = Callable[[], float]  # since the diagnosis began
MOST_RIVALS = 3  # an exact twin or two may come before the first rival that a motion can tell apart


def answer(
    search: Search, nominal: Fitted, loop: Case | None, *, library: Sequence[str] | None, seed: int, seconds: Seconds
) -> Diagnosis:
    """The Diagnosis of a finished search. `nominal`: the untouched simulator, fitted in its initial states alone;
    `loop`: the same logs with their controller, where models were weighed without; the report then shows the errors in
    its closed loop; `library`: names of the effects that were asked for (None: all)."""
    fitter, case = search.fitter, search.fitter.case
    weighed = Judged.of(case, fitter.floor, search)
    floor, judged, stages = weighed.floor, weighed.experiments, weighed.stages
    shown, trouble = _shown(weighed, loop, search)
    drift = over_session(case, search.final, held_out_factors(fitter, search.final))
    outlier = None if search.selected else find_outlier_run(case, search.tuned, floor)
    near = allowed(case, {"refitted": search.path[0], "with_effect": search.path[-1]}, floor, stages, judged)
    levels = _levels(search, nominal, stages, near, floor, drift, outlier, judged=judged, seed=seed)
    raw, calibration = decide(search.rounds, search.selected, levels), shipped(repeats=fitter.floor.repeated)
    verdict = calibration.at(search.tuned.mean_square).applied(raw)
    how = notes.details(shown.case, floor, nominal, search, drift) | {"steps": shown.table_of_steps(search)}
    records = where.PortRecords(case, stages["with_effect"], judged)
    located = _where(case, stages["refitted"], floor, records, verdict)
    proposed, references = _what_next(case, shown.case.replay, floor, search, verdict, located["regimes"])
    return Diagnosis(
        dataset=case.dataset.name,
        system=case.system.kind,
        seed=seed,
        verdict=verdict.verdict,
        verdict_probability=verdict.probability,
        calibrated=calibration.holds(case.system.kind, runs=len(case.train)),
        replay=notes.replay(shown.case),
        gap=shown.gap(),
        where=located,
        effects=findings(search, verdict.effects, weighed, shown, seed),
        sets=tuple(verdict.sets),
        selected=search.selected,
        explained=levels.explained,
        indistinguishable=tuple(tuple(group) for group in verdict.indistinguishable),
        invisible=_invisible(search),
        shrinkage=shown.shrinkage(seed),
        next_experiments=proposed,
        references=references,
        caveats=caveats(search.final, shown, drift, outlier, relieved=search.tuned if levels.is_by_beliefs else None),
        warnings=(
            *notes.warnings(shown.case, floor, search),
            *trouble,
            *notes.not_asked(case, search, library),
            *notes.on_the_held_out(weighed, shown, near, search.selected),
            *notes.no_noise(levels, selected=bool(search.selected)),
            *notes.stops(levels),
        ),
        units=notes.units(case),
        overlays=overlays(shown),
        where_map=where.maps(case, stages["refitted"], stages["with_effect"], floor, records),
        held_out=shown.per_experiment(),
        table=inverse_dynamics(shown.case, [model.system for model in search.path], shown.experiments),
        split={name: [case.experiments[i].name for i in of] for name, of in _splits(case)},
        details=how | notes.weighed(weighed, shown) | {"evidence": raw.evidence},
        seconds=seconds(),
    )


def _shown(weighed: Judged, loop: Case | None, search: Search) -> tuple[Judged, list[str]]:
    """What a reader sees: the models in the closed loop of the rig, where it is known; and a warning where they fail
    there."""
    if loop is None:
        return weighed, []
    try:
        return Judged.in_loop(loop, search), []
    except NumericalError as error:
        return weighed, [f"Errors are those of an injection. In the closed loop: {error}."]


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
    *,
    judged: Sequence[int] = (),
    seed: int = 0,
) -> Levels:
    case, final, doubtful = search.fitter.case, search.final, not floor.repeated
    left, noise = heldout.level(near["with_effect"], floor), NO_NOISE
    if floor.repeated and left > NEAR_FLOOR:
        noise = left_by_noise(case, final.system, floor, judged, seed=seed)
    explained = heldout.explained(stages["refitted"], near["with_effect"], floor, least=noise.left)
    levels = Levels(
        nominal=nominal.mean_square if floor.repeated else heldout.level(stages["nominal"], floor),
        tuned=search.tuned.mean_square,
        refitted=heldout.level(near["refitted"], floor),
        predicted=heldout.level(stages["refitted"], floor),
        explained=explained if search.selected else None,
        left=left,
        repeated=floor.repeated,
        whitened=final.mean_square,
        trained=final.over_scatter(len(case.scatter)) if doubtful else 1.0,
        patterns=patterns(case, final) if doubtful or len(case.train) >= ENOUGH else NO_PATTERNS,
        scattered=scattered(case, final) if doubtful and not search.selected else 0.0,
        strained=strain(case, final),
        drifted=drift.chance if drift and drift.tells else 1.0,
        drowned=len(drowned(case, floor, judged)) == len(case.measured),
        relieved=bool(search.selected) and restores_belief(case, search.tuned, final),
        noise=noise,
    )
    return outlier.left_out(levels, nominal) if outlier else levels


def _splits(case: Case) -> list[tuple[str, Sequence[int]]]:
    return [("train", case.train), ("test", case.test)]


def _invisible(search: Search) -> tuple[str, ...]:
    """Effects that leave no trace in these data; of one that could not be simulated nothing is known."""
    screened = search.rounds[0].screened if search.rounds else ()
    faint = (s for s in screened if s.simulated and max(s.visibility, s.gain) < INVISIBLE)
    return tuple(s.effect for s in faint if s.effect not in search.selected)


def _next(case: Case, loop: Replay, floor: Floor, search: Search) -> list[dict[str, Any]]:
    """Between the first effect and the likeliest of what is still open in its place that a motion separates from it."""
    if not search.rounds or (own := search.rounds[0].accepted) is None:
        return []
    share = search.rounds[0].probability
    rivals = [(share[t.effect], t.fitted) for t in search.rounds[0].trials if t is not own]
    likeliest = sorted([*rivals, (share[None], search.tuned)], key=lambda pair: -pair[0])[:MOST_RIVALS]
    proposals = (advise(case, loop, floor, own.fitted, other) for probability, other in likeliest if probability > OPEN)
    return next(filter(None, proposals), [])


def _what_next(
    case: Case,
    loop: Replay,
    floor: Floor,
    search: Search,
    verdict: Verdict,
    regimes: Sequence[Mapping[str, Any]],
) -> tuple[tuple[dict[str, Any], ...], dict[str, pd.DataFrame]]:
    """The proposed experiments, best first, and the references of those that are motions, by name."""
    is_unknown, kind = verdict.verdict == "unknown_effect", case.system.kind
    followed = advise_unknown(case, loop, search.final) if is_unknown else []
    motions, references = _numbered([*_next(case, loop, floor, search), *followed])
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

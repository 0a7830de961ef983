"""Would I have seen it? Simulated rigs of the user's kind, each without one effect, are diagnosed and counted."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from functools import partial
from os import PathLike
from pathlib import Path

import numpy as np
import pandas as pd

from tendonlab.arguments import positive, whole
from tendonlab.data import Dataset, load, require_dataset
from tendonlab.diagnosis.diagnose import diagnose as library_diagnose
from tendonlab.errors import ParameterError, expected_one_of
from tendonlab.progress import track
from tendonlab.rehearsal.build import simulated_rig
from tendonlab.rehearsal.cases import NOTHING, RehearsalCase, ordered_cases
from tendonlab.rehearsal.plan import planned_experiments, rig_without_logs, still_notes
from tendonlab.rehearsal.result import Rehearsal
from tendonlab.rehearsal.rig import SimulatedRig
from tendonlab.rehearsal.run import Diagnose, Progress, Row, Work, run_cases
from tendonlab.rehearsal.settings import settings_of
from tendonlab.rehearsal.sizes import Gauge, Ladder, withheld_effects
from tendonlab.rehearsal.store import Store
from tendonlab.rehearsal.tally import effect_rehearsal, false_effects, nothing_withheld, reliability
from tendonlab.rehearsal.words import OWN_LAWS
from tendonlab.seed import checked
from tendonlab.threads import with_one_blas_thread

SIZES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)  # gap over noise
COLUMNS = (
    "case", "effect", "gap", "repeat", "outcome", "verdict", "named", "on_truth", "stated", "right", "seconds",
    "message",
)  # fmt: skip
Path_ = str | PathLike[str]


@with_one_blas_thread
def rehearse(
    rig: Dataset | Path_,
    *,
    plan: Path_ | None = None,
    effects: Sequence[str] | None = None,
    sizes: Sequence[float] = SIZES,
    repeats_per_size: int = 6,
    minutes: float = 15.0,
    jobs: int = 1,
    seed: int = 0,
    out: Path_ | None = None,
    progress: bool = True,
    diagnose: Diagnose | None = None,
) -> Rehearsal:
    """Say which effects a diagnosis of these experiments would find, and from which size on.

    Rigs are simulated in the experiments of `rig`, a dataset or its folder: with the same inputs, controller, time
    stamps, sensor noise and held-out experiments, and with parameters drawn from the stated beliefs. One effect is
    withheld from each, or nothing. Each is diagnosed and the answers are counted. The simulated rigs contain the
    library's own laws.

    `plan`: a TOML file with experiments that are not made yet (docs/rehearsal.md); then the folder needs no logs.
    `effects`: names such as "joint:stribeck"; all that a diagnosis would consider by default. `sizes`: gaps over
    noise that an effect leaves after tuning. `repeats_per_size`: rigs per effect and size, at most. `minutes`: time
    for the diagnoses; the first ones tell how many fit, the others are left out. `jobs`: processes; with more than 1,
    a script must guard its start by `if __name__ == "__main__"`. `seed`: the same seed gives the same rigs. `out`: a
    folder in which each diagnosis is stored as it is done; the same call resumes. `diagnose`: a function of a Dataset
    that gives a Diagnosis, by default `tendonlab.diagnose`.
    Ctrl-C ends it early and counts what was done. Raises ParameterError for an unknown effect or a value outside its
    bounds, DatasetError for a broken folder or plan, for a sensor whose noise is not known, or where `out` belongs to
    a rehearsal of other settings."""
    began, seed, jobs = time.monotonic(), checked(seed), whole("jobs", jobs, 1)
    gaps, repeats = _checked_sizes(sizes), whole("repeats_per_size", repeats_per_size, 1)
    seconds = 60.0 * positive("minutes", minutes, "min")
    dataset = _dataset(rig, plan)
    names = _checked_effects(dataset, effects)
    planned = None if plan is None else planned_experiments(Path(plan), dataset)
    rigs = simulated_rig(dataset, planned, progress=progress)
    judge = partial(library_diagnose, progress=False) if diagnose is None else diagnose
    store = Store(None if out is None else Path(out), settings_of(rigs, gaps, seed, diagnose))
    gauge = Gauge(rigs)
    shown = track(names, label="sizes of effects", total=len(names), unit="effect", shown=progress, stays=False)
    ladders = [gauge.ladder(name, gaps[0]) for name in shown]
    cases = ordered_cases({each.effect: _at_sizes(each, gaps) for each in ladders}, gaps, repeats)
    left = seconds - (time.monotonic() - began)
    ended = run_cases(Work(rigs, seed, judge), cases, store, seconds=left, jobs=jobs, progress=progress)
    rows = [store.rows[case.key] for case in cases if case.key in store.rows]
    if ended.interrupted and not rows:
        raise KeyboardInterrupt
    return _result(rigs, ladders, cases, rows, ended, seed=seed, sizes=gaps, seconds=time.monotonic() - began)


def _dataset(rig: Dataset | Path_, plan: Path_ | None) -> Dataset:
    """The dataset of the rig, which needs no logs where experiments are planned."""
    if isinstance(rig, str | PathLike):
        rig = load(rig) if plan is None else rig_without_logs(Path(rig))
    require_dataset(rig)
    return rig


def _at_sizes(ladder: Ladder, gaps: Sequence[float]) -> dict[float, dict[str, float]]:
    """The parameters of an effect at every gap that it can leave."""
    return {gap: ladder.values(gap) for gap in gaps if gap <= ladder.largest_gap}


def _checked_sizes(sizes: Sequence[float]) -> tuple[float, ...]:
    if isinstance(sizes, str) or not isinstance(sizes, Sequence | np.ndarray) or len(sizes) == 0:
        raise ParameterError(f"sizes = {sizes!r:.60}: expected gaps over noise, such as {list(SIZES)}")
    gaps = [positive(f"sizes[{k}]", size) for k, size in enumerate(sizes)]
    if len(set(gaps)) < len(gaps):
        raise ParameterError(f"sizes = {list(gaps)}: expected each size once")
    return tuple(sorted(gaps))


def _checked_effects(rig: Dataset, effects: Sequence[str] | None) -> list[str]:
    system = rig.system()
    known = withheld_effects(system, rig.outputs)
    if effects is None:
        return known
    if isinstance(effects, str):
        raise ParameterError(f"effects = {effects!r}: expected a list such as ['joint:stribeck']")
    for name in effects:
        system.info.effect(name)  # an unknown name says so
        if name not in known:
            reason = "it is in the simulator, its sensor was not recorded, or it needs another effect"
            raise ParameterError(f"{name!r} cannot be withheld: {reason}; {expected_one_of(name, known)}")
    return list(dict.fromkeys(effects))


def _result(
    rigs: SimulatedRig,
    ladders: Sequence[Ladder],
    cases: Sequence[RehearsalCase],
    rows: Sequence[Row],
    ended: Progress,
    *,
    seed: int,
    sizes: tuple[float, ...],
    seconds: float,
) -> Rehearsal:
    entries = [effect_rehearsal(ladder, rows) for ladder in ladders]
    on_truth, bins = reliability(rows)
    frame = pd.DataFrame(rows, columns=list(COLUMNS)).set_index("case")
    return Rehearsal(
        dataset=rigs.rig.name,
        system=rigs.rig.kind,
        seed=seed,
        seconds=round(seconds, 1),
        planned=rigs.planned,
        sizes=sizes,
        effects=tuple(sorted(entries, key=_smallest_first)),
        nothing=nothing_withheld(rows),
        false_effects=false_effects(rows),
        on_truth=on_truth,
        reliability=tuple(bins),
        num_left_out=ended.num_left_out,
        interrupted=ended.interrupted,
        notes=_notes(rigs, cases),
        cases=frame,
    )


def _smallest_first(entry: object) -> tuple[int, float]:
    threshold = getattr(entry, "threshold", None)
    if threshold is None:
        return 2, math.inf
    return int(threshold.kind == "above"), threshold.size


def _notes(rigs: SimulatedRig, cases: Sequence[RehearsalCase]) -> tuple[str, ...]:
    """What was assumed."""
    free, noise = len(rigs.beliefs), rigs.noise
    driven = (
        "the logged command and a loop that tracks the logged motion drive the rigs"
        if rigs.drive.tracks
        else "the stated controller drives the rigs along the reference"
        if rigs.drive.controller is not None
        else "the inputs drive the rigs as they are"
    )
    clean = sum(case.effect == NOTHING for case in cases)
    return (
        *(still_notes(rigs.rig.experiments, rigs.rig) if rigs.planned else ()),
        OWN_LAWS,
        f"{free} parameters of each rig were drawn from the beliefs, at most 2 sd from the nominal values.",
        f"Noise: {noise.words}, and {100 * noise.scatter:.1g} % scatter of each element's friction from run to run.",
        f"Drive: {driven}.",
        f"Asked for: {len(cases)} rigs, {clean} of them with nothing withheld.",
    )

"""Where the gap lies, which effect causes it, how far it shrinks: the whole diagnosis, step by step."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

from tendonlab.checking.check import check
from tendonlab.checking.samples import FEWEST
from tendonlab.checking.spikes import without_outliers
from tendonlab.data import Dataset, require_dataset, simulator_of
from tendonlab.diagnosis.answer.answer import answer
from tendonlab.diagnosis.fault import data_fault
from tendonlab.diagnosis.late import checked_again
from tendonlab.diagnosis.outcome import outcome_of
from tendonlab.diagnosis.search.workshop import open_workshop
from tendonlab.errors import DatasetError, ParameterError
from tendonlab.fitting.fitted import Fitted
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.seed import checked
from tendonlab.simulation.system import System
from tendonlab.threads import with_one_blas_thread

FORCED = "The check found problems in the logs that mislead a diagnosis. The diagnosis was run anyway (force)."


@with_one_blas_thread
def diagnose(
    dataset: Dataset,
    *,
    system: System | None = None,
    library: str | Sequence[str] = "default",
    seed: int = 0,
    progress: bool = True,
    force: bool = False,
) -> Diagnosis:
    """Say where the gap between `system` (the dataset's own simulator unless given) and the logs lies, which unmodelled
    effect causes it, and how far the gap shrinks on held-out experiments once it is added.
    The logs are checked first, as `tendonlab.check` does: a wrong sign, scale or clock ends it with the verdict
    "data_fault", unless `force`. Outliers are left out; logs far above the bandwidth of the motion are thinned.

    `library`: "default", every effect that the system takes, or names as "joint:stribeck"; a law that is the whole
    friction of its element is swapped in only where it is named. `seed`: the bootstrap's.
    Raises DatasetError for a signal that the replay needs and was not logged, ParameterError for an unknown effect or a
    `seed` that is no whole number. Ctrl-C stops it. How it works: docs/method.md."""
    require_dataset(dataset)
    began, seed = time.monotonic(), checked(seed)
    system, names = simulator_of(dataset, system), _library(dataset, library)
    _require_samples(dataset)
    logs = check(dataset, system=system)
    if logs.blocks and not force:
        return data_fault(dataset, system, logs, seed=seed, seconds=time.monotonic() - began)
    if any(finding.problem == "outliers" for finding in logs.findings):
        dataset = without_outliers(dataset)
    with open_workshop(names, progress=progress) as shop:
        search, nominal, loop, warnings, is_untried = outcome_of(dataset, system, shop)
        logs = checked_again(logs, dataset, search)
        if logs.blocks and not force:
            return data_fault(dataset, system, logs, seed=seed, seconds=time.monotonic() - began)
        found = answer(search, nominal, loop, library=names, seed=seed, seconds=lambda: time.monotonic() - began)
    warnings = (*((FORCED,) if logs.blocks else ()), *warnings, *found.warnings)
    data = tuple(finding.to_dict() for finding in logs.findings)
    return replace(found, data=data, warnings=warnings, calibrated=found.calibrated and not is_untried)


@with_one_blas_thread
def best_model(dataset: Dataset, *, progress: bool) -> Fitted:
    """The model of `dataset` that a diagnosis ends with, without its answer. Raises as `diagnose`."""
    system = dataset.system()
    _require_samples(dataset)
    with open_workshop(None, progress=progress) as shop:
        return outcome_of(dataset, system, shop).search.final


def _require_samples(dataset: Dataset) -> None:
    """Raise DatasetError for an experiment too short to show a motion."""
    for experiment in dataset.experiments if not dataset.system().info.steady else ():
        if (num := len(experiment.data)) < FEWEST:
            raise DatasetError(f"{experiment.name} has {num} samples: expected at least {FEWEST}; leave it out")


def _library(dataset: Dataset, library: str | Sequence[str]) -> Sequence[str] | None:
    if library == "default":
        return None
    if isinstance(library, str):
        raise ParameterError(f"library = {library!r}: expected 'default' or a list such as ['joint:stribeck']")
    info = dataset.system().info
    return [info.effect(name).name for name in library]

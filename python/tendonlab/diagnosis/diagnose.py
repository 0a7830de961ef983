"""Where the gap lies, which effect causes it, how far it shrinks: the whole diagnosis, step by step."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from functools import partial

import numpy as np

from tendonlab import _core
from tendonlab.data import Dataset, require_dataset
from tendonlab.diagnosis.answer.answer import compose
from tendonlab.diagnosis.search.select import search
from tendonlab.errors import ParameterError
from tendonlab.fitting import noise
from tendonlab.fitting.case import Case, fine_enough, make_case
from tendonlab.fitting.fitted import Fitted, Fitter
from tendonlab.fitting.noise import Floor, Sensitivities
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.seed import checked
from tendonlab.simulation.system import System

ROUGH = 8  # iterations of the first fit, of which only the residuals are used

log = logging.getLogger("tendonlab")


def diagnose(
    dataset: Dataset,
    *,
    system: System | None = None,
    library: str | Sequence[str] = "default",
    seed: int = 0,
    progress: bool = True,
) -> Diagnosis:
    """Say where the gap between `system` (the dataset's own simulator unless given) and the logs lies, which unmodelled
    effect causes it, and how far the gap shrinks on held-out experiments once it is added.

    `library`: "default", every effect that the system takes, or names as "joint:stribeck". `seed`: the bootstrap's.
    Raises DatasetError for a signal that the replay needs and was not logged, ParameterError for an unknown effect or a
    `seed` that is no whole number. Ctrl-C stops it. Source: docs/method.md."""
    require_dataset(dataset)
    began, seed = time.monotonic(), checked(seed)
    names = _library(dataset, library)
    case = make_case(dataset, system)
    with _workers() as (pool, cancel):
        first = _fitter(case, noise.white(case), cancel).fit(case.system, max_iterations=ROUGH)
        seen = _sensitivities(case, first, pool)
        floor = noise.estimate(case, seen, case.train)
        groups = tuple((tuple(group), floor.tau) for group in noise.friction_groups(case.system))
        settings = fine_enough(case, np.fmax(case.noise, np.fmin(floor.rms, floor.sd)))
        case = replace(case, settings=settings, scatter=groups)
        fitter = _fitter(case, floor, cancel, seen)
        start = [[*states, *(0.0 for _ in groups)] for states in first.initial]
        nominal = fitter.fit(case.system, initial=start, known=True, solve=any(start))  # there may be no unknown
        null = fitter.fit(first.system, initial=start)
        renew = partial(_renewed, pool=pool)
        found = search(fitter, null, pool=pool, renew=renew, progress=progress, library=names)
        log.info("selected %s", found.selected)
        return compose(fitter, nominal, found, seed=seed, seconds=lambda: time.monotonic() - began)


def _fitter(case: Case, floor: Floor, cancel: _core.Cancel, seen: Sequence[Sensitivities] = ()) -> Fitter:
    return Fitter(case, noise.whitenings(case, floor, seen), floor, cancel)


def _renewed(fitter: Fitter, best: Fitted, *, pool: ThreadPoolExecutor) -> tuple[Fitter, Fitted]:
    """The fitter and the best model so far for the search of a further effect. Repeats say what noise is once and for
    all; without them, noise is what the best model leaves."""
    if fitter.floor.repeated:
        return fitter, best
    case = fitter.case
    seen = _sensitivities(case, best, pool)
    now = noise.estimate(case, seen, case.train)
    floor = replace(fitter.floor, sd=now.sd, share=now.share)
    fitter = _fitter(case, floor, fitter.cancel, seen)
    return fitter, fitter.fit(best.system, added=best.added, initial=best.initial)


def _sensitivities(case: Case, fitted: Fitted, pool: ThreadPoolExecutor) -> list[Sensitivities]:
    initial = dict(zip(case.train, fitted.initial, strict=True))

    def seen(i: int) -> Sensitivities:
        start = initial.get(i, case.own_mean(i).tolist())
        return noise.sensitivities(case, fitted.system, i, start)

    return list(pool.map(seen, range(len(case.experiments))))


def _library(dataset: Dataset, library: str | Sequence[str]) -> Sequence[str] | None:
    if library == "default":
        return None
    if isinstance(library, str):
        raise ParameterError(f"library = {library!r}: expected 'default' or a list such as ['joint:stribeck']")
    info = dataset.system().info
    return [info.effect(name).name for name in library]


@contextmanager
def _workers() -> Iterator[tuple[ThreadPoolExecutor, _core.Cancel]]:
    """Threads for fits (the core releases the interpreter); Ctrl-C cancels what runs in them."""
    cancel = _core.Cancel()
    pool = ThreadPoolExecutor()
    try:
        yield pool, cancel
    except BaseException:
        cancel.set()
        raise
    finally:
        pool.shutdown(cancel_futures=True)

"""Where the gap lies, which effect causes it, how far it shrinks: the whole diagnosis, step by step."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import numpy as np

from tendonlab import _core
from tendonlab.data import Dataset
from tendonlab.diagnose import floor as noise
from tendonlab.diagnose.case import Case, make_case
from tendonlab.diagnose.compose import compose
from tendonlab.diagnose.fits import Fitted, Fitter
from tendonlab.diagnose.floor import Floor, Sensitivities
from tendonlab.diagnose.result import Diagnosis
from tendonlab.diagnose.search import search
from tendonlab.errors import ParameterError
from tendonlab.system import System

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

    `library`: "default", every effect that the system takes, or names such as "joint:stribeck". `seed`: of the bootstrap.
    Raises DatasetError for a signal that the replay needs and was not logged, ParameterError for an unknown effect.
    Ctrl-C stops it. Source: DIAGNOSIS section 2."""
    began = time.monotonic()
    names = _library(dataset, library)
    case = make_case(dataset, system)
    with _workers() as (pool, cancel):
        null, floor, whitening = _prepare(case, pool, cancel)
        fitter = Fitter(case, whitening, floor.ar, floor.sd, cancel)
        nominal = fitter.fit(case.system, initial=null.initial, solve=False)
        null = fitter.fit(null.system, initial=null.initial)
        found = search(fitter, null, pool=pool, progress=progress, library=names)
        log.info("selected %s", found.selected)
        return compose(fitter, floor, nominal, found, seed=seed, seconds=lambda: time.monotonic() - began)


def _prepare(case: Case, pool: ThreadPoolExecutor, cancel: _core.Cancel) -> tuple[Fitted, Floor, list[_core.Whitening]]:
    """A first refit in white noise, and from its residuals the floor and the whitening that all models share."""
    white = noise.white(case)
    sd = [float(s) if np.isfinite(s) else 0.0 for s in case.noise]
    first = Fitter(case, white, [[] for _ in sd], sd, cancel).fit(case.system)
    position = {i: t for t, i in enumerate(case.train)}

    def seen(i: int) -> Sensitivities:
        return noise.sensitivities(case, first.system, i, _initial(case, first, i, position))

    sensitivities = list(pool.map(seen, range(len(case.experiments))))
    floor = noise.estimate(case, sensitivities, case.train)
    return first, floor, noise.whitenings(case, floor, sensitivities)


def _initial(case: Case, fitted: Fitted, i: int, position: dict[int, int]) -> Sequence[float]:
    if i in position:
        return fitted.initial[position[i]]
    core = case.prepared[i].core
    return [(core.position if of == "position" else core.velocity)[axis] for of, axis in case.prepared[i].initial]


def _library(dataset: Dataset, library: str | Sequence[str]) -> Sequence[str] | None:
    if library == "default":
        return None
    if isinstance(library, str):
        raise ParameterError(f"library = {library!r}: expected 'default' or a list of effects such as ['joint:stribeck']")
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




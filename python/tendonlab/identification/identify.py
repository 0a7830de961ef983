"""Fit the free parameters of a simulator to logged experiments."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from contextlib import suppress
from dataclasses import replace
from numbers import Integral
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from tendonlab import _core
from tendonlab.arguments import within
from tendonlab.data import require_dataset, simulator_of
from tendonlab.errors import DatasetError, NumericalError, ParameterError
from tendonlab.fitting.case import Case, make_case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import white
from tendonlab.fitting.priors import start_of
from tendonlab.fitting.problem import Problem, finer, pose
from tendonlab.fitting.starts import annealed
from tendonlab.identification.result import Identification
from tendonlab.progress import track
from tendonlab.seed import generator
from tendonlab.simulation.catalog import unit
from tendonlab.simulation.system import System
from tendonlab.threads import with_one_blas_thread

if TYPE_CHECKING:
    from tendonlab.data import Dataset

__all__ = ["Identification", "identify"]

START_SHARE = 0.2  # of its typical size: where an added effect starts; at 0 its shape would have no derivative
LARGER_SHARES = (1.0, 3.0)  # where an added effect starts again that has vanished
VANISHED = 1e-2  # of its typical size, below which an added effect has vanished
STATE_STEPS = 10  # iterations for initial states that are found anew


@with_one_blas_thread
def identify(
    dataset: Dataset,
    *,
    system: System | None = None,
    effects: Sequence[str] = (),
    experiments: Sequence[str] | None = None,
    num_starts: int = 1,
    seed: int | np.random.Generator = 0,
    progress: bool = True,
    tolerance: float | None = None,
) -> Identification:
    """Fit the free parameters of `system` (the dataset's own unless given) to all training experiments together, after
    adding `effects` ("joint:stribeck"); parameters with sd = 0 stay fixed.

    Output error: simulated against measured outputs, in their noise sd (stated, else estimated), with priors, bounds,
    conditions and additions, and uncertain initial states as nuisances. A parameter on which no measured sample depends
    is held at its nominal value and listed (`not_informed`). `experiments`: names, instead of the training
    ones. `num_starts`: the first from the nominal values, the others drawn from the priors with `seed`; the best is
    kept. Each is led by fits under falling noise, and runs that it leaves in a wrong initial state start again.
    An added effect that is gone at the end of its fit starts again, larger.
    `tolerance`: relative error of a step of the simulation; default: the loosest at which the simulator's own
    error stays below a twentieth of the sensors' noise, where the fit starts and where it ends. Ctrl-C keeps the best
    so far, `converged` False.
    Raises DatasetError if a signal that the system needs was not measured, ParameterError for an unknown effect or a
    duplicate name, NumericalError if no start can be simulated. Source: S2 sec. 4."""
    require_dataset(dataset)
    if not isinstance(num_starts, Integral) or num_starts < 1:
        raise ParameterError(f"num_starts = {num_starts!r}: expected at least 1, a whole number")
    effects = _names("effects", effects)
    chosen = dataset.train if experiments is None else tuple(dataset[n] for n in _names("experiments", experiments))
    if not chosen:
        raise DatasetError(f"{dataset.name}: no training experiment; expected at least one with split = train")
    base = simulator_of(dataset, system)
    tolerance = None if tolerance is None else within("tolerance", tolerance, 1e-14, 0.1)
    case = make_case(dataset, base, experiments=[replace(e, split="train") for e in chosen], tolerance=tolerance)
    problem = _problem(case, effects, START_SHARE)
    fit = _solve(_starts(problem, num_starts, generator(seed)), progress=progress)
    if fit.converged and _vanished(problem, fit):
        with suppress(NumericalError):  # the larger effect may be one that cannot be simulated
            larger = _solve([_problem(case, effects, share) for share in LARGER_SHARES], progress=progress)
            fit = min(fit, larger, key=lambda f: f.cost)
    if tolerance is None and fit.converged:
        problem, fit = _fine_where_it_ended(problem, fit)
    return _result(problem, problem.return_to_prior(fit))


def _fine_where_it_ended(problem: Problem, fit: Fitted) -> tuple[Problem, Fitted]:
    try:
        return finer(problem, fit, _core.Cancel())
    except NumericalError:  # what runs at one tolerance need not run at another
        return problem, fit
    except KeyboardInterrupt:
        return problem, replace(fit, converged=False, message="cancelled")


def _names(what: str, given: Sequence[str]) -> tuple[str, ...]:
    if isinstance(given, str):
        raise ParameterError(f"{what} = {given!r}: expected a list, such as [{given!r}]")
    if not isinstance(given, Sequence):
        raise ParameterError(f"{what} = {given!r:.60}: expected a list of names")
    twice = [name for k, name in enumerate(given) if name in given[:k]]
    if twice:
        raise ParameterError(f"{what}: duplicate {twice[0]!r}; expected each name once")
    return tuple(given)


def _problem(case: Case, effects: Sequence[str], share: float) -> Problem:
    """The fit of the case's simulator with `effects` added, under the sensors' noise. They start at a `share` of their
    typical size."""
    system = case.system
    added = [name for name in effects if name not in system.effects]
    grown = system.with_effects({name: start_of(system, name, case.scales) for name in added})
    problem = pose(case, white(case.noise), grown, added=added)
    begun = {f.name: share * f.scale for f in _amplitudes(problem)}
    bounds = {name: grown.info.parameter(name) for name in begun}
    begun = {name: min(max(value, bounds[name].lower), bounds[name].upper) for name, value in begun.items()}
    return problem.at(grown.with_parameters(begun), ())


def _amplitudes(problem: Problem) -> list[_core.Free]:
    """Those of the effects that were added to the case's simulator."""
    info, own = problem.system.info, problem.case.system.effects
    new = {name for e in problem.system.effects if e not in own for name in info.effect(e).parameters}
    return [f for f in problem.free if f.name in new and info.parameter(f.name).amplitude]


def _vanished(problem: Problem, fit: Fitted) -> bool:
    """Whether nothing is left of an added effect: it may have started on the wrong side of a ridge."""
    return any(abs(fit.system.parameters[f.name]) < VANISHED * f.scale for f in _amplitudes(problem))


def _starts(problem: Problem, num_starts: int, rng: np.random.Generator) -> list[Problem]:
    starts = [problem]
    for _ in range(num_starts - 1):
        values = {}
        for f in problem.free:
            width = f.sd if np.isfinite(f.sd) else 1.0
            values[f.name] = f.started(f.value(f.mean + width * rng.normal())).start
        starts.append(problem.at(problem.system.with_parameters(values), ()))
    return starts


def _solve(starts: Sequence[Problem], *, progress: bool) -> Fitted:
    """The best of several fits, run in threads; the order of the starts decides ties, whatever finishes first."""
    cancel = _core.Cancel()
    with ThreadPoolExecutor(max_workers=min(len(starts), os.cpu_count() or 1)) as pool:
        jobs = [pool.submit(_solved, start, cancel) for start in starts]
        try:
            for _ in track(as_completed(jobs), total=len(jobs), label="identify", unit="start", shown=progress):
                pass
        except KeyboardInterrupt:
            cancel.set()
            for job in jobs:
                job.cancel()
    return _best(jobs)


def _solved(start: Problem, cancel: _core.Cancel) -> Fitted:
    return start.reseated(annealed(start, cancel).solve(cancel=cancel), cancel, steps=STATE_STEPS)


def _best(jobs: Sequence[Future[Fitted]]) -> Fitted:
    fits: list[Fitted] = []
    failure: NumericalError | None = None
    for job in jobs:
        if job.cancelled():
            continue
        try:
            fits.append(job.result())
        except NumericalError as error:
            failure = failure or error
    if not fits:
        raise failure or KeyboardInterrupt
    return min(fits, key=lambda fit: fit.cost)


def _result(problem: Problem, fit: Fitted) -> Identification:
    case, system = problem.case, fit.system
    noise = {case.outputs[c]: float(case.noise[c]) for c in case.measured}
    residuals = {e.name: _residual_frame(problem, fit, t) for t, e in enumerate(case.prepared)}
    return Identification(
        system=system,
        parameters=_table(case, fit),
        correlations=_correlations(fit),
        residuals=residuals,
        errors=_errors(case, residuals.values()),
        initial={
            e.name: {_state(case, *part): v for part, v in zip(e.initial, own, strict=True)}
            for e, own in zip(case.prepared, fit.initial, strict=True)
        },
        noise_sd=noise,
        cost=fit.cost,
        prior_cost=fit.prior_cost,
        converged=fit.converged,
        message=fit.message,
        num_iterations=fit.num_iterations,
        warnings=case.dataset.warnings,
        problem=problem.at(system, fit.initial),
    )


def _state(case: Case, of: str, index: int) -> str:
    """A part of the initial state in words."""
    return case.outputs[index] if of == "reading" else f"{of} of axis {index}"


def _table(case: Case, fit: Fitted) -> pd.DataFrame:
    """A row per free parameter."""
    names = [f.name for f in fit.free]
    nominal, known = case.dataset.parameters, np.array(fit.informed)
    return pd.DataFrame(
        {
            "value": [fit.system.parameters[n] for n in names],
            "nominal": [nominal[n].value if n in nominal else 0.0 for n in names],
            "sd": fit.uncertainty.sd,
            "ci95_lower": fit.uncertainty.lower,
            "ci95_upper": fit.uncertainty.upper,
            "unit": [fit.system.unit(n) for n in names],
            "at_bound": np.array(fit.at_bound) & known,
            "informed": known,
        },
        index=pd.Index(names, name="parameter"),
    )


def _correlations(fit: Fitted) -> pd.DataFrame:
    names = [f.name for f in fit.free]
    return pd.DataFrame(fit.uncertainty.correlations, index=names, columns=names)


def _errors(case: Case, residuals: Iterable[pd.DataFrame]) -> pd.DataFrame:
    """Rms error and spread of each output that was measured, in its unit."""
    frames, rows = list(residuals), {}
    for c in case.measured:
        output = case.system.info.outputs[c]
        missed = [f[output.name].to_numpy() * case.noise[c] for f in frames if output.name in f]
        seen = [e.measured[c] for e in case.prepared if np.isfinite(e.measured[c]).any()]
        moved = [y - np.nanmean(y) for y in seen]
        errors = [float(np.sqrt(np.nanmean(np.square(np.concatenate(of))))) for of in (missed, moved)]
        rows[output.name] = (*errors, unit(output.dimension, case.system.axis))
    return pd.DataFrame.from_dict(rows, orient="index", columns=["rms_error", "spread", "unit"])


def _residual_frame(problem: Problem, fit: Fitted, t: int) -> pd.DataFrame:
    """Residuals of experiment t by time, s, with a column per measured output, in noise sd."""
    ready = problem.case.prepared[t]
    outputs, samples = problem.floor.whitening(ready.measured).cells()
    values = np.full(ready.measured.shape, np.nan)
    values[outputs, samples] = fit.runs[t].residual
    columns = {problem.case.outputs[c]: values[c] for c in np.unique(outputs)}
    return pd.DataFrame(columns, index=pd.Index(ready.core.time, name="t"))

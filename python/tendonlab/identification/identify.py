"""Fit the free parameters of a simulator to logged experiments."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from numbers import Integral
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from tqdm import tqdm

from tendonlab import _core
from tendonlab.data import require_dataset
from tendonlab.errors import DatasetError, NumericalError, ParameterError
from tendonlab.fitting import priors
from tendonlab.fitting.informed import hold
from tendonlab.fitting.replay import choose_replay
from tendonlab.fitting.uncertainty import uncertainty
from tendonlab.identification.result import Identification, Problem
from tendonlab.seed import generator
from tendonlab.simulation.catalog import unit
from tendonlab.simulation.prepare import Prepared, prepare
from tendonlab.simulation.signals import white_noise_sd

if TYPE_CHECKING:
    from tendonlab.data import Dataset, Experiment
    from tendonlab.simulation.system import System

__all__ = ["Identification", "Problem", "identify", "noise_sd", "pose"]

START_SHARE = 0.2  # of its typical size: where an added effect starts; at 0 its shape would have no derivative


def identify(
    dataset: Dataset,
    *,
    system: System | None = None,
    effects: Sequence[str] = (),
    experiments: Sequence[str] | None = None,
    num_starts: int = 1,
    seed: int | np.random.Generator = 0,
    progress: bool = True,
    tolerance: float = 1e-5,
) -> Identification:
    """Fit the free parameters of `system` (the dataset's own unless given) to all training experiments together, after
    adding `effects` ("joint:stribeck"); parameters with sd = 0 stay fixed.

    Output error: simulated against measured outputs, in their noise sd (stated, else estimated), with priors, bounds,
    conditions and additions, and uncertain initial states as nuisances. A parameter on which no measured sample depends
    is held at its nominal value and listed (`not_informed`). `experiments`: names, instead of the training
    ones. `num_starts`: the first from the nominal values, the others drawn from the priors with `seed`; the best is
    kept. `tolerance`: relative error of a step of the simulation. Ctrl-C keeps the best so far, `converged` False.
    Raises DatasetError if a signal that the system needs was not measured, ParameterError for an unknown effect or a
    duplicate name, NumericalError if no start can be simulated. Source: S2 sec. 4."""
    require_dataset(dataset)
    if not isinstance(num_starts, Integral) or num_starts < 1:
        raise ParameterError(f"num_starts = {num_starts!r}: expected at least 1, a whole number")
    effects = _names("effects", effects)
    chosen = dataset.train if experiments is None else tuple(dataset[n] for n in _names("experiments", experiments))
    if not chosen:
        raise DatasetError(f"{dataset.name}: no training experiment; expected at least one with split = train")
    base = dataset.system() if system is None else system
    replay = choose_replay(dataset, base)
    ready = [prepare(e, base, replay) for e in chosen]
    noise = noise_sd(dataset, base, ready)
    problem = pose(dataset, base, chosen, ready, effects=effects, noise=noise, tolerance=tolerance)
    found, best = _solve(_starts(problem, num_starts, generator(seed)), progress=progress)
    return _result(dataset, best, found, ready, noise)


def _names(what: str, given: Sequence[str]) -> tuple[str, ...]:
    if isinstance(given, str):
        raise ParameterError(f"{what} = {given!r}: expected a list, such as [{given!r}]")
    twice = [name for k, name in enumerate(given) if name in given[:k]]
    if twice:
        raise ParameterError(f"{what}: duplicate {twice[0]!r}; expected each name once")
    return tuple(given)


def noise_sd(dataset: Dataset, system: System, experiments: Sequence[Prepared]) -> dict[str, float]:
    """Noise sd of each measured output, SI: as stated, else the records' white part, at least the resolution's."""
    found = {}
    for c, output in enumerate(system.info.outputs):
        spec = dataset.signals.get(output.name)
        records = [e.measured[c] for e in experiments if np.isfinite(e.measured[c]).any()]
        if spec is None or not records:
            continue
        least = max((spec.resolution or 0.0) / np.sqrt(12.0), 1e-6 * float(np.nanstd(np.concatenate(records))))
        seen = spec.noise_sd or float(np.median([white_noise_sd(r) for r in records]))
        found[output.name] = max(seen, least) or 1.0
    if not found:
        outputs = ", ".join(o.name for o in system.info.outputs)
        raise DatasetError(f"{dataset.name}: no output of {system.kind} was measured; expected one of {outputs}")
    return found


def pose(
    dataset: Dataset,
    system: System,
    chosen: Sequence[Experiment],
    ready: Sequence[Prepared],
    *,
    effects: Sequence[str],
    noise: dict[str, float],
    tolerance: float,
) -> Problem:
    """The fit of `system` with `effects` added to the experiments `chosen`, prepared as `ready`."""
    scales = priors.scales(system, ready)
    added = [name for name in effects if name not in system.effects]
    grown = system.with_effects({name: priors.start_of(system, name, scales) for name in added})
    free = priors.free_parameters(grown, dataset.parameters, scales, added=added)
    new = {name for effect in added for name in grown.info.effect(effect).parameters}
    started = [
        f.started(START_SHARE * f.scale) if f.name in new and grown.info.parameter(f.name).amplitude else f
        for f in free
    ]
    return Problem(
        system=grown,
        free=tuple(started),
        tasks=tuple(_task(e, p, grown, noise) for e, p in zip(chosen, ready, strict=True)),
        settings=_core.Settings(
            tolerance=tolerance,
            position_scale=min(e.position_scale for e in ready),
            velocity_scale=min(e.velocity_scale for e in ready),
        ),
        values=tuple(grown.values()),
    )


def _task(experiment: Experiment, ready: Prepared, system: System, noise: dict[str, float]) -> _core.Task:
    index = {p.name: i for i, p in enumerate(system.info.parameters)}
    measured = np.isfinite(ready.measured).any(axis=1)
    sd = [noise[o.name] if m else np.inf for o, m in zip(system.info.outputs, measured, strict=True)]
    own = set(system.parameters)
    return _core.Task(
        ready.core,
        _core.Whitening([[]] * len(sd), sd, ready.measured),
        fixed={index[n]: v for n, v in experiment.conditions.items() if n in own},  # other names are covariates
        added={index[n]: v for n, v in experiment.add.items() if n in own},
        initial=list(ready.initial),
        initial_sd=list(ready.initial_sd),
    )


def _starts(problem: Problem, num_starts: int, rng: np.random.Generator) -> list[Problem]:
    starts = [problem]
    for _ in range(num_starts - 1):
        values = list(problem.values)
        for f in problem.free:
            width = f.sd if np.isfinite(f.sd) else 1.0
            values[f.index] = min(max(f.value(f.mean + width * rng.normal()), f.lower), f.upper)
        starts.append(problem.at(values, ()))
    return starts


def _solve(starts: Sequence[Problem], *, progress: bool) -> tuple[dict[str, Any], Problem]:
    """The best of several fits, run in threads; the order of the starts decides ties, whatever finishes first."""
    cancel = _core.Cancel()
    with ThreadPoolExecutor(max_workers=min(len(starts), os.cpu_count() or 1)) as pool:
        jobs = [pool.submit(start.solve, cancel=cancel) for start in starts]
        try:
            for _ in tqdm(as_completed(jobs), total=len(jobs), desc="identify", unit="start", disable=not progress):
                pass
        except KeyboardInterrupt:
            cancel.set()
            for job in jobs:
                job.cancel()
    return _best(jobs, starts)


def _best(jobs: Sequence[Future[dict[str, Any]]], starts: Sequence[Problem]) -> tuple[dict[str, Any], Problem]:
    found: list[tuple[float, int, dict[str, Any], Problem]] = []
    failure: NumericalError | None = None
    for job, start in zip(jobs, starts, strict=True):
        if job.cancelled():
            continue
        try:
            result = job.result()
        except NumericalError as error:
            failure = failure or error
            continue
        found.append((result["cost"], len(found), result, start))
    if not found:
        raise failure or KeyboardInterrupt
    _, _, result, start = min(found, key=lambda one: one[:2])
    return result, start.at(result["values"], result["initial"])


def _result(
    dataset: Dataset, problem: Problem, found: dict[str, Any], ready: Sequence[Prepared], noise: dict[str, float]
) -> Identification:
    system = problem.system
    names = [f.name for f in problem.free]
    found, known = hold(problem, found)
    value = np.array([found["values"][f.index] for f in problem.free])
    believed = uncertainty(found, problem.free, known, ready, [o.name in noise for o in system.info.outputs])
    nominal = [dataset.parameters[n].value if n in dataset.parameters else 0.0 for n in names]
    table = pd.DataFrame(
        {
            "value": value,
            "nominal": nominal,
            "sd": believed.sd,
            "ci95_lower": believed.lower,
            "ci95_upper": believed.upper,
            "unit": [system.unit(n) for n in names],
            "at_bound": np.asarray(found["at_bound"]) & known,
            "informed": known,
        },
        index=pd.Index(names, name="parameter"),
    )
    return Identification(
        system=system.with_parameters(dict(zip(names, value.tolist(), strict=True))),
        parameters=table,
        correlations=pd.DataFrame(believed.correlations, index=names, columns=names),
        residuals={
            e.name: _residual_frame(e, r, system, noise) for e, r in zip(ready, found["residuals"], strict=True)
        },
        errors=_errors(ready, found["residuals"], system, noise),
        initial={
            e.name: {f"{kind} of axis {j}": v for (kind, j), v in zip(e.initial, z, strict=True)}
            for e, z in zip(ready, found["initial"], strict=True)
        },
        noise_sd=noise,
        cost=found["cost"],
        prior_cost=found["prior_cost"],
        converged=found["converged"],
        message=found["message"],
        num_iterations=found["iterations"],
        warnings=dataset.warnings,
        problem=problem.at(found["values"], found["initial"]),
    )


def _errors(
    ready: Sequence[Prepared], residuals: Sequence[np.ndarray], system: System, noise: dict[str, float]
) -> pd.DataFrame:
    """Rms error and spread of each output that was measured, in its unit."""
    frames = [_residual_frame(e, r, system, noise) for e, r in zip(ready, residuals, strict=True)]
    rows = {}
    for c, output in enumerate(system.info.outputs):
        if output.name not in noise:
            continue
        missed = np.concatenate([f[output.name].to_numpy() * noise[output.name] for f in frames if output.name in f])
        seen = [e.measured[c] for e in ready if np.isfinite(e.measured[c]).any()]
        moved = np.concatenate([y - np.nanmean(y) for y in seen])
        errors = [float(np.sqrt(np.nanmean(np.square(y)))) for y in (missed, moved)]
        rows[output.name] = (*errors, unit(output.dimension, system.axis))
    return pd.DataFrame.from_dict(rows, orient="index", columns=["rms_error", "spread", "unit"])


def _residual_frame(ready: Prepared, residual: np.ndarray, system: System, noise: dict[str, float]) -> pd.DataFrame:
    """Rows of the whitening go channel by channel over what was measured."""
    columns, row = {}, 0
    for c, output in enumerate(system.info.outputs):
        kept = np.isfinite(ready.measured[c])
        if output.name not in noise or not kept.any():
            continue
        values = np.full(len(kept), np.nan)
        values[kept] = residual[row : row + int(kept.sum())]
        columns[output.name], row = values, row + int(kept.sum())
    return pd.DataFrame(columns, index=pd.Index(ready.core.time, name="t"))

"""Simulations over a grid of parameters."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.errors import NumericalError, ParameterError
from tendonlab.progress import track
from tendonlab.simulation.catalog import unit
from tendonlab.simulation.prepare import as_experiment
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.system import System, require_system

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


def sweep(
    system: System,
    grid: Mapping[str, Sequence[float] | np.ndarray],
    *,
    experiment: Experiment | pd.DataFrame,
    tolerance: float = 1e-6,
    executor: Executor | None = None,
    progress: bool = True,
) -> xr.Dataset:
    """Simulate `experiment` at every point of `grid`: parameter name -> values, SI, shape (n,).

    Gives one variable per output, in its unit (attribute `unit`), with the grid's parameters in the order given and the
    time "t", s, as dimensions. The coordinate `message`, over the grid, is empty where the run went well; elsewhere it
    says what failed, or "interrupted" after Ctrl-C, and the outputs hold NaN: a bad point does not stop the others. The
    same call gives the same bits with every executor.
    `tolerance`: relative error of a step. `executor`: any concurrent.futures executor, which stays open; without one,
    one thread per processor (the core releases the interpreter).
    Raises ParameterError, before anything is simulated, for an unknown parameter, one that the experiment's conditions
    fix, a value outside its bounds or given twice, an axis without values, or anything but a System; DatasetError for
    a missing input; NumericalError where every point failed."""
    require_system(system)
    if not isinstance(grid, Mapping):
        raise ParameterError(f"grid is a {type(grid).__name__}: expected a mapping of parameter names to values")
    axes = {name: _axis(name, values) for name, values in grid.items()}
    time = as_experiment(experiment).time
    points = [
        dict(zip(axes, values, strict=True)) for values in itertools.product(*(v.tolist() for v in axes.values()))
    ]
    refuse_conditions(experiment, axes)
    systems = [system.with_parameters(point) for point in points]
    outputs = np.full((len(points), len(system.info.outputs), len(time)), np.nan)
    messages = ["interrupted"] * len(points)
    with _threads() if executor is None else _borrowed(executor) as pool:
        jobs = {pool.submit(_outputs, one, experiment, tolerance): place for place, one in enumerate(systems)}
        try:
            for job in track(as_completed(jobs), total=len(jobs), label="sweep", unit="run", shown=progress):
                messages[jobs[job]] = _record(job, outputs[jobs[job]])
        except BaseException as error:
            for job in jobs:
                job.cancel()
            if not isinstance(error, KeyboardInterrupt) or "" not in messages:
                raise
    if "" not in messages:
        raise NumericalError(f"none of {len(points)} points could be simulated; the first: {messages[0]}")
    return _dataset(system, axes, time, outputs, messages)


def refuse_conditions(experiment: Experiment | pd.DataFrame, names: Iterable[str]) -> None:
    """Raise ParameterError where one of `names` is a parameter that the experiment's conditions fix."""
    fixed = experiment.conditions if isinstance(experiment, Experiment) else {}
    for name in names:
        if name in fixed:
            reason = f"the conditions of the experiment fix it at {fixed[name]:g}"
            raise ParameterError(f"{name}: {reason}; expected another parameter, or the experiment's `data` alone")


def _axis(name: str, values: Sequence[float] | np.ndarray) -> np.ndarray:
    try:
        axis = np.asarray(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{name} = {values!r}: expected a list of numbers") from error
    if axis.ndim != 1 or axis.size == 0:
        raise ParameterError(f"{name} has shape {axis.shape}: expected a list of values, shape (n,), n > 0")
    found, times = np.unique(axis, return_counts=True)
    if (times > 1).any():
        raise ParameterError(f"{name}: duplicate {found[times > 1][0]:g}; expected each value once")
    return axis


@contextmanager
def _threads() -> Iterator[Executor]:
    pool = ThreadPoolExecutor(max_workers=os.cpu_count() or 1)
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


@contextmanager
def _borrowed(executor: Executor) -> Iterator[Executor]:
    yield executor


def _outputs(system: System, experiment: Experiment | pd.DataFrame, tolerance: float) -> np.ndarray:
    return system.simulate(experiment, tolerance=tolerance).outputs.to_numpy().T


def _record(job: Future[np.ndarray], into: np.ndarray) -> str:
    """Copy the outputs of a run; gives the message of a run that failed, or "". Raises errors that all runs share."""
    try:
        into[:] = job.result()
    except NumericalError as error:
        return str(error)
    return ""


def _dataset(
    system: System, axes: Mapping[str, np.ndarray], time: np.ndarray, outputs: np.ndarray, messages: Sequence[str]
) -> xr.Dataset:
    import xarray as xr

    shape = tuple(len(values) for values in axes.values())
    signals = system.info.outputs
    variables = {
        s.name: ((*axes, "t"), outputs[:, k].reshape(*shape, len(time)), {"unit": unit(s.dimension, system.axis)})
        for k, s in enumerate(signals)
    }
    coordinates = {name: (name, values, {"unit": system.unit(name)}) for name, values in axes.items()}
    reasons = (tuple(axes), np.array(messages, dtype=object).reshape(shape))
    return xr.Dataset(variables, coords={**coordinates, "t": ("t", time, {"unit": "s"}), "message": reasons})

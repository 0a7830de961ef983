"""Simulations at many points of the parameters."""

from __future__ import annotations

import os
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import closing
from dataclasses import replace
from itertools import chain, repeat
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from tendonlab.arguments import choice
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.progress import track
from tendonlab.simulation.prepare import as_experiment
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.system import System, require_system
from tendonlab.sweeping import sizes
from tendonlab.sweeping.chunk import Chunk, Keep, simulate_chunk, simulate_first
from tendonlab.sweeping.executors import Workers, workers_of
from tendonlab.sweeping.layout import Layout
from tendonlab.sweeping.points import points_of, require_allowed
from tendonlab.sweeping.reductions import Reduce, Reduction, reduction_of
from tendonlab.sweeping.result import dataset_of
from tendonlab.sweeping.run import Run, run_of
from tendonlab.sweeping.storage import INTERRUPTED, Memory, Place, Storage
from tendonlab.sweeping.stores import checked_out, create_store, missing_places, open_store
from tendonlab.threads import with_one_blas_thread

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client

DTYPES = ("float64", "float32")


@with_one_blas_thread  # around all tasks of this process, which limit threads and free them again in any order
def sweep(
    system: System,
    grid: Mapping[str, Sequence[float] | np.ndarray] | pd.DataFrame,
    *,
    experiment: Experiment | pd.DataFrame | Iterable[Experiment | pd.DataFrame],
    outputs: Sequence[str] | None = None,
    reduce: str | Reduce | None = None,
    dtype: str = "float64",
    tolerance: float = 1e-6,
    executor: Executor | Client | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: bool = True,
) -> xr.Dataset:
    """Simulate `experiment` at every point of `grid`: parameter name -> values, SI, shape (n,); or at every row of a
    table, a DataFrame with one column per parameter, such as a design (`tendonlab.sweeping.sobol`) or samples of a fit.

    Gives one variable per output, in its unit (attribute `unit`). Its dimensions are the grid's parameters in the order
    given, or "point" for a table, and the time "t", s. The coordinate `message` is empty where the run went well;
    elsewhere it says what failed, or "interrupted" after Ctrl-C, and the outputs hold NaN: a bad point does not stop
    the others. The same call gives the same bits with every executor, number of threads and size of tasks.

    `experiment`: one, or several (a list, a dataset), which puts the dimension "experiment" first. Where those differ
    in their sampling times, "sample" replaces "t", which becomes a coordinate, and shorter runs end in NaN.
    `outputs`: names of those to be kept; all by default. `reduce`: "rms", "mean", "min", "max", "peak" (of the
    magnitude) or "final" over time, or a function of a chunk of runs, shape (points, outputs, samples), that gives an
    array (points, ...) and treats each point by itself. `dtype`: "float32" stores half as much.
    `tolerance`: relative error of a step. `executor`: any concurrent.futures executor or a dask client, which stays
    open; without one, one thread per processor. A task simulates in one thread.
    `out`: a name ending in .zarr or .parquet. Chunks are stored there as they are done, and the same call resumes after
    Ctrl-C or a crash; the result is then read from there when it is used.
    Raises ParameterError, before anything is simulated, for an unknown parameter, one that an experiment's conditions
    fix, a value outside its bounds or given twice, an axis without values, or anything but a System; DatasetError for
    a missing input or a store of another sweep; NumericalError where every point failed."""
    require_system(system)
    target, reduction = checked_out(out), reduction_of(reduce)
    if reduction is not None and isinstance(executor, ProcessPoolExecutor):
        reduction.require_portable()
    layout = _layout(system, grid, experiment, outputs, reduction, dtype)
    channels = [[s.name for s in system.info.outputs].index(name) for name in layout.outputs]
    runs = [run_of(system, e, layout.points, channels=channels, tolerance=tolerance) for e in layout.experiments]
    with workers_of(executor) as workers:
        storage = _simulate(runs, layout, workers, target, tolerance, progress=progress)
    messages = storage.messages
    if not (messages == "").any():
        raise NumericalError(f"none of {messages.size} points could be simulated; the first: {messages.flat[0]}")
    return dataset_of(layout, storage.variables(), messages)


def _layout(
    system: System,
    grid: Any,
    experiment: Any,
    outputs: Sequence[str] | None,
    reduction: Reduction | None,
    dtype: str,
) -> Layout:
    """Every argument checked, and how the result lies."""
    points = points_of(grid)
    require_allowed(system, points)
    several = isinstance(experiment, Iterable) and not isinstance(experiment, Experiment | pd.DataFrame | str | Mapping)
    experiments = _experiments(experiment) if several else (as_experiment(experiment),)
    if reduction is not None:
        reduction.require_free_name(("message", "experiment", "point", "t", *points.names))
    keep = Keep(reduction, choice("dtype", dtype, DTYPES), max(len(e.data) for e in experiments))
    return Layout(system, points, experiments, several, _outputs(system, outputs), keep)


def _experiments(given: Iterable[Experiment | pd.DataFrame]) -> tuple[Experiment, ...]:
    """Several experiments; frames are named by their place. Raises ParameterError for none, or a name given twice."""
    found = []
    for k, one in enumerate(given):
        experiment = as_experiment(one)
        found.append(experiment if isinstance(one, Experiment) else replace(experiment, name=str(k)))
    names = [experiment.name for experiment in found]
    repeated = next((name for name in names if names.count(name) > 1), None)
    if repeated is not None:
        raise ParameterError(f"experiment: duplicate name {repeated!r}; expected each experiment once")
    if not found:
        raise ParameterError("experiment holds none: expected at least one experiment")
    return tuple(found)


def _outputs(system: System, given: Sequence[str] | None) -> tuple[str, ...]:
    known = [signal.name for signal in system.info.outputs]
    if given is None:
        return tuple(known)
    if isinstance(given, str) or not isinstance(given, Sequence) or not given:
        raise ParameterError(f"outputs = {given!r:.60}: expected a list of names, such as {known[:1]}")
    for k, name in enumerate(given):
        choice(f"outputs[{k}]", name, known)
    if len(set(given)) < len(given):
        raise ParameterError(f"outputs = {list(given)}: expected each name once")
    return tuple(given)


def _simulate(
    runs: Sequence[Run], layout: Layout, workers: Workers, out: Path | None, tolerance: float, *, progress: bool
) -> Storage:
    """All that is missing, into a storage. Ctrl-C ends it early where anything was done."""
    storage: Storage | None = None
    try:
        store = None if out is None else open_store(out, layout, tolerance)
        stored = 0 if store is None else _num_done(store)
        storage, size = (store, store.record.size) if store else _begun(runs, layout, workers, out, tolerance)
        tasks = missing_places(storage.messages, size)
        with closing(_chunks(runs, layout, workers, storage, tasks)) as chunks:
            steps = chain(repeat(None, _num_done(storage) - stored), _each_run(storage, chunks))
            total = storage.messages.size
            for _ in track(steps, total=total, done=stored, label="sweep", unit="run", shown=progress):
                pass
    except KeyboardInterrupt:
        if storage is None or (storage.messages == INTERRUPTED).all():
            raise
    return storage


def _begun(
    runs: Sequence[Run], layout: Layout, workers: Workers, out: Path | None, tolerance: float
) -> tuple[Storage, int]:
    """A new storage and the number of points of a chunk. The first points are simulated to learn how long one takes."""
    longest = int(np.argmax([run.num_samples for run in runs]))
    points = layout.points.values
    given = (runs[longest], points[: sizes.MOST_FIRST], layout.keep, sizes.FIRST_SECONDS)
    ((_, first),) = workers.map_unordered(["first"], lambda executor, _: executor.submit(simulate_first, *given))
    cell = first.kept.shape[1:]
    size = sizes.chunk_size(first, len(points) * len(runs), workers, on_disk=out is not None)
    if out is None:
        memory = Memory(layout, cell)
        memory.write(Place(longest, 0, len(first.messages)), first.kept, first.messages)
        return memory, size
    created = create_store(out, layout, tolerance, size=size, cell=cell)
    if size <= len(first.messages):
        created.write(Place(longest, 0, size), first.kept[:size], first.messages[:size])
    return created, size


def _chunks(
    runs: Sequence[Run], layout: Layout, workers: Workers, storage: Storage, places: Iterable[Place]
) -> Generator[tuple[Place, Chunk], None, None]:
    """Each chunk with its place, as they are done."""
    points = layout.points.values

    def submit(executor: Executor, place: Place) -> Future[Chunk]:
        rows = points[place.first : place.last]
        view = storage.view(place) if workers.shares_memory else None
        given = () if view is None else (view,)
        return executor.submit(simulate_chunk, runs[place.experiment], rows, layout.keep, *given)

    return workers.map_unordered(places, submit)


def _num_done(storage: Storage) -> int:
    return int((storage.messages != INTERRUPTED).sum())


def _each_run(storage: Storage, chunks: Iterable[tuple[Place, Chunk]]) -> Iterator[None]:
    """Stores each chunk; yields once for each run that is new."""
    for place, chunk in chunks:
        new = storage.messages[place.experiment, place.first : place.last] == INTERRUPTED
        storage.write(place, chunk.kept, chunk.messages)
        yield from (None for _ in range(int(new.sum())))

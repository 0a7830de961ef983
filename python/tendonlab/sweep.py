"""Simulations over a grid of parameters."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np
from tqdm import tqdm

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from tendonlab.data import Experiment
    from tendonlab.system import System


def sweep(
    system: System,
    grid: Mapping[str, Sequence[float]],
    *,
    experiment: Experiment | pd.DataFrame,
    tolerance: float = 1e-6,
    executor: Executor | None = None,
    progress: bool = True,
) -> xr.Dataset:
    """Simulate `experiment` at every point of `grid` (parameter name -> values): one variable an output, with the
    grid's parameters and time as dimensions.

    `executor`: any concurrent.futures executor (threads by default: the core releases the interpreter).
    Raises ParameterError for an unknown parameter or a value outside its bounds, before anything is simulated."""
    import xarray as xr

    axes = {name: np.asarray(values, dtype=float) for name, values in grid.items()}
    points = [dict(zip(axes, values, strict=True)) for values in itertools.product(*axes.values())]
    systems = [system.with_parameters(point) for point in points]
    own = ThreadPoolExecutor() if executor is None else None
    try:
        pool = own if executor is None and own is not None else executor
        assert pool is not None
        jobs = [pool.submit(_outputs, one, experiment, tolerance) for one in systems]
        runs = [job.result() for job in tqdm(jobs, desc="sweep", disable=not progress)]
    finally:
        if own is not None:
            own.shutdown(cancel_futures=True)
    time, names = runs[0].index.to_numpy(), list(runs[0].columns)
    shape = (*(len(v) for v in axes.values()), len(time))
    variables = {
        name: ((*axes, "t"), np.array([run[name].to_numpy() for run in runs]).reshape(shape)) for name in names
    }
    units = {name: system.unit(name) for name in axes}
    dataset = xr.Dataset(variables, coords={**axes, "t": time})
    for name, its_unit in units.items():
        dataset[name].attrs["unit"] = its_unit
    return dataset


def _outputs(system: System, experiment: Experiment | pd.DataFrame, tolerance: float) -> pd.DataFrame:
    return system.simulate(experiment, tolerance=tolerance).outputs

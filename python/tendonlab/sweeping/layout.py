"""How the results of a sweep lie: experiments, points, then what is kept of each run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tendonlab.simulation.catalog import unit
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.system import System
from tendonlab.sweeping.chunk import Keep
from tendonlab.sweeping.points import Points


@dataclass(frozen=True, eq=False)
class Layout:
    """`several`: whether the result has the dimension "experiment". `outputs`: names of those that are recorded."""

    system: System
    points: Points
    experiments: tuple[Experiment, ...]
    several: bool
    outputs: tuple[str, ...]
    keep: Keep

    @property
    def by_output(self) -> bool:
        """Whether the result has one variable per output; otherwise one that a function of the caller made."""
        return self.keep.reduction is None or self.keep.reduction.by_output

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the variables of the result."""
        if self.by_output or self.keep.reduction is None:
            return self.outputs
        return (self.keep.reduction.name,)

    @cached_property
    def one_time(self) -> bool:
        """Whether all experiments are sampled at the same instants."""
        first = self.experiments[0].time
        return all(np.array_equal(first, experiment.time) for experiment in self.experiments)

    def trailing(self, shape: tuple[int, ...]) -> tuple[str, ...]:
        """Dimensions of a variable behind those of the points, where one point has that `shape`."""
        if self.keep.reduction is None:
            return ("t",) if self.one_time else ("sample",)
        return tuple(f"{self.keep.reduction.name}_{k}" for k in range(len(shape)))

    def attributes(self, variable: str) -> dict[str, str]:
        """Unit of a variable, and the summary that it is."""
        given: dict[str, str] = {}
        if self.by_output:
            signal = next(s for s in self.system.info.outputs if s.name == variable)
            given["unit"] = unit(signal.dimension, self.system.axis)
        if self.keep.reduction is not None:
            given["reduce"] = self.keep.reduction.name
        return given

    def split(self, kept: Any) -> dict[str, Any]:
        """Variables of a chunk (points, ...), as views."""
        if self.by_output:
            return {name: kept[:, k] for k, name in enumerate(self.outputs)}
        return {self.variables[0]: kept}

    def times(self) -> np.ndarray:
        """Instants of each experiment, s, shape (experiments, samples), NaN behind the end of the shorter ones."""
        times = np.full((len(self.experiments), self.keep.length), np.nan)
        for row, experiment in zip(times, self.experiments, strict=True):
            row[: len(experiment.data)] = experiment.time
        return times

    def time_coordinate(self) -> Mapping[str, Any]:
        """The coordinate "t" of the result; none where samples are not kept."""
        if self.keep.reduction is not None:
            return {}
        if self.one_time:
            return {"t": ("t", self.experiments[0].time, {"unit": "s"})}
        return {"t": (("experiment", "sample"), self.times(), {"unit": "s"})}

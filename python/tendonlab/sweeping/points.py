"""The points of a sweep: a grid of values, or a table with one point per row."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from tendonlab.arguments import within
from tendonlab.errors import ParameterError
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.system import System


@dataclass(frozen=True, eq=False)
class Points:
    """`values`: shape (points, names). `sizes`: the dimensions of the result, in order, and their lengths. `axes`: the
    values along each dimension of a grid; empty for a table, whose columns run along "point"."""

    names: tuple[str, ...]
    values: np.ndarray
    sizes: Mapping[str, int]
    axes: Mapping[str, np.ndarray]

    def __len__(self) -> int:
        return len(self.values)

    @property
    def is_table(self) -> bool:
        """Whether each row was given as a point of its own."""
        return "point" in self.sizes

    def row_text(self, row: int) -> str:
        """What stands before a parameter in a message: the row of a table."""
        return f"row {row}: " if self.is_table else ""

    def coordinates(self) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
        """Dimensions and values of each coordinate of the result."""
        if not self.is_table:
            return {name: ((name,), axis) for name, axis in self.axes.items()}
        columns = {name: (("point",), self.values[:, k]) for k, name in enumerate(self.names)}
        return {"point": (("point",), np.arange(len(self))), **columns}


def points_of(given: Mapping[str, Sequence[float] | np.ndarray] | pd.DataFrame) -> Points:
    """The points of a grid or a table. Raises ParameterError for anything else, and for what holds no numbers."""
    if isinstance(given, pd.DataFrame):
        return _table(given)
    if not isinstance(given, Mapping):
        expected = "a mapping of parameter names to values, or a DataFrame with one point per row"
        raise ParameterError(f"grid is a {type(given).__name__}: expected {expected}")
    axes = {name: _axis(name, values) for name, values in given.items()}
    sizes = {name: len(axis) for name, axis in axes.items()}
    grids = np.meshgrid(*axes.values(), indexing="ij")
    num_points = int(np.prod(list(sizes.values()), dtype=int))
    values = np.column_stack([g.ravel() for g in grids]) if axes else np.empty((num_points, 0))
    return Points(tuple(axes), values, sizes, axes)


def _table(given: pd.DataFrame) -> Points:
    names = [str(name) for name in given.columns]
    repeated = next((name for name in names if names.count(name) > 1), None)
    if repeated is not None:
        raise ParameterError(f"grid: duplicate column {repeated!r}; expected each parameter once")
    if given.empty:
        raise ParameterError(f"grid has shape {given.shape}: expected a table with one point per row")
    for name, column in zip(names, given.columns, strict=True):
        if given[column].dtype.kind not in "iuf":
            raise ParameterError(f"grid: column {name!r} is of type {given[column].dtype}; expected numbers")
    values = given.to_numpy(dtype=float, na_value=np.nan)
    return Points(tuple(names), values, {"point": len(given)}, {})


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


def require_allowed(system: System, points: Points) -> None:
    """Raise ParameterError for a name that the system does not have or a value outside its bounds."""
    known = {p.name for p in system.info.parameters}
    for k, name in enumerate(points.names):
        if name in known:
            require_within(system, name, points.values[:, k], points)
    system.with_parameters(dict(zip(points.names, points.values[0].tolist(), strict=True)))


def require_within(system: System, name: str, column: np.ndarray, points: Points, *, because: str = "") -> None:
    """Raise ParameterError for the first value of a parameter, one per point, that is outside its bounds."""
    row = system.info.parameter(name)
    inside = np.isfinite(column) & (row.lower <= column) & (column <= row.upper)
    if not inside.all():
        worst = int(np.argmin(inside))
        label = f"{points.row_text(worst)}{name}{because}"
        within(label, float(column[worst]), row.lower, row.upper, system.unit(name))


def refuse_conditions(experiment: Experiment | Any, names: Iterable[str]) -> None:
    """Raise ParameterError where one of `names` is a parameter that the experiment's conditions fix."""
    fixed = experiment.conditions if isinstance(experiment, Experiment) else {}
    for name in names:
        if name in fixed:
            reason = f"the conditions of the experiment fix it at {fixed[name]:g}"
            raise ParameterError(f"{name}: {reason}; expected another parameter, or the experiment's `data` alone")

"""The conditions of an experiment: numbers by name, and the shape of a sheath as a file of markers."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tendonlab.catalog import SystemInfo
from tendonlab.data.read import MissingColumnError, read_columns
from tendonlab.data.schema import Table
from tendonlab.errors import DatasetError, ParameterError


def read_conditions(experiment: Table, *, folder: Path, info: SystemInfo) -> dict[str, float]:
    """The conditions as numbers. `shape`, where the system has a `wrap_angle`, names a file of marker coordinates
    `x,y[,z]`, m, in their order along the sheath, and stands for the wrap angle of the spline through them (S3 eq. 5).

    Raises DatasetError: no number, no such file, markers without a direction, shape and wrap angle together."""
    given = experiment.table("conditions", optional=True)
    has_shape = "shape" in given.values and any(p.name == "wrap_angle" for p in info.parameters)
    if not has_shape:
        return experiment.numbers("conditions")
    if "wrap_angle" in given.values:
        raise given.error("shape", "stands beside wrap_angle; expected one of them")
    numbers = {name: given.number(name) for name in given.values if name != "shape"}
    return {**numbers, "wrap_angle": _wrap_angle(given, folder)}


def _wrap_angle(given: Table, folder: Path) -> float:
    from tendonlab.procedures.markers import MarkerSpline  # loads scipy's splines, which few datasets need

    file = given.text("shape")
    try:
        columns = read_columns(folder / file, ["x", "y", "z"])
    except MissingColumnError as error:
        if error.column != "z":
            raise
        columns = read_columns(folder / file, ["x", "y"])
    try:
        return MarkerSpline(np.column_stack(list(columns.values.values()))).wrap_angle()
    except (DatasetError, ParameterError) as error:
        raise DatasetError(f"{file}: {error}") from error

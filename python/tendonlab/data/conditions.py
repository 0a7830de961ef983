"""The conditions of an experiment: numbers by name, and the shape of a sheath as a file of markers."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tendonlab.data.read import MissingColumnError, read_columns
from tendonlab.data.schema import Table
from tendonlab.errors import DatasetError, ParameterError
from tendonlab.simulation.catalog import SystemInfo

OF_SHAPE = ("wrap_angle", "curvature_skew")  # conditions that a shape gives


def read_conditions(experiment: Table, *, folder: Path, info: SystemInfo) -> dict[str, float]:
    """The conditions as numbers. `shape`, where the system has a `wrap_angle`, names a file of marker coordinates
    `x,y[,z]`, m, in their order from the drive to the load, and gives the wrap angle and the unevenness of the
    spline through them (S3 eq. 5); with `marker_sd`, m, the spline is smoothed by that noise.

    Raises DatasetError: no number, no such file, markers without a direction, a shape together with a value that it
    gives."""
    given = experiment.table("conditions", optional=True)
    has_shape = "shape" in given.values and any(p.name == "wrap_angle" for p in info.parameters)
    if not has_shape:
        return experiment.numbers("conditions")
    for name in OF_SHAPE:
        if name in given.values:
            raise given.error("shape", f"given together with {name}; expected one of them")
    numbers = {name: given.number(name) for name in given.values if name != "shape"}
    smoothing = given.number("marker_sd", 0.0, lower=0.0)
    return {**numbers, **_shape(folder, given.text("shape"), smoothing=smoothing)}


def _shape(folder: Path, file: str, *, smoothing: float) -> dict[str, float]:
    from tendonlab.procedures.markers import MarkerSpline  # loads scipy's splines, which few datasets need

    try:
        columns = read_columns(folder / file, ["x", "y", "z"])
    except MissingColumnError as error:
        if error.column != "z":
            raise
        columns = read_columns(folder / file, ["x", "y"])
    try:
        shape = MarkerSpline(np.column_stack(list(columns.values.values())), smoothing=smoothing).shape()
    except (DatasetError, ParameterError) as error:
        raise DatasetError(f"{file}: {error}") from error
    return {"wrap_angle": shape.wrap_angle, "curvature_skew": shape.skew}

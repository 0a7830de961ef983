"""The result of a sweep as an xarray.Dataset."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from tendonlab.sweeping.layout import Layout

if TYPE_CHECKING:
    import xarray as xr


def dataset_of(layout: Layout, variables: Mapping[str, Any], messages: np.ndarray) -> xr.Dataset:
    """`variables`: numpy or dask arrays, shape (experiments, points, ...); `messages`: (experiments, points)."""
    import xarray as xr

    sizes = layout.points.sizes
    leading = (("experiment",) if layout.several else ()) + tuple(sizes)
    shape = ((len(layout.experiments),) if layout.several else ()) + tuple(sizes.values())
    found = {}
    for name, values in variables.items():
        rest = values.shape[2:]
        found[name] = ((*leading, *layout.trailing(rest)), values.reshape((*shape, *rest)), layout.attributes(name))
    system = layout.system
    coordinates: dict[str, Any] = {
        name: (dims, values) if name == "point" else (dims, values, {"unit": system.unit(name)})
        for name, (dims, values) in layout.points.coordinates().items()
    }
    if layout.several:
        coordinates["experiment"] = ("experiment", [experiment.name for experiment in layout.experiments])
    coordinates |= layout.time_coordinate()
    return xr.Dataset(found, coords={**coordinates, "message": (leading, messages.reshape(shape))})

"""A sweep as a Zarr store, version 3: one array per output, one chunk per task."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tendonlab.sweeping.layout import Layout
from tendonlab.sweeping.record import Record, record_from
from tendonlab.sweeping.storage import INTERRUPTED, Place

RECORD = "tendonlab_sweep"  # the attribute that holds the record
LEADING = ("experiment", "point")


class ZarrStore:
    """The message of a point is written after its outputs: a chunk without messages was not completed."""

    def __init__(self, group: Any, layout: Layout, record: Record) -> None:
        self._group, self._layout = group, layout
        self.record = record
        self.messages = np.asarray(group["message"][:], dtype=object)

    @staticmethod
    def create(folder: Path, layout: Layout, record: Record) -> None:
        import zarr

        group = zarr.create_group(folder, zarr_format=3, attributes={RECORD: record.to_dict()})
        shape, chunks = (len(layout.experiments), len(layout.points)), (1, record.size)
        cell = record.cell[1:] if layout.by_output else record.cell
        for name in layout.variables:
            group.create_array(
                name,
                shape=(*shape, *cell),
                chunks=(*chunks, *cell),
                dtype=layout.keep.dtype,
                fill_value=np.nan,
                dimension_names=(*LEADING, *layout.trailing(cell)),
                attributes=layout.attributes(name),
            )
        group.create_array(
            "message", shape=shape, chunks=chunks, dtype=str, fill_value=INTERRUPTED, dimension_names=LEADING
        )
        for k, name in enumerate(layout.points.names):
            unit = {"unit": layout.system.unit(name)}
            column = np.ascontiguousarray(layout.points.values[:, k])
            group.create_array(name, data=column, dimension_names=("point",), attributes=unit)
        names = np.array([experiment.name for experiment in layout.experiments])
        group.create_array("experiment", data=names.astype("T"), dimension_names=("experiment",))
        if layout.keep.reduction is None:
            dimensions, time, attributes = layout.time_coordinate()["t"]
            along = (dimensions,) if isinstance(dimensions, str) else dimensions
            group.create_array("t", data=time, dimension_names=along, attributes=attributes)

    @classmethod
    def opened(cls, path: Path, layout: Layout) -> ZarrStore | None:
        import zarr

        try:
            group = zarr.open_group(path, mode="r+")
        except (FileNotFoundError, zarr.errors.GroupNotFoundError):
            return None
        given: Any = group.attrs.get(RECORD)
        return None if given is None else cls(group, layout, record_from(given))

    def view(self, place: Place) -> None:
        return None

    def write(self, place: Place, kept: np.ndarray, messages: list[str]) -> None:
        where = (place.experiment, slice(place.first, place.last))
        for name, values in self._layout.split(kept).items():
            self._group[name][where] = values
        self._group["message"][where] = np.array(messages, dtype=object)
        self.messages[where] = messages

    def variables(self) -> dict[str, Any]:
        import dask.array

        return {name: dask.array.from_zarr(self._group[name]) for name in self._layout.variables}

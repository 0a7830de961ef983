"""A sweep as a folder of Parquet files: one file per chunk, one row per point."""

from __future__ import annotations

import json
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from tendonlab.sweeping.layout import Layout
from tendonlab.sweeping.record import Record, record_from
from tendonlab.sweeping.storage import INTERRUPTED, Place

RECORD = "_sweep.json"  # readers of Parquet skip names that begin with "_"


class ParquetStore:
    """A row holds the name of the experiment, the number of the point, its parameters, its message, and each output: a
    number, or a list of samples. A file appears when it is whole."""

    def __init__(self, path: Path, layout: Layout, record: Record) -> None:
        self._path, self._layout = path, layout
        self.record = record
        self.messages = np.full((len(layout.experiments), len(layout.points)), INTERRUPTED, dtype=object)
        for e in range(len(layout.experiments)):
            for first in range(0, len(layout.points), record.size):
                file = self._file(e, first)
                if file.exists():
                    self.messages[e, first : first + record.size] = _read(file, "message").to_pylist()

    @staticmethod
    def create(folder: Path, layout: Layout, record: Record) -> None:
        times = (
            [] if layout.keep.reduction is not None else [experiment.time.tolist() for experiment in layout.experiments]
        )
        units = {name: layout.attributes(name) for name in layout.variables}
        units |= {name: {"unit": layout.system.unit(name)} for name in layout.points.names}
        names = [experiment.name for experiment in layout.experiments]
        given = {**record.to_dict(), "experiments": names, "attributes": units, "t": times}
        (folder / RECORD).write_text(json.dumps(given), encoding="utf-8")

    @classmethod
    def opened(cls, path: Path, layout: Layout) -> ParquetStore | None:
        file = path / RECORD
        return cls(path, layout, record_from(json.loads(file.read_text("utf-8")))) if file.is_file() else None

    def view(self, place: Place) -> None:
        return None

    def write(self, place: Place, kept: np.ndarray, messages: list[str]) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        points = self._layout.points
        columns: dict[str, Any] = {
            "experiment": [self._layout.experiments[place.experiment].name] * len(place),
            "point": np.arange(place.first, place.last),
            **{name: points.values[place.first : place.last, k] for k, name in enumerate(points.names)},
            "message": messages,
        }
        for name, values in self._layout.split(kept).items():
            flat = pa.array(np.ascontiguousarray(values).ravel())
            columns[name] = (
                flat if values.ndim == 1 else pa.FixedSizeListArray.from_arrays(flat, prod(values.shape[1:]))
            )
        file = self._file(place.experiment, place.first)
        partial = file.with_name(f".{file.name}.partial")
        pq.write_table(pa.table(columns), partial, compression="zstd")
        partial.replace(file)
        self.messages[place.experiment, place.first : place.last] = messages

    def variables(self) -> dict[str, Any]:
        import dask.array

        cell = self.record.cell[1:] if self._layout.by_output else self.record.cell
        found = {}
        for name in self._layout.variables:
            rows = [
                dask.array.concatenate([self._chunk(name, e, first, cell) for first in self._firsts()])
                for e in range(len(self._layout.experiments))
            ]
            found[name] = dask.array.stack(rows)
        return found

    def _chunk(self, name: str, e: int, first: int, cell: tuple[int, ...]) -> Any:
        import dask
        import dask.array

        shape = (min(self.record.size, len(self._layout.points) - first), *cell)
        dtype = self._layout.keep.dtype
        file = self._file(e, first)
        if not file.exists():
            return dask.array.full(shape, np.nan, dtype=dtype)
        read = dask.delayed(_values)(file, name, shape)
        return dask.array.from_delayed(read, shape, dtype=dtype)

    def _firsts(self) -> range:
        return range(0, len(self._layout.points), self.record.size)

    def _file(self, e: int, first: int) -> Path:
        return self._path / f"experiment-{e:03d}-point-{first:09d}.parquet"


def _read(file: Path, column: str) -> Any:
    import pyarrow.parquet as pq

    return pq.read_table(file, columns=[column], partitioning=None).column(column).combine_chunks()


def _values(file: Path, column: str, shape: tuple[int, ...]) -> np.ndarray:
    given = _read(file, column)
    flat = given.flatten() if len(shape) > 1 else given
    return np.asarray(flat.to_numpy(zero_copy_only=False)).reshape(shape)

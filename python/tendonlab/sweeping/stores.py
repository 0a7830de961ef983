"""A store on disk: which kind, what it holds already, and whether that belongs to this sweep."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from tendonlab.errors import DatasetError, ParameterError
from tendonlab.sweeping.fingerprint import fingerprint
from tendonlab.sweeping.layout import Layout
from tendonlab.sweeping.record import Record, Store
from tendonlab.sweeping.storage import INTERRUPTED, Place

NEEDS = {".zarr": ("zarr", "dask"), ".parquet": ("pyarrow", "dask")}


def checked_out(out: str | os.PathLike[str] | None) -> Path | None:
    """The path of a store. Raises ParameterError for a name that says no format, without the library it needs, and
    where a file has that name."""
    if out is None:
        return None
    path = Path(out)
    if path.suffix not in NEEDS:
        raise ParameterError(f"out = {str(out)!r}: expected a name that ends in .zarr or .parquet")
    missing = [name for name in NEEDS[path.suffix] if find_spec(name) is None]
    if missing:
        raise ParameterError(f"out = {str(out)!r}: needs {' and '.join(missing)}; pip install 'tendonlab[sweep]'")
    if not path.parent.is_dir():
        raise ParameterError(f"out = {str(out)!r}: no folder {str(path.parent)!r}; expected an existing one")
    if path.is_file():
        raise ParameterError(f"out = {str(out)!r} is a file: expected a new name, or the store of this sweep")
    return path


def open_store(path: Path, layout: Layout, tolerance: float) -> Store | None:
    """The store that an earlier call left at `path`; None where there is nothing. Raises DatasetError where something
    else is there, such as another sweep."""
    if not path.exists():
        return None
    store = _kind(path).opened(path, layout)
    if store is None:
        raise DatasetError(f"{path}: no store of a sweep; expected a new name, or the store of this sweep")
    ours = fingerprint(layout, tolerance)
    other = [part for part, digest in ours.items() if store.record.parts.get(part) != digest]
    if other:
        differs = f"belongs to another sweep (it differs in {' and '.join(other)})"
        raise DatasetError(f"{path}: {differs}; expected the same call, or a new name")
    return store


def create_store(path: Path, layout: Layout, tolerance: float, *, size: int, cell: tuple[int, ...]) -> Store:
    """A new store, without any chunk. It appears as a whole, so that none is ever found half made."""
    kind = _kind(path)
    with _appearing(path) as folder:
        kind.create(folder, layout, Record(size, cell, fingerprint(layout, tolerance)))
    store = kind.opened(path, layout)
    if store is None:
        raise DatasetError(f"{path}: vanished while the sweep began")
    return store


def missing_places(messages: np.ndarray, size: int) -> Iterator[Place]:
    """Chunks of `size` points of which any was not simulated."""
    for e, row in enumerate(messages == INTERRUPTED):
        for first in range(0, len(row), size):
            last = min(first + size, len(row))
            if row[first:last].any():
                yield Place(e, first, last)


def _kind(path: Path) -> type[Store]:
    if path.suffix == ".zarr":
        from tendonlab.sweeping.zarr_store import ZarrStore

        return ZarrStore
    from tendonlab.sweeping.parquet_store import ParquetStore

    return ParquetStore


@contextmanager
def _appearing(path: Path) -> Iterator[Path]:
    folder = path.with_name(f".{path.name}.{os.getpid()}")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    try:
        yield folder
        folder.rename(path)
    finally:
        shutil.rmtree(folder, ignore_errors=True)

"""Files to columns: CSV, Parquet, MAT, HDF5 and NPZ give the same thing, named arrays of equal length."""

from __future__ import annotations

import csv
import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tendonlab.errors import DatasetError, expected_one_of

if TYPE_CHECKING:
    import pandas as pd

_HDF5 = b"\x89HDF\r\n\x1a\n"  # how such a file begins
Reader = Callable[[Path, Sequence[str]], dict[str, np.ndarray]]


class MissingColumnError(DatasetError):
    """A file lacks a column that was asked for."""

    def __init__(self, file: str, column: str, available: Mapping[str, Any]) -> None:
        super().__init__(f"{file}, column {column!r}: is missing; {expected_one_of(column, available)}")
        self.column = column


@dataclass(frozen=True)
class Columns:
    """The columns of one file, float, each of shape (n,). `rows` are the numbers of the samples in messages: from line
    2 of a CSV on, below its header, and from 1 in files that have no lines."""

    file: str
    values: dict[str, np.ndarray]
    rows: np.ndarray

    def error(self, column: str, problem: str, *, sample: int | None = None) -> DatasetError:
        """The error to raise about `column`, at `sample` (from 0) if it is there."""
        row = "" if sample is None else f", row {self.rows[sample]}"
        return DatasetError(f"{self.file}{row}, column {column!r}: {problem}")

    def only(self, kept: np.ndarray) -> Columns:
        """The samples that are `kept`, a mask of shape (n,); messages name the rows of the file as before."""
        return Columns(self.file, {name: values[kept] for name, values in self.values.items()}, self.rows[kept])


def read_columns(path: Path, columns: Sequence[str]) -> Columns:
    """The named columns of a file, whose ending says what it is. Raises DatasetError: unreadable, missing column, not
    numeric, unequal lengths, no samples."""
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise DatasetError(f"{path.name}: unknown kind of file {path.suffix!r}; expected {', '.join(_READERS)}")
    if not path.is_file():
        raise DatasetError(f"{path}: no such file")
    read = reader(path, columns)
    first = next(iter(read))
    found = Columns(path.name, read, np.arange(len(read[first])) + (2 if reader is _read_csv else 1))
    for name, values in found.values.items():
        if len(values) != len(found.values[first]):
            raise found.error(name, f"{len(values)} samples; expected {len(found.values[first])} as in {first!r}")
        if np.isinf(values).any():
            raise found.error(name, "an infinite value; expected a number", sample=int(np.isinf(values).argmax()))
    return found


def _pick(file: str, available: Mapping[str, Any], columns: Sequence[str]) -> dict[str, np.ndarray]:
    for column in columns:
        if column not in available:
            raise MissingColumnError(file, column, available)
    return {column: _as_vector(file, column, available[column]) for column in columns}


def _as_vector(file: str, column: str, value: object) -> np.ndarray:
    array = np.asarray(value)
    if array.dtype.kind not in "biuf":
        raise DatasetError(f"{file}, column {column!r}: of type {array.dtype}; expected real numbers")
    if array.ndim == 0 or array.size not in (0, max(array.shape)):
        raise DatasetError(f"{file}, column {column!r}: of shape {array.shape}; expected (n,), (n, 1) or (1, n)")
    return array.reshape(-1).astype(float)


def _read_csv(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    import pandas as pd

    try:
        header, first_row = _csv_start(path)
        if not set(columns) <= set(header):
            _refuse_other_headers(path.name, header)
        for column in columns:
            if header.count(column) > 1:
                problem = f"{header.count(column)} columns of that name"
                raise DatasetError(f"{path.name}, row 1, column {column!r}: {problem}; expected one")
        frame = _csv_frame(path, len(header), first_row)
    except UnicodeDecodeError as error:
        raise DatasetError(f"{path.name}: byte {error.start} is not UTF-8; expected a UTF-8 file") from error
    except pd.errors.EmptyDataError:
        frame = pd.DataFrame(columns=range(len(header)), dtype=float)
    except (pd.errors.ParserError, csv.Error) as error:
        raise DatasetError(f"{path.name}: {error}; expected comma-separated values") from error
    frame.columns = pd.Index(header)
    numeric = {name: _csv_numbers(path.name, name, frame[name]) for name in columns if name in header}
    return _pick(path.name, {**dict.fromkeys(header), **numeric}, columns)


def _csv_start(path: Path) -> tuple[list[str], int]:
    """The names in the header, and how many values the row below it holds."""
    with path.open(encoding="utf-8-sig", newline="") as file:
        lines = csv.reader(file, skipinitialspace=True)
        header, first_row = next(lines, []), next(lines, [])
    if not header:
        raise DatasetError(f"{path.name}, row 1: is empty; expected a header with the names of the columns")
    return [name.strip() for name in header], len(first_row)


def _refuse_other_headers(file: str, header: Sequence[str]) -> None:
    """Raise DatasetError where a header that lacks a column is none of names between commas."""
    for separator, called in ((";", "semicolons"), ("\t", "tabs")):
        if len(header) == 1 and separator in header[0]:
            raise DatasetError(f"{file}, row 1: names are separated by {called}; expected commas, and decimal points")
    if header[0].startswith("#"):
        raise DatasetError(f"{file}, row 1: begins with #; expected the names of the columns, and no comment")
    if all(map(_is_number, header)):
        raise DatasetError(f"{file}, row 1: {header[0]!r} is a number; expected the names of the columns")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _csv_frame(path: Path, num_columns: int, first_row: int) -> pd.DataFrame:
    """The rows below the header. pandas fills up short rows and takes a long first row for an index; the values of each
    row are counted, which takes five times longer than reading them, only where that may have happened."""
    import pandas as pd

    try:
        frame = _parse_csv(path, num_columns)
        if first_row == num_columns and not frame[num_columns - 1].isna().any():
            return frame
    except pd.errors.ParserError:
        pass
    return _parse_csv(path, num_columns, num_rows=_count_rows(path, num_columns))


def _parse_csv(path: Path, num_columns: int, *, num_rows: int | None = None) -> pd.DataFrame:
    import pandas as pd

    return pd.read_csv(
        path,
        encoding="utf-8-sig",
        header=None,
        names=list(range(num_columns)),
        skiprows=1,
        nrows=num_rows,
        skip_blank_lines=False,  # so that a row in a message is the line of the file
        skipinitialspace=True,
        keep_default_na=False,
        na_values=["", "nan", "NaN", "NAN"],
        low_memory=False,
    )


def _count_rows(path: Path, num_columns: int) -> int:
    """Number of rows below the header without blank lines at the end. Raises DatasetError at a row that is too short or
    too long."""
    num_rows = 0
    with path.open(encoding="utf-8-sig", newline="") as file:
        lines = csv.reader(file, skipinitialspace=True)
        next(lines)
        for row, line in enumerate(lines, start=1):
            num_rows = row if line else num_rows
            if line and len(line) != num_columns:
                problem = f"{len(line)} values; expected {num_columns} as in the header"
                raise DatasetError(f"{path.name}, row {row + 1}: {problem}")
    return num_rows


def _csv_numbers(file: str, column: str, values: pd.Series[Any]) -> np.ndarray:
    """The column as floats; pandas leaves text in it where a value is no number."""
    import pandas as pd

    if values.dtype.kind in "biuf":
        return values.to_numpy(dtype=float)
    numbers = pd.to_numeric(values, errors="coerce")
    bad = (numbers.isna() & values.notna()).to_numpy()
    if bad.any():
        row = int(bad.argmax())
        raise DatasetError(f"{file}, row {row + 2}, column {column!r}: {str(values.iloc[row])!r}: expected a number")
    return numbers.to_numpy(dtype=float)


def _read_parquet(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    import pandas as pd

    _require(path, "pyarrow")
    try:
        frame = pd.read_parquet(path)
    except (OSError, ValueError) as error:  # pyarrow's own errors are both
        raise DatasetError(f"{path.name}: {error}; expected a Parquet file") from error
    if frame.index.name is not None:  # a time index that was written with its name is a column like the others
        frame = frame.reset_index()
    return _pick(path.name, {str(name): frame[name].to_numpy() for name in frame.columns}, columns)


def _read_mat(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    with path.open("rb") as file:
        start = file.read(520)
    if _HDF5 in (start[:8], start[512:]):  # version 7.3 is HDF5 behind 512 bytes of its own
        return _read_hdf5(path, columns)
    try:
        variables = loadmat(path, simplify_cells=True)
    except (MatReadError, ValueError, TypeError, OSError) as error:
        raise DatasetError(f"{path.name}: {error}; expected a MAT file") from error
    return _pick(path.name, _flatten(variables, ""), columns)


def _flatten(variables: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    """Variables by name, the fields of a struct as "struct.field"."""
    flat: dict[str, Any] = {}
    for name, value in variables.items():
        if isinstance(value, dict):
            flat |= _flatten(value, f"{prefix}{name}.")
        elif not name.startswith("__"):
            flat[prefix + name] = value
    return flat


def _read_hdf5(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    h5py = _require(path, "h5py")
    try:
        with h5py.File(path, "r") as file:
            found: dict[str, Any] = {}
            file.visititems(lambda name, item: found.__setitem__(name, item) if hasattr(item, "dtype") else None)
            return _pick(path.name, {name: _Lazy(item) for name, item in found.items()}, columns)
    except OSError as error:
        raise DatasetError(f"{path.name}: {error}; expected an HDF5 file") from error


@dataclass(frozen=True)
class _Lazy:
    """An array that is read from its file only where it was asked for."""

    item: Any

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.asarray(self.item[()], dtype=dtype)


def _read_npz(path: Path, columns: Sequence[str]) -> dict[str, np.ndarray]:
    import zipfile

    try:
        with np.load(path, allow_pickle=False) as archive:
            return _pick(path.name, archive, columns)
    except (OSError, ValueError, EOFError, AttributeError, TypeError, zipfile.BadZipFile) as error:
        if isinstance(error, DatasetError):
            raise
        raise DatasetError(f"{path.name}: {error}; expected an NPZ archive of plain arrays") from error


def _require(path: Path, package: str) -> Any:
    try:
        return importlib.import_module(package)
    except ImportError as error:
        raise DatasetError(
            f"{path.name}: reading {path.suffix} needs {package}; pip install tendonlab[files]"
        ) from error


_READERS: dict[str, Reader] = {
    ".csv": _read_csv,
    ".parquet": _read_parquet,
    ".mat": _read_mat,
    ".h5": _read_hdf5,
    ".hdf5": _read_hdf5,
    ".npz": _read_npz,
}

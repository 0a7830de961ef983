"""Typed reading of the tables of a dataset.toml: each getter checks one key and names file, key and value."""

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tendonlab.errors import DatasetError, expected_one_of

FORMAT = "tendonlab-dataset/1"
FILE = "dataset.toml"


@dataclass(frozen=True)
class Table:
    """One table of the file named `file`; `where` is its dotted key, empty at the top."""

    values: Mapping[str, object]
    where: str = ""
    file: str = FILE

    def error(self, key: str, problem: str) -> DatasetError:
        """The error to raise about `key` of this table."""
        return DatasetError(f"{self.file}, key {self._dotted(key)}: {problem}")

    def allow(self, keys: Sequence[str]) -> None:
        """Raise DatasetError at the first key that is not among `keys`."""
        for key in self.values:
            if key not in keys:
                raise self.error(key, f"unknown key; {expected_one_of(key, keys)}")

    def text(self, key: str, default: str | None = None) -> str:
        """A string that is not empty."""
        value = self._get(key, default, "a string")
        if not isinstance(value, str):
            raise self.error(key, f"{value!r}: expected a string")
        if not value.strip() and key in self.values and default != "":
            raise self.error(key, "an empty string: expected a name")
        return value

    def choice(self, key: str, options: Sequence[str], default: str | None = None) -> str:
        """One of `options`."""
        value = self.text(key, default)
        if value not in options:
            raise self.error(key, f"{value!r}: {expected_one_of(value, options)}")
        return value

    def number(
        self,
        key: str,
        default: float | None = None,
        *,
        lower: float = -math.inf,
        upper: float = math.inf,
        infinite: bool = False,
    ) -> float:
        """A number in [lower, upper], finite unless `infinite`."""
        value = self._get(key, default, "a number")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(key, f"{value!r}: expected a number")
        if math.isnan(value) or not (infinite or math.isfinite(value)):
            raise self.error(key, f"{value}: expected a finite number")
        if not lower <= value <= upper:
            raise self.error(key, f"{value:g}: expected a value in [{lower:g}, {upper:g}]")
        return float(value)

    def flag(self, key: str, default: bool) -> bool:
        """true or false."""
        value = self.values.get(key, default)
        if not isinstance(value, bool):
            raise self.error(key, f"{value!r}: expected true or false")
        return value

    def texts(self, key: str) -> tuple[str, ...]:
        """An array of strings without duplicates."""
        value = self._get(key, None, "an array of strings")
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise self.error(key, f"{value!r}: expected an array of strings")
        for index, item in enumerate(value):
            if item in value[:index]:
                raise self.error(key, f"duplicate {item!r}; expected each name once")
        return tuple(value)

    def numbers(self, key: str) -> dict[str, float]:
        """A table of finite numbers; empty where absent."""
        table = self.table(key, optional=True)
        return {name: table.number(name) for name in table.values}

    def table(self, key: str, *, optional: bool = False) -> "Table":
        """The table under `key`; an empty one where it is absent and `optional`."""
        value = self._get(key, {} if optional else None, "a table")
        if not isinstance(value, dict):
            raise self.error(key, f"{value!r}: expected a table")
        return Table(value, self._dotted(key), self.file)

    def tables(self, key: str) -> list["Table"]:
        """The array of tables under `key`, at least one."""
        value = self._get(key, None, f"[[{key}]] tables")
        if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
            raise self.error(key, f"expected [[{key}]] tables, got {type(value).__name__}")
        if not value:
            raise self.error(key, f"is empty; expected at least one [[{key}]] table")
        return [Table(item, f"{self._dotted(key)}[{index}]", self.file) for index, item in enumerate(value)]

    def _get(self, key: str, default: object, expected: str) -> object:
        value = self.values.get(key, default)
        if value is None:
            raise self.error(key, f"is missing; expected {expected}")
        return value

    def _dotted(self, key: str) -> str:
        return f"{self.where}.{key}" if self.where else key


def read_toml(folder: Path) -> Table:
    """The top table of `folder`/dataset.toml; raises DatasetError where it is absent, malformed or foreign."""
    path = folder / FILE
    if not path.is_file():
        raise DatasetError(f"{path}: no such file; a dataset is a folder with a {FILE}")
    try:
        top = Table(tomllib.loads(path.read_text(encoding="utf-8")))
    except UnicodeDecodeError as error:
        raise DatasetError(f"{FILE}: byte {error.start} is not UTF-8; expected a UTF-8 file") from error
    except tomllib.TOMLDecodeError as error:
        raise DatasetError(f"{FILE}: {error}; expected TOML") from error
    top.allow(("format", "name", "description", "time", "system", "controller", "signals", "experiments"))
    if top.text("format") != FORMAT:
        raise top.error("format", f"{top.text('format')!r}: expected {FORMAT!r}")
    return top

"""The command `sweep`: its points from the command line, and a summary of what they gave."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.cli.text import table
from tendonlab.errors import DatasetError, ParameterError
from tendonlab.report.numbers import counted
from tendonlab.sweeping.storage import INTERRUPTED

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


def grid_from(texts: Sequence[str]) -> dict[str, np.ndarray]:
    """A grid from "name=1,2,3" or "name=first:last:number". Raises ParameterError for any other text, and for a name
    given twice."""
    grid: dict[str, np.ndarray] = {}
    for text in texts:
        name, _, values = text.partition("=")
        if name in grid:
            raise ParameterError(f"--grid {text}: duplicate name {name!r}; expected each parameter once")
        grid[name] = _axis(text, values)
    return grid


def _axis(text: str, values: str) -> np.ndarray:
    try:
        if ":" not in values:
            return np.array([float(value) for value in values.split(",")])
        first, last, number = values.split(":")
        return np.linspace(float(first), float(last), int(number))
    except ValueError:
        expected = "NAME=VALUE,VALUE,... or NAME=FIRST:LAST:NUMBER, such as joint_coulomb=0.03:0.06:5"
        raise ParameterError(f"--grid {text}: expected {expected}") from None


def table_from(file: Path) -> pd.DataFrame:
    """The table of points in a CSV file. Raises DatasetError where there is none."""
    import pandas as pd

    if not file.is_file():
        problem = "is a folder" if file.is_dir() else "no such file"
        raise DatasetError(f"{file}: {problem}; expected a CSV with one column per parameter")
    try:
        return pd.read_csv(file)
    except ValueError as error:
        raise DatasetError(f"{file}: expected a table with one column per parameter; {error}") from error


def sweep_text(swept: xr.Dataset) -> str:
    """How many runs went well, why others failed, and the range of each variable."""
    messages = swept["message"].to_numpy().ravel()
    failed = [str(m) for m in messages if m not in ("", INTERRUPTED)]
    num_left = int((messages == INTERRUPTED).sum())
    head = f"{counted(messages.size, 'run')}, {len(failed)} failed{f', {num_left} interrupted' if num_left else ''}"
    lines = [head, *(f"  {text}" for text in sorted(set(failed))[:5])]
    rows = [["", "smallest", "largest", "unit"]]
    for name, values in swept.data_vars.items():
        ends = (f"{float(values.min()):.6g}", f"{float(values.max()):.6g}")
        rows.append([str(name), *ends, str(values.attrs.get("unit", ""))])
    return "\n".join([*lines, "", table(rows, right=(1, 2))])


def kept_text(swept: xr.Dataset, out: str | None) -> str:
    """What is left of a sweep that was interrupted, and how to go on; "" after a whole one."""
    messages = swept["message"].to_numpy()
    num_done = int((messages != INTERRUPTED).sum())
    if num_done == messages.size:
        return ""
    if out is None:
        return f"{num_done} of {counted(messages.size, 'run')} done, none stored: --out FOLDER stores them"
    return f"{num_done} of {counted(messages.size, 'run')} stored in {out}; the same command does the rest"

"""The [[experiments]] tables and their files: one frame of SI columns by time for each."""

from __future__ import annotations

import posixpath
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.data.conditions import read_conditions
from tendonlab.data.parameters import find_parameter, require_within
from tendonlab.data.read import Columns, MissingColumnError, read_columns
from tendonlab.data.schema import Table
from tendonlab.data.split import choose_test
from tendonlab.data.units import convert, require_dimension
from tendonlab.errors import DatasetError, expected_one_of
from tendonlab.simulation.catalog import SystemInfo
from tendonlab.simulation.records import Experiment, NominalParameter, SignalSpec

if TYPE_CHECKING:
    import pandas as pd

KEYS = ("name", "file", "split", "repeat", "start", "conditions", "add", "initial")
MOST_REPEATED = 0.05  # share of the time stamps that may repeat the one before
MAX_MISSING = 5  # input samples in a row that are interpolated over


@dataclass(frozen=True)
class Context:
    """What the experiments have in common."""

    folder: Path
    info: SystemInfo
    nominal_effects: tuple[str, ...]
    parameters: Mapping[str, NominalParameter]
    signals: Mapping[str, SignalSpec]
    time_column: str
    time_unit: str
    time_stated: bool


def read_time(top: Table) -> tuple[str, str]:
    """Column and unit of the time."""
    table = top.table("time", optional=True)
    table.allow(("column", "unit"))
    column, unit = table.text("column", "t"), table.text("unit", "s")
    try:
        require_dimension(unit, "s")
    except DatasetError as error:
        raise table.error("unit", str(error)) from error
    return column, unit


def read_experiments(top: Table, context: Context) -> tuple[Experiment, ...]:
    """Every experiment with its samples, split into train and test. Raises DatasetError at the first violation."""
    tables = top.tables("experiments")
    _check_names_and_files(tables)
    splits = _splits(tables)
    return tuple(_read_experiment(table, split, context) for table, split in zip(tables, splits, strict=True))


def _check_names_and_files(tables: list[Table]) -> None:
    """Raise DatasetError unless every experiment has a name and a data file of its own, in the folder."""
    names: list[str] = []
    owners: dict[str, str] = {}
    for table in tables:
        table.allow(KEYS)
        name, file = table.text("name"), posixpath.normpath(table.text("file"))
        if name in names:
            raise table.error("name", f"duplicate experiment name {name!r}")
        if Path(file).is_absolute() or file.startswith(".."):
            raise table.error("file", f"{table.text('file')!r} is outside the dataset; expected a file in its folder")
        if file in owners:
            raise table.error("file", f"{file!r} is the file of {owners[file]!r} too; expected one file per experiment")
        names.append(name)
        owners[file] = name


def split_is_given(top: Table) -> bool:
    """Whether the file says what is held out."""
    return any("split" in table.values for table in top.tables("experiments"))


def _splits(tables: list[Table]) -> list[str]:
    given = [table for table in tables if "split" in table.values]
    if not given:
        labels = [table.text("repeat") if "repeat" in table.values else None for table in tables]
        test = choose_test(labels)
        return ["test" if index in test else "train" for index in range(len(tables))]
    for table in tables:
        if table not in given:
            raise table.error("split", "is missing while other experiments have it; expected it in all or in none")
    splits = [table.choice("split", ("train", "test")) for table in tables]
    if "train" not in splits:
        raise tables[0].error("split", "every experiment is 'test'; expected 'train' in at least one")
    return splits


def _read_experiment(table: Table, split: str, context: Context) -> Experiment:
    fixed = read_conditions(table, folder=context.folder, info=context.info)
    known = {
        parameter.name
        for parameter in context.info.parameters
        if parameter.name in context.parameters or parameter.purpose != "condition"  # of a law that is not there
    }
    _check_values(table.table("conditions", optional=True), {k: v for k, v in fixed.items() if k in known}, context)
    add = table.numbers("add")
    _check_additions(table.table("add", optional=True), add, context)
    initial = table.numbers("initial")
    _check_initial(table.table("initial", optional=True), initial, context.info)
    logged = _read_frame(table.text("file"), context)
    is_new = np.diff(logged.index.to_numpy(), prepend=-np.inf) > 0  # of samples with one stamp the first counts
    return Experiment(
        holds={signal: spec.hold for signal, spec in context.signals.items()},
        name=table.text("name"),
        split=split,
        conditions=fixed,
        add=add,
        initial=initial,
        repeat=table.text("repeat") if "repeat" in table.values else None,
        start=table.number("start") if "start" in table.values else None,
        data=logged[is_new],
        num_repeated=int(np.sum(~is_new)),
    )


def _check_values(table: Table, values: Mapping[str, float], context: Context) -> None:
    for name, value in values.items():
        find_parameter(table, name, info=context.info, nominal_effects=context.nominal_effects)
        given = context.parameters[name]
        require_within(table, name, value, lower=given.lower, upper=given.upper)


def _check_additions(table: Table, additions: Mapping[str, float], context: Context) -> None:
    for name, addition in additions.items():
        own = find_parameter(table, name, info=context.info, nominal_effects=context.nominal_effects)
        # the user's own bounds hold for the bare parameter, the physical ones for the sum
        require_within(table, name, context.parameters[name].value + addition, lower=own.lower, upper=own.upper)


def _check_initial(table: Table, initial: Mapping[str, float], info: SystemInfo) -> None:
    angles = [signal.name for signal in info.outputs if signal.dimension in ("displacement", "flow")]
    held = [signal.name for signal in info.outputs if signal.held]
    states = list(dict.fromkeys([*angles, *(name.replace("_angle", "_velocity") for name in angles), *held]))
    for name in initial:
        if name not in states:
            raise table.error(name, f"{name!r} is no state of {info.kind}; {expected_one_of(name, states)}")


def _read_frame(file: str, context: Context) -> pd.DataFrame:
    import pandas as pd

    signals = list(dict.fromkeys(spec.column for spec in context.signals.values()))
    try:
        columns = read_columns(context.folder / file, list(dict.fromkeys([context.time_column, *signals])))
        time = _read_time_samples(columns, context)
    except MissingColumnError as error:
        if error.column != context.time_column or context.time_stated or not context.info.steady:
            raise
        columns = read_columns(context.folder / file, signals)  # steady points: a row has a number, no instant
        time = np.arange(len(columns.values[signals[0]]), dtype=float)
    empty = np.all([np.isnan(columns.values[name]) for name in signals], axis=0)
    if not empty.all():  # a row that holds nothing is as good as none
        columns, time = columns.only(~empty), time[~empty]
    samples = {name: _read_samples(columns, spec, time) for name, spec in context.signals.items()}
    return pd.DataFrame(samples, index=pd.Index(time, name="t"))


def _read_time_samples(columns: Columns, context: Context) -> np.ndarray:
    """The time in s, shape (n,), nowhere falling."""
    name = context.time_column
    raw = columns.values[name]
    if len(raw) < 2:
        raise DatasetError(f"{columns.file}: {len(raw)} samples; expected at least 2")
    if np.isnan(raw).any():
        raise columns.error(name, "no time; expected a number", sample=int(np.isnan(raw).argmax()))
    time = convert(raw, unit=context.time_unit, to="s")
    backwards = np.diff(time) < 0
    if backwards.any():
        sample = int(backwards.argmax()) + 1
        problem = f"time runs back ({time[sample]:.9g} s after {time[sample - 1]:.9g} s); time must increase"
        raise columns.error(name, problem, sample=sample)
    repeated = np.diff(time) == 0
    if np.mean(repeated) > MOST_REPEATED:
        sample = int(repeated.argmax()) + 1
        problem = f"{100 * np.mean(repeated):.0f} % of the stamps repeat the one before; time must increase"
        raise columns.error(name, problem, sample=sample)
    return time


def _read_samples(columns: Columns, spec: SignalSpec, time: np.ndarray) -> np.ndarray:
    """A signal in its SI unit, shape (n,); inputs are free of NaN."""
    raw = columns.values[spec.column]
    if np.isnan(raw).all():
        raise columns.error(spec.column, f"every sample is missing; expected numbers for {spec.name}")
    if spec.role in ("input", "reference", "disturbance"):
        raw = _fill(raw, columns, spec, time)
    return convert(raw, unit=spec.unit, to=spec.si_unit)


def _fill(raw: np.ndarray, columns: Columns, spec: SignalSpec, time: np.ndarray) -> np.ndarray:
    """`raw` with runs of at most `MAX_MISSING` missing samples interpolated in time."""
    missing = np.isnan(raw)
    if not missing.any():
        return raw
    starts = np.flatnonzero(missing & ~np.r_[False, missing[:-1]])
    ends = np.flatnonzero(missing & ~np.r_[missing[1:], False])
    for start, end in zip(starts, ends, strict=True):
        if start == 0 or end == len(raw) - 1:
            problem = f"{spec.name} is missing at the {'start' if start == 0 else 'end'} of the record"
            raise columns.error(spec.column, f"{problem}; expected a number to interpolate from", sample=int(start))
        if end - start >= MAX_MISSING:
            problem = f"{end - start + 1} samples of {spec.name} are missing in a row"
            raise columns.error(
                spec.column, f"{problem}; expected at most {MAX_MISSING} of an input", sample=int(start)
            )
    return np.where(missing, np.interp(time, time[~missing], raw[~missing]), raw)

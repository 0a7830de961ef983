"""Experiments that are not made yet, from a plan file (docs/rehearsal.md)."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from tendonlab.data import Dataset, Experiment, load
from tendonlab.data.controller import check_controller, read_controller
from tendonlab.data.parameters import read_nominal_effects, read_parameters, read_system
from tendonlab.data.read import read_columns
from tendonlab.data.schema import Table, read_toml
from tendonlab.data.signals import read_signals
from tendonlab.data.split import choose_test
from tendonlab.data.units import convert
from tendonlab.errors import DatasetError, expected_one_of
from tendonlab.rehearsal.shapes import SHAPES, planned_path
from tendonlab.report.numbers import number, unit_text
from tendonlab.report.words import listing
from tendonlab.simulation.records import SignalSpec

FORMAT = "tendonlab-plan/1"
TOP_KEYS = ("format", "rate", "experiments")
KEYS = ("name", "file", "signal", "shape", "duration", "rate", "split", "repeat", "conditions", "add")
OF_SHAPE = ("amplitude", "offset", "frequencies", "speed", "hold")


def rig_without_logs(folder: Path) -> Dataset:
    """The dataset in `folder` with its logs where it lists any, else without experiments. Raises DatasetError."""
    top = read_toml(folder)
    if "experiments" in top.values:
        return load(folder)
    info, axis = read_system(top)
    effects = read_nominal_effects(top, info)
    controller = read_controller(top)
    signals = read_signals(top, info, axis=axis, controller=controller)
    check_controller(top, signals=signals, info=info)
    return Dataset(
        name=top.text("name"),
        description=top.text("description", ""),
        kind=info.kind,
        axis=axis,
        nominal_effects=effects,
        parameters=read_parameters(top, info, nominal_effects=effects),
        controller=controller,
        signals=signals,
        experiments=(),
        path=folder,
    )


def planned_experiments(file: Path, rig: Dataset) -> tuple[Experiment, ...]:
    """The experiments that the plan `file` lists, for the system, controller and signals of `rig`. Raises DatasetError,
    which names file and key."""
    top = _read(file)
    tables = top.tables("experiments")
    names = [table.text("name") for table in tables]
    for k, name in enumerate(names):
        if name in names[:k]:
            raise tables[k].error("name", f"duplicate experiment name {name!r}")
    splits = _splits(tables)
    made = tuple(_experiment(top, table, split, rig, file) for table, split in zip(tables, splits, strict=True))
    driving = [_driving(tables[0], rig), *followed(made, rig)]
    given = [e.data[name].to_numpy(dtype=float) for e in made for name in driving if name in e.data.columns]
    if all(float(np.ptp(values)) == 0.0 for values in given):
        raise top.error("experiments", f"{driving[-1]} is constant in all of them; expected it to vary")
    return made


def followed(planned: Sequence[Experiment], rig: Dataset) -> list[str]:
    """The outputs that planned experiments ask a rig without a stated controller to follow."""
    asked = {} if rig.controller else {n: None for e in planned for n in rig.outputs if n in e.data.columns}
    return list(asked)


def still_notes(planned: Sequence[Experiment], rig: Dataset) -> Iterator[str]:
    """A note for each planned experiment whose inputs and references never change."""
    driving = [name for name, spec in rig.signals.items() if spec.role in ("input", "reference", "disturbance")]
    driving += followed(planned, rig)
    for experiment in planned:
        given = {name: experiment.data[name] for name in driving if name in experiment.data.columns}
        if all((values == values.iloc[0]).all() for values in given.values()):
            held = [f"{n} = {number(v.iloc[0])} {unit_text(rig.signals[n].si_unit)}".rstrip() for n, v in given.items()]
            yield f"The planned experiment {experiment.name} never moves: {listing(held)} throughout."


def _read(file: Path) -> Table:
    if not file.is_file():
        raise DatasetError(f"{file}: no such file; expected a plan of experiments in TOML")
    try:
        top = Table(tomllib.loads(file.read_text(encoding="utf-8")), file=file.name)
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise DatasetError(f"{file.name}: {error}; expected TOML in UTF-8") from error
    top.allow(TOP_KEYS)
    if top.text("format") != FORMAT:
        raise top.error("format", f"{top.text('format')!r}: expected {FORMAT!r}")
    return top


def _splits(tables: list[Table]) -> list[str]:
    """As stated, in all or in none; else about 30 % are held out, as in a dataset."""
    given = [table for table in tables if "split" in table.values]
    if given and len(given) < len(tables):
        lacking = next(table for table in tables if table not in given)
        raise lacking.error("split", "is missing while other experiments have it; expected it in all or in none")
    if given:
        return [table.choice("split", ("train", "test")) for table in tables]
    test = choose_test([table.text("repeat") if "repeat" in table.values else None for table in tables])
    return ["test" if k in test else "train" for k in range(len(tables))]


def _experiment(top: Table, table: Table, split: str, rig: Dataset, plan: Path) -> Experiment:
    table.allow((*KEYS, *OF_SHAPE))
    frame = _from_file(table, rig, plan) if "file" in table.values else _from_shape(top, table, rig)
    if rig.controller is not None and rig.controller.reference in frame.columns:  # the rig starts there, at rest
        frame[rig.controller.measured] = float(frame[rig.controller.reference].iloc[0])
    required = _required(rig)
    for name in required:
        if name not in frame.columns:
            raise table.error("file" if len(required) > 1 else "signal", _lacking(name, required, rig))
    add, conditions = table.numbers("add"), table.numbers("conditions")
    for key, given in (("add", add), ("conditions", conditions)):
        for name in given:
            if name not in rig.parameters:
                problem = f"{name!r} is no parameter of the simulator; {expected_one_of(name, rig.parameters)}"
                raise table.table(key).error(name, problem)
    return Experiment(
        name=table.text("name"),
        data=frame,
        split=split,
        repeat=table.text("repeat") if "repeat" in table.values else None,
        conditions=conditions,
        add=add,
        holds={name: spec.hold for name, spec in rig.signals.items()},
    )


def _from_shape(top: Table, table: Table, rig: Dataset) -> pd.DataFrame:
    shape = table.choice("shape", tuple(SHAPES))
    unused = [key for key in OF_SHAPE if key in table.values and key not in SHAPES[shape]]
    if unused:
        raise table.error(unused[0], f"means nothing for {shape}; expected {', '.join(SHAPES[shape])}")
    rate = table.number("rate", lower=1e-3) if "rate" in table.values else top.number("rate", lower=1e-3)
    duration = table.number("duration", lower=2.0 / rate)
    time = np.arange(round(duration * rate) + 1) / rate
    return pd.DataFrame({_driving(table, rig): planned_path(shape, table, time)}, index=pd.Index(time, name="t"))


def _from_file(table: Table, rig: Dataset, plan: Path) -> pd.DataFrame:
    """Inputs and references of a CSV next to the plan: columns and units as dataset.toml has them, time "t" in s. In
    place of the command it may hold the output that the rig is to follow, as proposed experiments do."""
    for key in ("shape", "signal", *OF_SHAPE):
        if key in table.values:
            raise table.error(key, "given together with file; expected one of them")
    file = plan.parent / table.text("file")
    if not file.is_file():
        raise table.error("file", f"{table.text('file')!r}: no such file next to {plan.name}")
    names = list(dict.fromkeys((*_required(rig), *_optional(rig, file))))
    path = _path(rig, file)
    wanted = [rig.signals[name] for name in names if path is None or name != path[1]] + ([path[0]] if path else [])
    columns = read_columns(file, ["t", *(spec.column for spec in wanted)])
    time = columns.values["t"]
    if not np.isfinite(time).all() or (np.diff(time) <= 0).any():
        raise DatasetError(f"{file.name}: column 't': expected seconds that increase")
    data = {s.name: convert(columns.values[s.column], unit=s.unit, to=s.si_unit) for s in wanted}
    for name, values in data.items():
        if not np.isfinite(values).all():
            row = int(np.flatnonzero(~np.isfinite(values))[0]) + 2
            raise DatasetError(f"{file.name}, row {row}: {name} is no finite number; a plan has no gaps")
    frame = pd.DataFrame(data, index=pd.Index(time, name="t"))
    return frame if path is None else frame.assign(**{path[1]: 0.0})


def _path(rig: Dataset, file: Path) -> tuple[SignalSpec, str] | None:
    """The output that a file asks the rig to follow, and the command that it leaves open; None where it has a command,
    or a controller makes that."""
    command, columns = rig.system().info.command, _columns(file)
    if rig.controller is not None or command is None or command.name not in rig.signals:
        return None
    moved = [output.name for output in rig.system().info.outputs if output.axis == 0]  # what a loop may hold
    asked = [rig.signals[name] for name in moved if name in rig.outputs and rig.signals[name].column in columns]
    return (asked[0], command.name) if asked and rig.signals[command.name].column not in columns else None


def _driving(table: Table, rig: Dataset) -> str:
    """The signal that a shape moves: the reference of the controller, else the first required input, unless stated."""
    required = _required(rig)
    if "signal" not in table.values:
        return required[0]
    known = [name for name, spec in rig.signals.items() if spec.role in ("input", "reference", "disturbance")]
    return table.choice("signal", known)


def _required(rig: Dataset) -> list[str]:
    """Signals without which the rig is not driven."""
    if rig.controller is not None:
        info = rig.system().info
        command = None if info.command is None else info.command.name
        others = [s.name for s in info.inputs if s.required and s.name != command]
        disturbance = rig.controller.disturbance
        return [rig.controller.reference, *([disturbance] if disturbance else []), *others]
    return [s.name for s in rig.system().info.inputs if s.required and s.name in rig.signals]


def _optional(rig: Dataset, file: Path) -> list[str]:
    """Further inputs of which the file has a column."""
    columns = _columns(file)
    inputs = [s for s in rig.signals.values() if s.role == "input" and s.name not in _made(rig)]
    return [s.name for s in inputs if s.column in columns]


def _columns(file: Path) -> list[str]:
    return [name.strip() for name in file.read_text(encoding="utf-8").partition("\n")[0].split(",")]


def _made(rig: Dataset) -> list[str]:
    """Inputs that the controller makes."""
    command = rig.system().info.command
    return [command.name] if rig.controller is not None and command is not None else []


def _lacking(name: str, required: list[str], rig: Dataset) -> str:
    return f"{name} is not planned; {rig.kind} needs {', '.join(required)}; expected a CSV with a column for each"

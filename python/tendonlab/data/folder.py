"""`load`: a folder with dataset.toml and its files to a checked Dataset."""

from collections.abc import Iterable
from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np

from tendonlab.data.controller import check_controller, read_controller
from tendonlab.data.dataset import Dataset
from tendonlab.data.experiments import MAX_MISSING, Context, read_experiments, read_time, split_is_given
from tendonlab.data.missing_inputs import absent_inputs
from tendonlab.data.parameters import assumptions, read_nominal_effects, read_parameters, read_system
from tendonlab.data.schema import FILE, read_toml
from tendonlab.data.signals import read_signals
from tendonlab.data.stamps import with_even_stamps
from tendonlab.data.wraps import without_wraps
from tendonlab.errors import DatasetError, ParameterError, nearest_name
from tendonlab.simulation import catalog
from tendonlab.simulation.records import Controller, Experiment, SignalSpec

MOST_LONG = 0.05  # share of long time steps up to which they are gaps


def load(path: str | PathLike[str]) -> Dataset:
    """Read and check the dataset in the folder `path` (or the dataset.toml in it); samples come in SI units.

    Raises DatasetError at the first violation of the format; it names file, key or column, row where there is one, and
    what was expected. Rows are the lines of a CSV file (the header is row 1), otherwise samples counted from 1."""
    if not isinstance(path, str | PathLike):
        raise ParameterError(f"path = {path!r:.60}: expected the folder of a dataset")
    folder = Path(path)
    folder = folder.parent if folder.name == FILE else folder
    top = read_toml(folder)
    name, description = top.text("name"), top.text("description", "")
    info, axis = read_system(top)
    nominal_effects = read_nominal_effects(top, info)
    parameters = read_parameters(top, info, nominal_effects=nominal_effects)
    controller = read_controller(top)
    signals = read_signals(top, info, axis=axis, controller=controller)
    check_controller(top, signals=signals, info=info)
    column, unit = read_time(top)
    context = Context(
        folder=folder,
        info=info,
        nominal_effects=nominal_effects,
        parameters=parameters,
        signals=signals,
        time_column=column,
        time_unit=unit,
        time_stated="time" in top.values,
    )
    experiments, mended = _mended(read_experiments(top, context), signals, info=info, controller=controller)
    _require_motion(experiments, signals.values(), info=info, controller=controller)
    _require_moving_output(experiments, signals.values())
    command = signals.get(info.command.name) if info.command is not None else None
    command_is_effort = command is None or command.si_unit == catalog.unit("effort", axis)
    warnings = [
        *assumptions(top, parameters, experiments, info, command_is_effort=command_is_effort),
        *_doubts(experiments, signals.values(), info=info),
        *mended,
        *_split_notes(experiments, given=split_is_given(top)),
        *(() if info.steady else _gap_notes(experiments)),
    ]
    dataset = Dataset(
        name=name,
        description=description,
        kind=info.kind,
        axis=axis,
        nominal_effects=nominal_effects,
        parameters=parameters,
        controller=controller,
        signals=signals,
        experiments=experiments,
        path=folder,
        warnings=tuple(warnings),
    )
    return replace(dataset, warnings=(*warnings, *absent_inputs(dataset)))


def _mended(
    experiments: tuple[Experiment, ...],
    signals: dict[str, SignalSpec],
    *,
    info: catalog.SystemInfo,
    controller: Controller | None,
) -> tuple[tuple[Experiment, ...], list[str]]:
    """The experiments without what recording did to stamps and angles, and what was mended, in words."""
    experiments, of_stamps = (experiments, []) if info.steady else with_even_stamps(experiments)
    experiments, of_angles = without_wraps(experiments, signals, info, controller)
    return experiments, [*of_stamps, *of_angles]


def _require_motion(
    experiments: tuple[Experiment, ...],
    signals: Iterable[SignalSpec],
    *,
    info: catalog.SystemInfo,
    controller: Controller | None,
) -> None:
    """Raise DatasetError where what drives the replay is constant in every experiment and so identifies nothing. A
    motor that is off lets the rig swing freely, which does."""
    required = [signal.name for signal in info.inputs if signal.required]
    if info.command is not None and (controller is not None or _differs(experiments, info.command.name)):
        required.remove(info.command.name)
    # A controller computes the motor's command, from a reference that moves or is disturbed.
    if controller is not None and (controller.disturbance is None or _is_constant(experiments, controller.disturbance)):
        required.append(controller.reference)
    for spec in signals:
        if spec.name in required and _is_constant(experiments, spec.name):
            value = experiments[0].data[spec.name].iloc[0]
            problem = f"column {spec.column!r} is constant ({value:g} {spec.si_unit}) in every experiment"
            raise DatasetError(
                f"{FILE}, key signals.{spec.name}: {problem} and identifies nothing; expected it to vary"
            )


def _require_moving_output(experiments: tuple[Experiment, ...], signals: Iterable[SignalSpec]) -> None:
    """Raise DatasetError where every output is constant in every experiment."""
    outputs = [spec.name for spec in signals if spec.role == "output"]
    if all(_is_constant((experiment,), name) for experiment in experiments for name in outputs):
        problem = f"{', '.join(outputs)}: constant in every experiment, which identifies nothing"
        raise DatasetError(f"{FILE}, key signals: {problem}; expected an output that varies")


def _is_constant(experiments: Iterable[Experiment], name: str) -> bool:
    return all(bool((frame == frame.iloc[0]).all()) for frame in (experiment.data[name] for experiment in experiments))


def _differs(experiments: Iterable[Experiment], name: str) -> bool:
    """Whether a command is 0 in some experiment: free motion; or differs between experiments."""
    records = [experiment.data[name] for experiment in experiments]
    return any(not record.any() for record in records) or len({float(record.iloc[0]) for record in records}) > 1


def _doubts(experiments: Iterable[Experiment], signals: Iterable[SignalSpec], *, info: catalog.SystemInfo) -> list[str]:
    """A warning for every covariate whose name is nearly that of a signal or parameter of the system."""
    known = [signal.name for signal in info.signals]
    parameters = [parameter.name for parameter in info.parameters]
    covariates = {
        f"signal {spec.name!r}": nearest_name(spec.name, known, likeness=0.8)
        for spec in signals
        if spec.role == "covariate"
    }
    conditions = {name for experiment in experiments for name in experiment.conditions if name not in parameters}
    covariates |= {f"condition {name!r}": nearest_name(name, parameters, likeness=0.8) for name in sorted(conditions)}
    return [
        f"{what} is unknown to {info.kind} and kept as a covariate; {match!r} has nearly that name"
        for what, match in covariates.items()
        if match is not None
    ]


def _split_notes(experiments: tuple[Experiment, ...], *, given: bool) -> list[str]:
    held_out = [experiment.name for experiment in experiments if experiment.split == "test"]
    if not held_out:
        return ["no experiment is held out: all of them are in the training set"]
    if given:
        return []
    return [f"no split given: held out by the library: {', '.join(held_out)}"]


def _gap_notes(experiments: Iterable[Experiment]) -> list[str]:
    """A warning where experiments lost more samples in a row than inputs may lack. Where many steps are long, the log
    was meant to be uneven."""
    found = []
    for experiment in experiments:
        time, steps = experiment.time, np.diff(experiment.time)
        lost = np.round(steps / np.median(steps)) - 1
        worst = int(lost.argmax())
        if lost[worst] > MAX_MISSING and np.sum(lost > 0) <= max(1.0, MOST_LONG * len(steps)):
            found.append(f"about {lost[worst]:.0f} after t = {time[worst]:.6g} s in {experiment.name}")
    if not found:
        return []
    others = f" (such gaps in {len(found)} experiments)" if len(found) > 1 else ""
    advice = "inputs are held or interpolated there; end the experiment before the gap unless that is right"
    return [f"samples are missing in a row, {found[0]}{others}; {advice}"]

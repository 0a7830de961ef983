"""Sensors of a position that are dead, though their reading flickers: the rig moves, and they do not tell."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from tendonlab.checking.finding import Finding
from tendonlab.checking.logs import VELOCITIES
from tendonlab.data import Dataset
from tendonlab.errors import DatasetError, NumericalError, ParameterError
from tendonlab.report.numbers import number, unit_text
from tendonlab.simulation.system import System

LEVELS = 3  # different readings between which a sensor at rest may flicker
FAR = 100.0  # times what a sensor shows, by which the simulator moves there
DIMENSIONS = (*VELOCITIES, "speed")  # of a velocity that may show a motion, that of a nut included
MOTION = 0.5  # of the sd of a velocity: what it changes by from sample to sample is less, or it is noise


def dead_outputs(dataset: Dataset, system: System) -> Iterator[Finding]:
    """A finding for each position that flickers between neighbouring readings in all experiments, though the simulator
    moves there. It blocks where a velocity that was logged says that the rig moved: else friction may hold the rig."""
    for output in system.info.outputs:
        if output.axis is None or output.name not in dataset.signals:
            continue
        rows = [row for _, row in _records(dataset, [output.name])]
        if not rows or max(len(np.unique(row)) for row in rows) > LEVELS:
            continue
        shown = max(float(np.ptp(row)) for row in rows)
        moved = _predicted(dataset, system, output.name)
        if moved > FAR * shown:
            unit = unit_text(dataset.signals[output.name].si_unit)
            velocity = _moving_velocity(dataset, system)
            why = f"though {velocity} changes: its sensor is dead" if velocity else "dead, or held by friction"
            text = (
                f"{output.name} stays within {number(shown)} {unit} in every experiment, {why}. The simulator moves by "
            )
            detail = f"{text}{number(moved)} {unit}"
            yield Finding(problem="constant", signal=output.name, detail=detail, blocks=velocity is not None)


def _records(dataset: Dataset, names: Sequence[str]) -> Iterator[tuple[str, np.ndarray]]:
    """What was measured of these signals, by signal and experiment."""
    for name in names:
        for experiment in dataset:
            if name in experiment.data.columns and len(row := experiment.data[name].dropna()):
                yield name, row.to_numpy(dtype=float)


def _predicted(dataset: Dataset, system: System, name: str) -> float:
    """How far the simulator goes in the experiment where it goes farthest; 0 where it cannot be simulated."""
    farthest = 0.0
    for experiment in dataset:
        try:
            found = system.under(experiment).simulate(experiment)[name].to_numpy()
        except (NumericalError, ParameterError, DatasetError):
            continue
        farthest = max(farthest, float(np.ptp(found)))
    return farthest


def _moving_velocity(dataset: Dataset, system: System) -> str | None:
    """A logged velocity that is a motion, no noise: it changes little from sample to sample."""
    velocities = [s.name for s in system.info.signals if s.dimension in DIMENSIONS and s.name in dataset.signals]
    return next(
        (
            name
            for name, row in _records(dataset, velocities)
            if len(np.unique(row)) > LEVELS and np.std(np.diff(row)) < MOTION * np.std(row)
        ),
        None,
    )

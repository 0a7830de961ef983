"""Sensors of a position that are dead, though their reading flickers: the rig moves, and they do not tell."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tendonlab.checking.finding import Finding
from tendonlab.data import Dataset
from tendonlab.errors import NumericalError
from tendonlab.report.numbers import number, unit_text
from tendonlab.simulation.system import System

LEVELS = 3  # different readings between which a sensor at rest may flicker
FAR = 100.0  # times what a sensor shows, by which the simulator moves there
VELOCITIES = ("flow", "speed", "angular_speed")


def dead_outputs(dataset: Dataset, system: System) -> Iterator[Finding]:
    """A finding for each position that flickers between neighbouring readings in all experiments, though the simulator
    moves there. It blocks where a velocity that was logged says that the rig moved: else friction may hold the rig."""
    for output in system.info.outputs:
        if output.axis is None or output.name not in dataset.signals:
            continue
        rows = [e.data[output.name].dropna().to_numpy(dtype=float) for e in dataset if output.name in e.data.columns]
        if not rows or max(len(np.unique(row)) for row in rows) > LEVELS:
            continue
        shown = max(float(np.ptp(row)) for row in rows if len(row))
        moved = _foretold(dataset, system, output.name)
        if moved > FAR * shown and moved > 0.0:
            unit = unit_text(dataset.signals[output.name].si_unit)
            text = (
                f"{output.name} stays within {number(shown)} {unit} in every experiment, where the simulator moves by "
            )
            text += f"{number(moved)} {unit}: its sensor is dead, or friction that the simulator lacks holds the rig"
            yield Finding(problem="constant", signal=output.name, detail=text, blocks=_shows_motion(dataset))


def _foretold(dataset: Dataset, system: System, name: str) -> float:
    """How far the simulator goes in the experiment where it goes farthest; 0 where it cannot be simulated."""
    farthest = 0.0
    for experiment in dataset:
        try:
            found = system.under(experiment).simulate(experiment)[name].to_numpy()
        except NumericalError:
            continue
        farthest = max(farthest, float(np.ptp(found)))
    return farthest


def _shows_motion(dataset: Dataset) -> bool:
    """Whether a velocity was logged that changes by more than its sensor's noise may."""
    of = {s.name: s.dimension for s in dataset.system().info.signals}
    velocities = [name for name in dataset.signals if of.get(name) in VELOCITIES]
    return any(
        len(np.unique(e.data[name].dropna())) > LEVELS and _is_smooth(e.data[name].dropna().to_numpy(dtype=float))
        for e in dataset
        for name in velocities
        if name in e.data.columns
    )


def _is_smooth(values: np.ndarray) -> bool:
    """Whether neighbouring samples differ by far less than all of them do: a motion, and no noise."""
    return float(np.std(np.diff(values))) < 0.5 * float(np.std(values))

"""One experiment, ready to be simulated at many points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from tendonlab import _core
from tendonlab.simulation.prepare import Prepared, choose_loop, prepare
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.system import System
from tendonlab.sweeping.points import Points, refuse_conditions, require_within


@dataclass(frozen=True, eq=False)
class Run:
    """`system`: under the conditions of the experiment. `places`: where the parameters `names` of the points are among
    the values of the core. `channels`: outputs to be recorded. `added`: what the experiment adds to those parameters,
    None where nothing."""

    system: System
    prepared: Prepared
    places: tuple[int, ...]
    added: tuple[float | None, ...]
    channels: tuple[int, ...]
    tolerance: float

    @property
    def num_samples(self) -> int:
        """Samples of each output."""
        return int(self.prepared.measured.shape[1])

    def values(self, points: np.ndarray) -> np.ndarray:
        """What the core takes for points (n, names): shape (n, parameters)."""
        values = np.tile(self._usual, (len(points), 1))
        for k, (place, more) in enumerate(zip(self.places, self.added, strict=True)):
            values[:, place] = points[:, k] if more is None else points[:, k] + more
        return values

    def simulate(self, points: np.ndarray, out: np.ndarray) -> list[str]:
        """Write the outputs at points (n, names) into `out`, (n, channels, samples): what `System.simulate` gives for
        each of them. Gives a message per point, "" where the run went well."""
        values = self.values(points)
        active = self.system.active_at(values)
        position, velocity = self._start(values, active)
        settings = self.prepared.settings(self.tolerance)
        kind, core, channels = self.system.kind, self.prepared.core, self.channels
        return _core.simulate_many(kind, values, active, core, position, velocity, settings, channels, out)

    def _start(self, values: np.ndarray, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Initial states, one row per point; the rigid shape is asked for only where it matters."""
        start, kind = self.prepared.start, self.system.kind
        if not start.is_rigid:
            return start.state(np.ones((len(values), len(start.follows))))
        rows = zip(values.tolist(), active.tolist(), strict=True)
        return start.state(np.array([_core.rigid_motion(kind, *row)[0] for row in rows]))

    @cached_property
    def _usual(self) -> np.ndarray:
        return np.array(self.system.values())


def run_of(system: System, experiment: Experiment, points: Points, *, channels: Sequence[int], tolerance: float) -> Run:
    """`experiment` for the points. Raises ParameterError where its conditions fix a parameter of the points, or its
    additions take a value out of its bounds; DatasetError for a missing input."""
    refuse_conditions(experiment, points.names)
    added = tuple(experiment.add.get(name) for name in points.names)
    for k, (name, more) in enumerate(zip(points.names, added, strict=True)):
        if more is not None:
            reason = f" with {more:+g} in {experiment.name}"
            require_within(system, name, points.values[:, k] + more, points, because=reason)
    first = dict(zip(points.names, points.values[0].tolist(), strict=True))
    under = system.with_parameters(first).under(experiment)
    prepared = prepare(experiment, under, choose_loop(experiment, system.controller, "auto"))
    order = [p.name for p in system.info.parameters]
    places = tuple(order.index(name) for name in points.names)
    bare = replace(prepared, measured=np.empty((0, len(prepared.core.time))))  # tasks carry no measurements
    bare.settings(tolerance)
    return Run(under, bare, places, added, tuple(channels), tolerance)

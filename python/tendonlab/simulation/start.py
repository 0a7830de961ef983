"""Where an experiment begins: the state that its first samples show, for one set of parameters or for many."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tendonlab.simulation.catalog import SystemInfo
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.signals import AT_ONCE, first_samples, first_seen, motion_at_start

REACH = 0.1  # of its range: prior sd of a measured part of the initial state that is no velocity


@dataclass(frozen=True)
class Start:
    """`follows`: for each degree of freedom the measured one that it moves with as if nothing stretched, itself where
    it was measured; None where nothing was. `motion`: position and velocity of the measured ones, and the prior sd of
    each, 0 where it is known. `position` and `velocity`: what the experiment states. `sensor`: the output that tells
    each measured one. `reading`: what is read before the first sample of each output that the system may hold, NaN
    where it is not known and for others; `reading_sd`: of those that were measured."""

    follows: tuple[int | None, ...]
    motion: Mapping[int, tuple[float, float, float, float]]
    sensor: Mapping[int, int]
    position: Mapping[int, float]
    velocity: Mapping[int, float]
    reading: tuple[float, ...]
    reading_sd: Mapping[int, float]

    @property
    def is_rigid(self) -> bool:
        """Whether the state depends on the rigid shape, and so on parameters."""
        return any(k not in (None, j) for j, k in enumerate(self.follows))

    def state(self, shape: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Position and velocity, shape (..., dof), for rigid shapes (..., dof) as `_core.rigid_motion` gives them."""
        position, velocity = np.zeros((2, *shape.shape[:-1], len(self.follows)))
        for j, known in enumerate(self.follows):
            y, rate, *_ = (0.0, 0.0) if known is None else self.motion[known]
            share = np.zeros(shape.shape[:-1]) if known is None else self._share(shape, j, known)
            position[..., j] = self.position.get(j, share * y)
            velocity[..., j] = self.velocity.get(j, share * rate)
        return position, velocity

    def taken(self, shape: np.ndarray) -> list[tuple[int, int, float]]:
        """(degree of freedom, output, share) of the positions that are a share of what a sensor reads."""
        return [
            (j, self.sensor[known], float(self._share(shape, j, known)))
            for j, known in enumerate(self.follows)
            if known is not None and j not in self.position
        ]

    def nuisances(self, shape: np.ndarray) -> tuple[tuple[tuple[str, int], ...], tuple[float, ...]]:
        """What is neither stated nor at rest, as ("position" | "velocity", degree of freedom) or ("reading", output),
        and the sd of each."""
        found: dict[tuple[str, int], float] = {}
        for j, known in enumerate(self.follows):
            if known is None:
                continue
            share = float(self._share(shape, j, known))
            _, _, position_sd, velocity_sd = (abs(share * part) for part in self.motion[known])
            if j not in self.position and position_sd > 0:
                found["position", j] = position_sd
            if j not in self.velocity and velocity_sd > 0:
                found["velocity", j] = velocity_sd
        found |= {("reading", c): sd for c, sd in self.reading_sd.items()}
        return tuple(found), tuple(found.values())

    def _share(self, shape: np.ndarray, j: int, known: int) -> np.ndarray:
        return np.ones(shape.shape[:-1]) if j == known else shape[..., j] / shape[..., known]


def start_of(experiment: Experiment, info: SystemInfo, measured: np.ndarray) -> Start:
    """The start that the samples `measured`, (outputs, samples), and the statements of an experiment show."""
    motion: dict[int, tuple[float, float, float, float]] = {}
    sensor: dict[int, int] = {}
    for c, (signal, y) in enumerate(zip(info.outputs, measured, strict=True)):
        if signal.axis is not None and np.isfinite(y).any():
            motion[signal.axis] = _motion(experiment.time, y)
            sensor[signal.axis] = c
    first = next(iter(motion), None)
    position: dict[int, float] = {}
    velocity: dict[int, float] = {}
    reading, reading_sd = _held(experiment, info, measured)
    for signal in info.outputs:
        if signal.axis is not None:
            rate = signal.name.removesuffix("_angle") + "_velocity"
            if signal.name in experiment.initial:
                position.setdefault(signal.axis, experiment.initial[signal.name])
            if rate in experiment.initial:
                velocity.setdefault(signal.axis, experiment.initial[rate])
    follows = tuple(j if j in motion else first for j in range(info.dof))
    return Start(follows, motion, sensor, position, velocity, reading, reading_sd)


def _motion(time: np.ndarray, y: np.ndarray) -> tuple[float, float, float, float]:
    """Position and velocity that the first measured samples of an output show, and the prior sd of each. Where these
    are late, the part may have come from anywhere in its range since the experiment began."""
    position, velocity = motion_at_start(time, y)
    travel, late = float(np.nanmax(y) - np.nanmin(y)), first_seen(time, y)
    if late > AT_ONCE:
        return position, velocity, travel, max(abs(velocity), travel / late)
    return position, velocity, REACH * travel, abs(velocity)


def _held(experiment: Experiment, info: SystemInfo, measured: np.ndarray) -> tuple[tuple[float, ...], dict[int, float]]:
    """What is read of held outputs before the first sample: what the experiment states, else the median of the first
    samples, with its sd."""
    reading = [experiment.initial.get(s.name, np.nan) if s.held else np.nan for s in info.outputs]
    sd: dict[int, float] = {}
    for c, (signal, y) in enumerate(zip(info.outputs, measured, strict=True)):
        if signal.held and np.isnan(reading[c]) and np.isfinite(y).any():
            reading[c] = float(np.median(first_samples(experiment.time, y)))
            if (reach := float(np.nanmax(y) - np.nanmin(y))) > 0:
                sd[c] = REACH * reach
    return tuple(reading), sd

"""Sensors of many lanes."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .description import Array, Lanes, Scene


def as_logged(values: Array, noise: Array | None, resolution: Array | None) -> Array:
    """Readings with noise, rounded to steps where these are not 0."""
    if noise is not None:
        values = values + noise
    if resolution is not None:
        grid = np.where(resolution > 0, resolution, 1.0)
        values = np.where(resolution > 0, np.round(values / grid) * grid, values)
    return np.asarray(values)


class Sensors:
    """The sensors of all lanes in the order of the system's outputs: late, biased, noisy, in steps."""

    def __init__(self, lanes: Lanes, scene: Scene, num_steps: int) -> None:
        names = lanes.system.output_names
        self.scene, self.bias = scene, np.stack([lanes.get(f"sensor.{name}_bias") for name in names])
        delays = [lanes.get(f"sensor.{name}_delay") for name in names]
        self.readings = [Reading(delay, sample_time=scene.sample_time, num_steps=num_steps) for delay in delays]
        self.are_late = any(reading.capture for reading in self.readings)

    def read(self, k: int, values: Iterable[Array]) -> Array:
        """Readings at sample k of what perfect sensors would read, (outputs, n)."""
        late = np.stack([reading.read(value) for reading, value in zip(self.readings, values, strict=True)])
        noise = None if self.scene.noise is None else self.scene.noise[:, k]
        return as_logged(late + self.bias, noise, self.scene.resolution)

    def note(self, index: int, values: Iterable[Array], changes: Iterable[Array]) -> None:
        """What perfect sensors would read in the middle of step `index` of a sample, and the change over that step."""
        for reading, value, change in zip(self.readings, values, changes, strict=True):
            reading.note(index, value, change)


class Reading:
    """One delayed and biased sensor: captures the value at (sample - delay), first within a sample, then whole
    samples later.
    """

    def __init__(self, delay: Array, *, sample_time: float, num_steps: int) -> None:
        late = np.floor(delay / sample_time + 1e-9).astype(int)
        rest = np.maximum(delay - late * sample_time, 0.0)
        self.late, self.lanes = late, np.arange(delay.size)
        at = num_steps - rest * num_steps / sample_time  # in steps since the last sample
        within = rest > 1e-9
        self.capture = {int(j): np.flatnonzero(within & (np.floor(at) == j)) for j in np.unique(np.floor(at[within]))}
        self.offset = at - np.floor(at) - 0.5  # from the middle of that step, in steps
        self.held: dict[int, Array] = {}
        self.past: Array | None = None

    def note(self, index: int, value: Array, rate: Array) -> None:
        lanes = self.capture.get(index)
        if lanes is not None:
            self.held[index] = value[lanes] + self.offset[lanes] * rate[lanes]

    def read(self, value: Array) -> Array:
        fresh = value.copy()
        for index, held in self.held.items():
            fresh[self.capture[index]] = held
        if self.past is None:
            self.past = np.repeat(value[None, :], int(self.late.max()) + 1, axis=0)
        self.past = np.concatenate([fresh[None, :], self.past[:-1]])
        return np.asarray(self.past[self.late, self.lanes])

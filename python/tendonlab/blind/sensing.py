"""Delayed sensors of many lanes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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

"""Where chunks go: memory, or a store on disk that outlives the process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from tendonlab.sweeping.layout import Layout

INTERRUPTED = "interrupted"  # the message of a point that was not simulated


@dataclass(frozen=True)
class Place:
    """Points from `first` to before `last`, of one experiment."""

    experiment: int
    first: int
    last: int

    def __len__(self) -> int:
        return self.last - self.first


class Storage(Protocol):
    """What `sweep` needs of memory and stores. `messages`: of each point, shape (experiments, points)."""

    messages: np.ndarray

    def view(self, place: Place) -> np.ndarray | None:
        """Memory that the samples of a chunk may be written to, shape (points, outputs, samples); None: no such."""

    def write(self, place: Place, kept: np.ndarray, messages: list[str]) -> None:
        """Keep a chunk."""

    def variables(self) -> dict[str, Any]:
        """All that was kept, arrays (experiments, points, ...), NaN where nothing was."""


class Memory:
    """One array; threads write into it directly."""

    def __init__(self, layout: Layout, cell: tuple[int, ...]) -> None:
        shape = (len(layout.experiments), len(layout.points))
        self._layout = layout
        self._kept = np.empty((*shape, *cell), dtype=layout.keep.dtype)
        self.messages = np.full(shape, INTERRUPTED, dtype=object)

    def view(self, place: Place) -> np.ndarray | None:
        whole = self._layout.keep.reduction is None
        return self._kept[place.experiment, place.first : place.last] if whole else None

    def write(self, place: Place, kept: np.ndarray, messages: list[str]) -> None:
        into = self._kept[place.experiment, place.first : place.last]
        if not np.may_share_memory(into, kept):
            into[:] = kept
        self.messages[place.experiment, place.first : place.last] = messages

    def variables(self) -> dict[str, Any]:
        self._kept[self.messages == INTERRUPTED] = np.nan
        if self._layout.by_output:
            return {name: self._kept[:, :, k] for k, name in enumerate(self._layout.outputs)}
        return {self._layout.variables[0]: self._kept}

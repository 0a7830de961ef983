"""What every tool is asked to simulate."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from tendonlab import _core
from tendonlab.simulation.prepare import Prepared, choose_loop, prepare
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.system import System

# (t, state, parameters, result): writes into `result`. Only indexing and `math`, so that numba compiles the same text.
Formula = Callable[[float, Sequence[float], Sequence[float], Any], None]


@dataclass(frozen=True, eq=False)
class Problem:
    """Two statements of one simulation: equations for the peers, a system and an experiment for tendonlab.

    `rate` and `outputs` take `parameters`; `units`: the size of each state, SI, which tools without absolute tolerances
    per state count them in. The initial state is zero. `read`: picks the same outputs, (samples, k), from what the core
    gives, which records the outputs `reads`, by index (default: all), and of each port the quantities `ports`. `core`:
    the experiment as the core takes it, where it is not what `prepare` makes of `experiment`."""

    name: str
    text: str
    time: np.ndarray
    parameters: np.ndarray
    units: np.ndarray
    rate: Formula
    outputs: Formula
    num_outputs: int
    system: System
    experiment: Experiment
    read: Callable[[dict[str, Any]], np.ndarray] = field(repr=False)
    reads: tuple[int, ...] | None = None
    ports: tuple[str, ...] = ()
    core: _core.Experiment | None = None

    def core_experiment(self) -> _core.Experiment:
        """The experiment as the core simulates it."""
        return self.core or self._prepared.core

    def settings(self, tolerance: float) -> _core.Settings:
        """How the core goes through it."""
        return self._prepared.settings(tolerance, ports=self.ports, outputs=self.reads)

    @cached_property
    def _prepared(self) -> Prepared:
        return prepare(self.experiment, self.system, choose_loop(self.experiment, self.system.controller, "auto"))

    def rate_of_lists(self, t: float, state: np.ndarray) -> list[float]:
        """The rate by the interpreter alone: slow, but it needs no compiler."""
        change = [0.0] * len(self.units)
        self.rate(t, state.tolist(), self.parameters.tolist(), change)
        return change

    def outputs_of(self, states: np.ndarray) -> np.ndarray:
        """Outputs, shape (samples, k), of states, shape (samples, n), by the interpreter alone."""
        found = np.empty((len(self.time), self.num_outputs))
        for row, t, state in zip(found, self.time.tolist(), states.tolist(), strict=True):
            self.outputs(t, state, self.parameters.tolist(), row)
        return found

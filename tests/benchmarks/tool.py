"""What the benchmarks ask of a tool."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.clock import Call
from benchmarks.problem import Problem

FINE = tuple(10.0 ** -np.arange(2.0, 11.01, 0.25))
COARSE = tuple(10.0 ** -np.arange(3.0, 10.01))  # for tools of which a call takes a second


@dataclass(frozen=True)
class Tool:
    """`call(problem, tolerance)` gives a call that returns the problem's outputs, (samples, k). `needs`: the modules
    without which the tool is skipped; `lacks` names what else is missing."""

    name: str
    call: Callable[[Problem, float], Call]
    needs: tuple[str, ...] = ()
    tolerances: tuple[float, ...] = FINE
    lacks: Callable[[], tuple[str, ...]] = tuple

    @property
    def missing(self) -> tuple[str, ...]:
        """What is not installed."""
        return tuple(name for name in self.needs if importlib.util.find_spec(name) is None) or self.lacks()

"""tendonlab as the benchmarks call it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.clock import Call
from benchmarks.problem import Problem
from benchmarks.tool import Tool
from tendonlab import _core


def core_call(problem: Problem, tolerance: float, seeds: Sequence[tuple[str, int]] = ()) -> Call:
    """One call of the core. The experiment is prepared beforehand, as the peers' equations are compiled beforehand.
    `seeds`: what the outputs are differentiated by."""
    system, settings = problem.system, problem.settings(tolerance)
    given = (system.kind, system.values(), system.active(), problem.core_experiment(), list(seeds), settings)

    def call() -> np.ndarray:
        return problem.read(_core.simulate(*given))

    return call


TOOL = Tool("tendonlab", core_call)

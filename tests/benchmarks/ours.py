"""tendonlab as the benchmarks call it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.clock import Call
from benchmarks.problem import Problem
from benchmarks.tool import Tool
from tendonlab import _core
from tendonlab.simulation.prepare import choose_loop, prepare


def core_call(problem: Problem, tolerance: float, seeds: Sequence[tuple[str, int]] = ()) -> Call:
    """One call of the core. The experiment is prepared beforehand, as the peers' equations are compiled beforehand.
    `seeds`: what the outputs are differentiated by."""
    system = problem.system
    ready = prepare(problem.experiment, system, choose_loop(problem.experiment, system.controller, "auto"))
    settings = ready.settings(tolerance, ports=problem.reads_ports and not seeds)
    given = (system.kind, system.values(), system.active(), problem.core or ready.core, list(seeds), settings)

    def call() -> np.ndarray:
        return problem.read(_core.simulate(*given))

    return call


TOOL = Tool("tendonlab", core_call)

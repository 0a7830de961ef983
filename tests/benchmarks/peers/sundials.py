"""scikit-sundae: CVODE (BDF) of SUNDIALS with a right-hand side compiled by numba."""

from __future__ import annotations

import numpy as np

from benchmarks.clock import Call
from benchmarks.peers.compiled import compiled, observe
from benchmarks.problem import Problem
from benchmarks.tool import COARSE, Tool


def call(problem: Problem, tolerance: float) -> Call:
    from sksundae.cvode import CVODE

    rate, parameters, start = compiled(problem.rate), problem.parameters, np.zeros(len(problem.units))

    def change(t: float, state: np.ndarray, out: np.ndarray) -> None:
        rate(t, state, parameters, out)

    absolute = tolerance * problem.units
    solver = CVODE(change, rtol=tolerance, atol=absolute, method="BDF", max_num_steps=10_000_000)

    def solve() -> np.ndarray:
        found = solver.solve(problem.time, start)
        if not found.success:
            raise RuntimeError(str(found.message))
        return observe(problem, np.ascontiguousarray(found.y), np.ones_like(problem.units))

    return solve


TOOL = Tool("scikit-sundae CVODE, compiled rate", call, ("numba", "sksundae"), COARSE)

"""scipy's solve_ivp with a right-hand side compiled by numba, and the reference solution."""

from __future__ import annotations

from functools import partial

import numpy as np

from benchmarks.clock import Call
from benchmarks.peers.compiled import observe, rate_function
from benchmarks.problem import Problem
from benchmarks.tool import COARSE, Tool

REFERENCE = 1e-12


def call(problem: Problem, tolerance: float, *, method: str) -> Call:
    """Absolute tolerances follow the size of each state."""
    from scipy.integrate import solve_ivp

    rate, time, start = rate_function(problem), problem.time, np.zeros(len(problem.units))
    given = {"method": method, "rtol": tolerance, "atol": tolerance * problem.units, "t_eval": time}

    def solve() -> np.ndarray:
        found = solve_ivp(rate, (time[0], time[-1]), start, **given)
        if not found.success:
            raise RuntimeError(found.message)
        return observe(problem, np.ascontiguousarray(found.y.T), np.ones_like(problem.units))

    return solve


def reference(problem: Problem, tolerance: float = REFERENCE) -> np.ndarray:
    """Outputs, shape (samples, k), by LSODA; needs nothing but scipy."""
    return np.asarray(call(problem, tolerance, method="LSODA")())


TOOLS = tuple(
    Tool(f"scipy {method}, compiled rate", partial(call, method=method), ("numba",), COARSE)
    for method in ("LSODA", "Radau")
)

"""numbalsoda: LSODA in Fortran with a compiled right-hand side, called from Python or from compiled loops.

It takes one absolute tolerance for all states. Once states are in SI and the tolerance follows the smallest of them,
once each state is counted in its own unit, which is the fairer way."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from benchmarks.clock import Call
from benchmarks.peers.compiled import address_of, observe, observer
from benchmarks.problem import Problem
from benchmarks.tool import Tool

NEEDS = ("numba", "numbalsoda")


def scaled_call(problem: Problem, tolerance: float) -> Call:
    return _call(problem, problem.units, tolerance, tolerance)


def plain_call(problem: Problem, tolerance: float) -> Call:
    return _call(problem, np.ones_like(problem.units), tolerance, tolerance * problem.units.min())


def _call(problem: Problem, units: np.ndarray, relative: float, absolute: float) -> Call:
    from numbalsoda import lsoda

    address, start = address_of(problem, units), np.zeros(len(units))
    given = {"data": problem.parameters, "rtol": relative, "atol": absolute}

    def call() -> np.ndarray:
        states, _ = lsoda(address, start, problem.time, **given)
        return observe(problem, states, units)

    return call


@cache
def _loop(outputs: Any) -> Any:
    """Compiled: every row of `points` simulated and observed, one after the other."""
    import numba
    from numbalsoda import lsoda

    watch = observer(outputs)

    @numba.njit
    def loop(address, points, time, units, tolerance, found):  # type: ignore[no-untyped-def]
        for i in range(points.shape[0]):
            given = points[i].copy()
            states, _ = lsoda(address, np.zeros(units.size), time, given, tolerance, tolerance)
            watch(time, states, units, given, found[i])

    return loop


def sweep_call(problem: Problem, points: np.ndarray, tolerance: float) -> Call:
    """Outputs at every row of `points`, (n, parameters of the rate): shape (n, samples, k)."""
    address, loop = address_of(problem, problem.units), _loop(problem.outputs)

    def call() -> np.ndarray:
        found = np.empty((len(points), len(problem.time), problem.num_outputs))
        loop(address, points, problem.time, problem.units, tolerance, found)
        return found

    return call


SCALED = Tool("numbalsoda, states scaled", scaled_call, NEEDS)
PLAIN = Tool("numbalsoda, states in SI", plain_call, NEEDS)

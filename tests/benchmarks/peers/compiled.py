"""Equations of a problem, compiled by numba where it is installed."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from benchmarks.problem import Problem

HAS_NUMBA = importlib.util.find_spec("numba") is not None


@cache
def compiled(formula: Any) -> Any:
    """The formula as machine code; formulas that it calls must be compiled too."""
    import numba

    module = formula.__globals__
    for name in formula.__code__.co_names:
        if name in module and getattr(module[name], "__module__", "") == formula.__module__:
            called = numba.njit(module[name])
            formula = _with_global(formula, name, called)
    return numba.njit(formula)


def _with_global(formula: Any, name: str, value: Any) -> Any:
    """The same function with another meaning of a global name."""
    return type(formula)(formula.__code__, {**formula.__globals__, name: value}, formula.__name__)


def rate_function(problem: Problem) -> Callable[[float, np.ndarray], Any]:
    """(t, state) -> rate, compiled where that is possible."""
    if not HAS_NUMBA:
        return problem.rate_of_lists
    rate, parameters, size = compiled(problem.rate), problem.parameters, len(problem.units)

    def of(t: float, state: np.ndarray) -> np.ndarray:
        change = np.empty(size)
        rate(t, state, parameters, change)
        return change

    return of


@cache
def observer(outputs: Any) -> Any:
    """(time, states, units, parameters, found): writes the outputs of states that are counted in `units`."""
    import numba

    of_state = compiled(outputs)

    @numba.njit
    def observe(time, states, units, parameters, found):  # type: ignore[no-untyped-def]
        state = np.empty(units.size)
        for i in range(time.size):
            for j in range(units.size):
                state[j] = units[j] * states[i, j]
            of_state(time[i], state, parameters, found[i])

    return observe


def observe(problem: Problem, states: np.ndarray, units: np.ndarray) -> np.ndarray:
    """Outputs of states, shape (samples, n)."""
    if not HAS_NUMBA:
        return problem.outputs_of(states * units)
    found = np.empty((len(problem.time), problem.num_outputs))
    observer(problem.outputs)(problem.time, states, units, problem.parameters, found)
    return found


@cache
def right_hand_side(rate: Any, num_parameters: int, units: tuple[float, ...]) -> Any:
    """The rate of states counted in `units`, for Fortran and C: (t, state, rate, parameters)."""
    import numba
    from numba import types

    rate, size, scale = compiled(rate), len(units), np.array(units)
    numbers = types.CPointer(types.double)

    @numba.cfunc(types.void(types.double, numbers, numbers, numbers))
    def scaled(t, state, change, given):  # type: ignore[no-untyped-def]
        y, d = numba.carray(state, (size,)), numba.carray(change, (size,))
        own = np.empty(size)
        for j in range(size):
            own[j] = y[j] * scale[j]
        rate(t, own, numba.carray(given, (num_parameters,)), d)
        for j in range(size):
            d[j] /= scale[j]

    return scaled


def address_of(problem: Problem, units: np.ndarray) -> int:
    """Where the compiled rate lies."""
    side = right_hand_side(problem.rate, len(problem.parameters), tuple(units.tolist()))
    return int(side.address)

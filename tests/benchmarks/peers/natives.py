"""Integrators in C and C++, compiled on the spot: CVODE of SUNDIALS and rosenbrock4 of boost::odeint."""

from __future__ import annotations

import atexit
import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.clock import Call
from benchmarks.peers.compiled import address_of, observe
from benchmarks.problem import Problem
from benchmarks.tool import COARSE, FINE, Tool

HERE = Path(__file__).parent
SUNDIALS = ("cvode", "nvecserial", "sunmatrixdense", "sunlinsoldense")
COMPILERS = {
    "cvode.c": ("cc", *[f"-lsundials_{name}" for name in SUNDIALS], "-lm"),
    "odeint.cpp": ("c++", "-std=c++17", "-DNDEBUG", "-DBOOST_UBLAS_NDEBUG"),
}
PACKAGES = {"cvode.c": "libsundials-dev", "odeint.cpp": "libboost-dev"}


@cache
def shared_object(source: str, compiler: str, *options: str) -> ctypes.CDLL | None:
    """A source of this folder, compiled; None where that fails."""
    if shutil.which(compiler) is None:
        return None
    folder = tempfile.mkdtemp(prefix="benchmarks-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    out = f"{folder}/{source}.so"
    command = [compiler, "-O3", "-march=native", "-shared", "-fPIC", str(HERE / source), "-o", out, *options]
    if subprocess.run(command, capture_output=True).returncode:
        return None
    return ctypes.CDLL(out)


@cache
def library(source: str) -> Callable[..., int] | None:
    """The function `integrate` of a source; None where it cannot be compiled."""
    compiled = shared_object(source, *COMPILERS[source])
    if compiled is None:
        return None
    integrate: Any = compiled.integrate
    pointer, number, whole = ctypes.c_void_p, ctypes.c_double, ctypes.c_int
    integrate.argtypes = (pointer, pointer, whole, number, pointer, whole, pointer)
    return integrate  # type: ignore[no-any-return]


def call(problem: Problem, tolerance: float, *, source: str) -> Call:
    """States are counted in their units."""
    integrate, units = library(source), problem.units
    assert integrate is not None
    address, time, parameters = address_of(problem, units), problem.time, problem.parameters

    def solve() -> np.ndarray:
        states = np.empty((len(time), len(units)))
        pointers = (parameters.ctypes.data, len(units), tolerance, time.ctypes.data, len(time), states.ctypes.data)
        if integrate(address, *pointers):
            raise RuntimeError(f"{source} failed at a tolerance of {tolerance:g}")
        return observe(problem, states, units)

    return solve


def _lacks(source: str) -> tuple[str, ...]:
    return () if library(source) else (PACKAGES[source],)


TOOLS = tuple(
    Tool(name, partial(call, source=source), ("numba",), tolerances, partial(_lacks, source))
    for name, source, tolerances in (
        ("CVODE in C", "cvode.c", FINE),
        ("boost odeint rosenbrock4 in C++", "odeint.cpp", COARSE),
    )
)

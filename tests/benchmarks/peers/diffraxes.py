"""diffrax: implicit and explicit Runge-Kutta methods in JAX, mapped over the points of the sweep of J1."""

from __future__ import annotations

import importlib.util
from functools import cache, partial
from typing import Any

import numpy as np

from benchmarks.clock import Call
from benchmarks.comparison import Contender
from benchmarks.sweep import Sweep
from benchmarks.tool import COARSE

POINTS = 40  # all of them are judged; more take minutes
SOLVERS = ("Kvaerno3", "Kvaerno5")
MOST_STEPS = 100_000


def contenders(sweep: Sweep) -> tuple[Contender, ...]:
    missing = tuple(name for name in ("jax", "diffrax") if importlib.util.find_spec(name) is None)
    return tuple(
        Contender(f"diffrax {name}", partial(_call, sweep, name), COARSE[:4], missing, runs=len(sweep.points))
        for name in SOLVERS
    )


def _call(sweep: Sweep, solver: str, tolerance: float) -> Call:
    mapped = _mapped(solver, tuple(sweep.problem.time.tolist()), tuple(sweep.problem.units.tolist()))

    def call() -> np.ndarray:
        states = np.asarray(mapped(sweep.points, tolerance))
        return states[:, :, :2] * sweep.problem.units[:2]

    return call


@cache
def _mapped(solver: str, time: tuple[float, ...], units: tuple[float, ...]) -> Any:
    """Compiled: (points, tolerance) -> states in their units, (points, samples, 3)."""
    import diffrax
    import jax

    jax.config.update("jax_enable_x64", True)
    save = diffrax.SaveAt(ts=jax.numpy.array(time))

    def one(point: Any, tolerance: Any) -> Any:
        return diffrax.diffeqsolve(
            diffrax.ODETerm(_rate),
            getattr(diffrax, solver)(),
            t0=0.0,
            t1=time[-1],
            dt0=1e-5,
            y0=jax.numpy.zeros(3),
            args=(point, jax.numpy.array(units)),
            saveat=save,
            stepsize_controller=diffrax.PIDController(rtol=tolerance, atol=tolerance),
            max_steps=MOST_STEPS,
            throw=False,
        ).ys

    return jax.jit(jax.vmap(one, in_axes=(0, None)))


def _rate(t: Any, state: Any, given: Any) -> Any:
    """The equations of `mass` in JAX, states counted in their units."""
    import jax.numpy as jnp

    p, units = given
    x, v, z = state * units
    level = p[4] + p[5] * jnp.exp(-((v / p[6]) ** 2))
    bristle = v - p[1] * jnp.abs(v) * z / level
    drive = p[7] * jnp.sin(2.0 * jnp.pi * p[8] * t) + p[9] * (p[10] * t - x)
    return jnp.stack([v, (drive - p[1] * z - p[2] * bristle - p[3] * v) / p[0], bristle]) / units

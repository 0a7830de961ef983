"""Ways to solve J4. Each takes a fit and the seed of its start, and gives a call that returns the six parameters."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

import tendonlab as tl
from benchmarks import mass
from benchmarks.fit import SIX, Fit
from benchmarks.peers import scipys, soda
from tendonlab import _core
from tendonlab.fitting.case import Case, fine_enough, make_case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import Problem as Posed
from tendonlab.fitting.problem import finer, pose
from tendonlab.simulation.prepare import Replay, prepare
from tendonlab.simulation.system import System

Solver = Callable[[], np.ndarray]
WORST = 1e6  # noise sd: larger residuals, and those of failed simulations, are cut there


@dataclass(frozen=True)
class Fitter:
    """`solver(fit, seed)`: what prepares the fit is not timed, as the peers' equations are compiled beforehand. `most`:
    starts at most, for fits that take seconds."""

    name: str
    solver: Callable[[Fit, int], Solver]
    needs: tuple[str, ...] = ()
    most: int = 1000

    @property
    def missing(self) -> tuple[str, ...]:
        return tuple(name for name in self.needs if importlib.util.find_spec(name) is None)


def free_run(fit: Fit, seed: int) -> Solver:
    """tendonlab in free run, as the peers simulate."""
    case = _in_free_run(fit, seed)
    problem = pose(case, white(case.noise), case.system)
    return lambda: _six(_solved(problem).system)


def injection_first(fit: Fit, seed: int) -> Solver:
    """`tl.identify`, which pulls the simulated position to the measured one, and from there in free run."""
    case, data = _in_free_run(fit, seed), fit.dataset(seed)
    problem = pose(case, white(case.noise), case.system)

    def solve() -> np.ndarray:
        first = tl.identify(data, progress=False).system
        return _six(_solved(problem.at(first, ())).system)

    return solve


def _solved(problem: Posed) -> Fitted:
    """The fit as `tl.identify` ends it: fine enough where it ended."""
    cancel = _core.Cancel()
    return finer(problem, problem.solve(cancel=cancel), cancel)[1]


def _in_free_run(fit: Fit, seed: int) -> Case:
    """The case of the dataset, replayed without injection, as fine as its noise needs."""
    case, free = make_case(fit.dataset(seed), tolerance=1e-4), Replay("free")
    prepared = tuple(prepare(e, case.system, free) for e in case.experiments)
    return fine_enough(replace(case, replay=free, prepared=prepared), case.noise)


def _six(system: System) -> np.ndarray:
    return np.array([system.parameters[name] for name in mass.FRICTION])


def least_squares(fit: Fit, seed: int, *, method: str, tolerance: float, step: float, by_scipy: bool = False) -> Solver:
    """scipy's least_squares with finite differences of relative size `step`.

    It sees q with P = P0 exp(q - 1): so every parameter is about 1 and gets the same relative step."""
    from scipy.optimize import least_squares as solve

    start = fit.start(seed)
    residual = partial(_residual, fit, start, tolerance=tolerance, by_scipy=by_scipy)
    more = {"x_scale": "jac", "max_nfev": 200} if method == "trf" else {}
    given = {"method": method, "diff_step": step, "xtol": 1e-8, "ftol": 1e-8, **more}
    return lambda: start * np.exp(solve(residual, np.ones(6), **given).x - 1.0)


def nelder_mead(fit: Fit, seed: int, *, tolerance: float) -> Solver:
    """scipy's Nelder-Mead on the same q, 4000 simulations at most."""
    from scipy.optimize import minimize

    start = fit.start(seed)
    given = {"method": "Nelder-Mead", "options": {"xatol": 1e-6, "fatol": 1e-3, "maxiter": 4000, "maxfev": 4000}}

    def cost(q: np.ndarray) -> float:
        return float(np.sum(_residual(fit, start, q, tolerance=tolerance, by_scipy=False) ** 2))

    return lambda: start * np.exp(minimize(cost, np.ones(6), **given).x - 1.0)


def _residual(fit: Fit, start: np.ndarray, q: np.ndarray, *, tolerance: float, by_scipy: bool) -> np.ndarray:
    point = fit.problem.parameters.copy()
    point[SIX] = start * np.exp(q - 1.0)
    problem = replace(fit.problem, parameters=point)
    call = scipys.call(problem, tolerance, method="LSODA") if by_scipy else soda.scaled_call(problem, tolerance)
    try:
        residual = fit.residual(call())
    except RuntimeError:  # an integrator may give up far from the truth
        return np.full(fit.measured.size, WORST)
    return np.nan_to_num(np.clip(residual, -WORST, WORST), nan=WORST)


OURS = (Fitter("tendonlab, free run", free_run), Fitter("tendonlab, injection, then free run", injection_first))
PEERS = (
    Fitter(
        "least_squares lm + numbalsoda 1e-9",
        partial(least_squares, method="lm", tolerance=1e-9, step=1e-5),
        soda.NEEDS,
    ),
    Fitter(
        "least_squares lm + numbalsoda 1e-7",
        partial(least_squares, method="lm", tolerance=1e-7, step=1e-3),
        soda.NEEDS,
    ),
    Fitter(
        "least_squares trf + numbalsoda 1e-9",
        partial(least_squares, method="trf", tolerance=1e-9, step=1e-5),
        soda.NEEDS,
    ),
    Fitter(
        "least_squares lm + scipy LSODA 1e-8",
        partial(least_squares, method="lm", tolerance=1e-8, step=1e-4, by_scipy=True),
        ("numba",),
        3,
    ),
    Fitter("Nelder-Mead + numbalsoda 1e-6", partial(nelder_mead, tolerance=1e-6), soda.NEEDS, 3),
)

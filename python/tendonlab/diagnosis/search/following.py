"""The start of a refit: the effect as the screen found it, with all else as far as it imitates the effect.

The screen promises what an effect brings once the parameters, and the own unknowns of each run, follow. Where they
imitate most of it, an effect beside what stays leaves far more than no effect at all, and a fit from there may end in
another optimum."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tendonlab.diagnosis.search.screen import marginal, whitened_at
from tendonlab.diagnosis.search.swap import extended
from tendonlab.fitting.fitted import Fitted, solved
from tendonlab.fitting.problem import Fitter
from tendonlab.simulation.system import System

SHARES = (1.0, 0.5)  # of the step that follows from the slopes: what bends may go too far

Owns = tuple[tuple[float, ...], ...]  # the own unknowns of each training experiment


@np.errstate(over="ignore", invalid="ignore")  # derivatives may explode
def followed(fitter: Fitter, base: Fitted, effect: str, values: Mapping[str, float]) -> tuple[System, Owns]:
    """The model with `effect` at these `values`, and the own unknowns of each training experiment: with the free
    parameters of `base` where they are or where they follow to, whichever leaves least, and these unknowns alike."""
    base, plain = base.counted(), extended(base.system, {effect: values})
    if any(f.name not in plain.parameters for f in base.free):  # a whole friction took the place of others
        return plain, base.initial
    (seen,) = whitened_at(fitter, base, [plain])
    if isinstance(seen, str):
        return plain, base.initial
    residual, jacobian = base.rows
    step = -solved(base.precision, (marginal(base, seen) - residual) @ jacobian)
    if not np.isfinite(step).all():  # derivatives that exploded tell nothing
        return plain, base.initial
    coordinates = [base.x, *(base.x + share * step for share in SHARES)]
    systems = [plain, *(_at(base, plain, x) for x in coordinates[1:])]
    rows = [seen, *whitened_at(fitter, base, systems[1:])]
    cost = [np.inf if isinstance(r, str) else _cost(base, x, r) for x, r in zip(coordinates, rows, strict=True)]
    best = int(np.argmin(cost))
    left = rows[best]
    return systems[best], base.initial if isinstance(left, str) else _owns(fitter, base, systems[best], left)


def _at(base: Fitted, system: System, x: np.ndarray) -> System:
    """The system with the free parameters of `base` at these coordinates."""
    return system.with_parameters({f.name: f.value(float(at)) for f, at in zip(base.free, x, strict=True)})


def _cost(base: Fitted, x: np.ndarray, left: list[np.ndarray]) -> float:
    """Of what is `left` of each run, and of what is believed of the free parameters of `base` at these coordinates."""
    residual = marginal(base, left)
    away = np.array([(at - f.mean) / f.sd for f, at in zip(base.free, x, strict=True)])
    cost = 0.5 * float(residual @ residual + away @ away)
    return cost if np.isfinite(cost) else np.inf


def _owns(fitter: Fitter, base: Fitted, system: System, left: list[np.ndarray]) -> Owns:
    """The own unknowns of each run where they follow to, as far as that lowers what is `left` of the run."""
    case, owns = fitter.case, list(base.initial)
    for t, (i, run, before) in enumerate(zip(case.train, base.runs, left, strict=True)):
        if not len(run.own):
            continue
        information = run.by_own.T @ run.by_own + np.eye(len(run.own))
        step = -solved(information, run.by_own.T @ before + run.own)
        if not np.isfinite(step).all():
            continue
        moved = tuple((np.array(owns[t]) + case.own_sd(i) * step).tolist())
        outputs, (trouble,) = case.run_together(i, [system], moved)
        if trouble:
            continue
        after, own = fitter.whitening[i].residual(outputs[0]), run.own + step
        if after @ after + own @ own < before @ before + run.own @ run.own:
            owns[t] = moved
    return tuple(owns)

"""Friction that all runs share belongs to the parameters, not to what differs from run to run.

Scaling an element's friction and dividing its factors in all runs by as much changes no residual, only beliefs. A fit
that takes the residuals down from afar may end with all factors on one side: the beliefs' slope along that valley is
next to nothing beside the residuals' walls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tendonlab._core import Free
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.simulation.system import System

WORTH = 0.5  # nats that the beliefs must gain
FARTHEST = 1.0  # of the logarithm of a common factor


def centred(case: Case, fit: Fitted, tightness: float) -> tuple[System, list[list[float]]] | None:
    """The system and the experiments' own unknowns of the `fit`, with the common factor of each element's friction
    where the beliefs want it; None where they gain nothing. `tightness`: of the sd of the factors, as the fit had it.
    """
    values, initial, gained = dict(fit.system.parameters), [list(own) for own in fit.initial], 0.0
    for g, (group, sd) in enumerate(case.scatter):
        scaled = _scaled(case, fit, group)
        places = [len(case.prepared[i].initial) + g for i in case.train]
        factors = np.array([own[at] for own, at in zip(initial, places, strict=True)])
        if not scaled:
            continue
        shift, gain = _best_shift(scaled, values, factors, sd * tightness)
        gained += gain
        for free in scaled:
            values[free.name] *= float(np.exp(shift))
        for own, at in zip(initial, places, strict=True):
            own[at] -= shift
    return (fit.system.with_parameters(values), initial) if gained > WORTH else None


def _scaled(case: Case, fit: Fitted, group: Sequence[int]) -> list[Free]:
    """The free parameters that the factor of a group scales; none where it scales one that is not free, or that is
    stated otherwise in an experiment."""
    rows, values = fit.system.info.parameters, fit.system.parameters
    names = {rows[k].name for k in group if values.get(rows[k].name, 0.0) != 0.0}
    trained = [case.experiments[i] for i in case.train]
    stated = {name for e in trained for name in (*e.conditions, *e.add)}
    free = [f for f in fit.free if f.name in names]
    return free if len(free) == len(names) and not names & stated else []


def _best_shift(
    scaled: Sequence[Free], values: dict[str, float], factors: np.ndarray, sd: float
) -> tuple[float, float]:
    """The logarithm of the common factor that suits beliefs best, within all bounds, and the nats that it gains."""
    from scipy.optimize import minimize_scalar

    def cost(shift: float) -> float:
        away = [(f.coordinate(values[f.name] * float(np.exp(shift))) - f.mean) / f.sd for f in scaled]
        return 0.5 * float(np.sum(np.square((factors - shift) / sd)) + np.sum(np.square(away)))

    low, high = -FARTHEST, FARTHEST
    for f in scaled:
        ends = (f.lower / values[f.name], f.upper / values[f.name])
        least, most = min(ends), max(ends)
        low = max(low, float(np.log(least))) if least > 0.0 else low
        high = min(high, float(np.log(most)))
    if not low < 0.0 < high:
        return 0.0, 0.0
    shift = float(minimize_scalar(cost, bounds=(low, high), method="bounded", options={"xatol": 1e-6}).x)
    gain = cost(0.0) - cost(shift)
    return (shift, gain) if gain > 0.0 else (0.0, 0.0)

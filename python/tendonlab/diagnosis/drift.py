"""Whether friction changed steadily over the session, as that of a rig does that warms up, wears or loosens."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from math import factorial

import numpy as np

from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import PLAIN, Fitter, initial_state

Factors = Mapping[int, Sequence[float]]  # logarithms of the factors on friction of each element, by experiment

RARE = 0.01  # chance of such a trend in any other order of the runs, below which it is none
LEAST = 0.03  # change over the session, relative: what friction may differ by from run to run, and a half more
SETTLING = (0.1, 0.2, 0.4, 0.8)  # time constants of trends that die out, as shares of the session
MOST_ORDERS = 5040  # of the runs that are tried: all of seven, some of more


@dataclass(frozen=True)
class Drift:
    """A trend of the friction of `element` over the session. `change`: of the friction of the last run over that of
    the first, relative. `chance`: share of the orders of the runs in which a trend would fit the friction of some
    element as well."""

    element: str
    change: float
    chance: float

    @property
    def tells(self) -> bool:
        """Whether the trend is neither chance nor too small to matter."""
        return self.chance <= RARE and abs(self.change) >= LEAST


def over_session(case: Case, model: Fitted, held_out: Factors | None = None) -> Drift | None:
    """The least likely trend of the factors that `model` needs on friction from run to run, those of experiments
    `held_out` included; None where the dataset does not state when each of these started, or nothing differs."""
    num = len(case.scatter)
    of = {i: own[len(own) - num :] for i, own in zip(case.train, model.initial, strict=True)} | dict(held_out or {})
    starts = [case.experiments[i].start for i in of]
    stated = [start for start in starts if start is not None]
    if len(stated) < len(starts) or np.ptp(stated) == 0.0:
        return None
    elements = [case.system.info.parameters[group[0]].element or "" for group, _ in case.scatter]
    factors = np.array(list(of.values())).T
    differ = [k for k, own in enumerate(factors) if np.ptp(own) > 0.0]
    if not differ:
        return None
    chances, changes = trends(np.array(stated), factors[differ])
    found = [
        Drift(elements[k], float(np.expm1(change)), float(chance))
        for k, chance, change in zip(differ, chances, changes, strict=True)
    ]
    telling = [drift for drift in found if drift.tells]
    return min(telling or found, key=lambda drift: drift.chance)


def held_out_factors(fitter: Fitter, model: Fitted) -> Factors:
    """Logarithms of the factors on the friction of each element that suit held-out experiments best, by experiment;
    none where `model` cannot be simulated there, or nothing says when each experiment started."""
    case = fitter.case
    own = [0.0] * len(case.scatter)
    if not own or not case.test or any(case.experiments[i].start is None for i in (*case.train, *case.test)):
        return {}
    others = replace(fitter, case=case.training_on(case.test))
    try:
        initial = [[*initial_state(case, model.system, i), *own] for i in case.test]
        fit = others.fit(model.system, initial=initial, known=True, tolerance=PLAIN)
    except NumericalError:
        return {}
    return {i: unknowns[len(unknowns) - len(own) :] for i, unknowns in zip(case.test, fit.initial, strict=True)}


def trends(start: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For each row of `values`, (elements, runs): how often some row would follow a straight line or a settling one
    over `start` as closely, were the runs in another order, and its change along the closest one from the first start
    to the last. Rows that change together count as one that way (Westfall and Young 1993)."""
    curves = _curves(start)
    away = values - np.mean(values, axis=1, keepdims=True)
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    fits = away @ curves.T
    closest = np.argmax(np.abs(fits), axis=1)
    rows = np.arange(len(values))
    orders = _orders(len(start))
    others = np.max([np.max(np.abs(curves @ row[orders].T), axis=0) for row in away], axis=0)
    chances = np.mean(others >= np.abs(fits[rows, closest])[:, None] * (1.0 - 1e-9), axis=1)
    along = fits[rows, closest][:, None] * curves[closest]
    along *= np.linalg.norm(values - np.mean(values, axis=1, keepdims=True), axis=1, keepdims=True)
    return np.asarray(chances), np.asarray(along[:, np.argmax(start)] - along[:, np.argmin(start)])


def _curves(start: np.ndarray) -> np.ndarray:
    """Trends of mean 0 and length 1, (trends, runs)."""
    since = (start - np.min(start)) / np.ptp(start)
    curves = np.array([since, *(np.exp(-since / settling) for settling in SETTLING)])
    curves -= np.mean(curves, axis=1, keepdims=True)
    return np.asarray(curves / np.linalg.norm(curves, axis=1, keepdims=True))


def _orders(num: int) -> np.ndarray:
    """Orders of `num` runs, (orders, runs): all of them, or as many random ones behind the one that they have."""
    if factorial(num) <= MOST_ORDERS:
        return np.array(list(permutations(range(num))))
    random = np.random.default_rng(0)
    return np.array([range(num), *(random.permutation(num) for _ in range(MOST_ORDERS - 1))])

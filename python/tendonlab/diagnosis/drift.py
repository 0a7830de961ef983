"""Whether friction changed steadily over the session, as that of a rig does that warms up, wears or loosens."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from math import factorial

import numpy as np

from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted

RARE = 0.01  # chance of such a trend in any other order of the runs, below which it is none
LEAST = 0.03  # change over the session, relative: what friction may differ by from run to run, and a half more
SETTLING = (0.1, 0.2, 0.4, 0.8)  # time constants of trends that die out, as shares of the session
MOST_ORDERS = 5040  # of the runs that are tried: all of seven, some of more


@dataclass(frozen=True)
class Drift:
    """A trend of the friction of `element` over the session. `change`: of the friction of the last run over that of
    the first, relative. `chance`: share of the orders of the runs in which a trend would fit as well, times the number
    of elements that were looked at."""

    element: str
    change: float
    chance: float

    @property
    def tells(self) -> bool:
        """Whether the trend is neither chance nor too small to matter."""
        return self.chance <= RARE and abs(self.change) >= LEAST


def over_session(case: Case, model: Fitted) -> Drift | None:
    """The least likely trend of the factors that `model` needs on friction from run to run; None where the dataset
    does not state when each training experiment started, or nothing differs."""
    starts = [case.experiments[i].start for i in case.train]
    stated = [start for start in starts if start is not None]
    if len(stated) < len(starts) or np.ptp(stated) == 0.0:
        return None
    found = []
    for k, (group, _) in enumerate(case.scatter):
        factors = np.array([own[len(own) - len(case.scatter) + k] for own in model.initial])
        if np.ptp(factors) > 0.0:
            chance, change = trend(np.array(stated), factors)
            element = case.system.info.parameters[group[0]].element or ""
            found.append(Drift(element, float(np.expm1(change)), min(1.0, chance * len(case.scatter))))
    telling = [drift for drift in found if drift.tells]
    return min(telling or found, key=lambda drift: drift.chance, default=None)


def trend(start: np.ndarray, value: np.ndarray) -> tuple[float, float]:
    """How often another order of the values would follow a straight line or a settling one over `start` as closely,
    and the change along the closest one from the first start to the last."""
    curves = _curves(start)
    away = value - np.mean(value)
    fits = curves @ away
    closest = int(np.argmax(np.abs(fits)))
    others = np.max(np.abs(curves @ away[_orders(len(value))].T), axis=0)
    along = fits[closest] * curves[closest]
    as_close = np.mean(others >= np.abs(fits[closest]) * (1.0 - 1e-9))
    return float(as_close), float(along[np.argmax(start)] - along[np.argmin(start)])


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

"""How far a fit pulls parameters from what was stated of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tendonlab._core import Free
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted

BROAD = 0.3  # stated sd, of the value, beyond which the value is known to a factor, as its prior in fits has it
VANISHED = 1e-6  # of the stated value: less says 0 on a logarithmic scale, where nothing stops a fit


class Pulled(NamedTuple):
    """A parameter whose uncertainty was stated: its fitted and stated `value`, SI, the stated `sd`, and by how many of
    these it was pulled away; `by_factor`: whether that counts in its logarithm."""

    name: str
    value: float
    stated: float
    sd: float
    away: float
    by_factor: bool = False


def pulled(case: Case, fitted: Fitted) -> list[Pulled]:
    """Every fitted parameter whose uncertainty was stated."""
    found = []
    for free, x in zip(fitted.free, fitted.x, strict=True):
        stated = case.dataset.parameters.get(free.name)
        if stated is not None and stated.sd and np.isfinite(stated.sd):
            value = 0.0 if has_vanished(free, float(x)) else free.value(float(x))
            away, factor = abs(value - stated.value) / stated.sd, abs(float(x) - free.mean) / free.sd
            by_factor = free.log and stated.sd > BROAD * stated.value and factor < away
            found.append(Pulled(free.name, value, stated.value, stated.sd, factor if by_factor else away, by_factor))
    return found


def has_vanished(free: Free, x: float) -> bool:
    """Whether the logarithm of a parameter fell so far that its value is 0."""
    return free.log and free.value(x) < VANISHED * free.scale


def strain(case: Case, fitted: Fitted) -> float:
    """By how many stated standard deviations the parameter was pulled that was pulled farthest."""
    return max((of.away for of in pulled(case, fitted)), default=0.0)

"""What is believed of the simulator's parameters, as values to draw simulated rigs from."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tendonlab.data import NominalParameter
from tendonlab.fitting.priors import LOG_SD, Scale, free_parameters
from tendonlab.simulation.system import System

FARTHEST = 2.0  # sd: rigs farther from the nominal values are not drawn


@dataclass(frozen=True)
class Belief:
    """A parameter and how far it may be from its nominal `value`: `sd` in the logarithm where `log`, else in its own
    unit."""

    name: str
    value: float
    sd: float
    log: bool
    lower: float
    upper: float

    def draw(self, random: np.random.Generator) -> float:
        """One value within two sd of the nominal one and within the bounds."""
        step = self.sd * float(np.clip(random.normal(), -FARTHEST, FARTHEST))
        drawn = self.value * math.exp(step) if self.log else self.value + step
        return min(max(drawn, self.lower), self.upper)


def beliefs_of(
    system: System, nominal: Mapping[str, NominalParameter], scales: Mapping[str, Scale]
) -> tuple[Belief, ...]:
    """The prior of the fit for every free parameter (docs/method.md). A parameter without a stated `sd` that may be
    negative varies by 0.3 of its value, so that what the simulator has at 0 stays 0."""
    found = []
    for free in free_parameters(system, nominal, scales):
        stated = nominal[free.name]
        known = stated.sd is not None and math.isfinite(stated.sd)
        usual = LOG_SD if free.log else LOG_SD * abs(stated.value)
        prior = free.sd if free.log else free.sd * free.scale
        by_default = free.log and stated.sd is None
        sd = prior if known or by_default else usual
        found.append(Belief(free.name, stated.value, sd, free.log, free.lower, free.upper))
    return tuple(found)

"""The cable of the twin: a spring whose fibres straighten before they stretch (G4 of the paper's gaps)."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

from scipy.optimize import brentq

from tendonlab.papers.s2.values import Constants


@dataclass(frozen=True)
class Spring:
    """Tension of one cable: from its natural length a parabola up to the tension `toe`, N, from there a line of
    stiffness K. The paper leaves out what it measured below 200 N (S2 sec. IV-B.2); the parabola is reconstructed.

    Elongations, m, count from the state preloaded to T. Below its natural length the line goes on: it is for whoever
    asks to cut it off there."""

    of: Constants
    toe: float = 0.0

    @property
    def span(self) -> float:
        """Elongation from the natural length to the end of the toe, m."""
        return 2.0 * self.toe / self.of.K

    @property
    def preloaded(self) -> float:
        """Elongation from the natural length to the preloaded state, m."""
        if self.toe > self.of.T:
            return self.span * sqrt(self.of.T / self.toe)
        return self.span + (self.of.T - self.toe) / self.of.K

    def pull(self, elongation: float) -> tuple[float, float]:
        """Tension, N, and stiffness, N/m."""
        length, span, stiffness = elongation + self.preloaded, self.span, self.of.K
        if 0.0 < length < span:
            share = length / span
            return self.toe * share * share, stiffness * share
        return (self.toe if length > 0.0 else 0.0) + stiffness * (length - (span if length > 0.0 else 0.0)), stiffness

    def holding(self, difference: float) -> float:
        """By how much one of two cables is longer and the other shorter, m, where they pull by `difference`, N."""
        widest = 2.0 * self.span + (self.of.T + abs(difference)) / self.of.K
        return float(brentq(lambda e: self.pull(e)[0] - self.pull(-e)[0] - difference, -widest, widest, xtol=1e-15))

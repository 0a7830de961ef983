"""How joint 2 is driven: an angle with its own rate; differences of a quantised one would shake the contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from tendonlab.papers.tables import table


@dataclass(frozen=True, kw_only=True)
class Drive:
    """theta_2(t) = A sin(omega t), times 1 - exp(-(t / soft_start)^ease) where soft_start is not 0.

    `amplitude` A, rad; `omega`, rad/s; `soft_start`, s: without it the rate jumps at t = 0 and joint 1 rings; with an
    `ease` of 1 the acceleration still does, with 2 it does not."""

    amplitude: float
    omega: float
    soft_start: float = 0.0
    ease: int = 1

    def angle(self, t: Any) -> Any:
        """theta_2, rad, at time t, s: a number or an array."""
        return self.amplitude * np.sin(self.omega * t) * self._share(t)

    def rate(self, t: Any) -> Any:
        """Its rate, rad/s."""
        rate = self.amplitude * self.omega * np.cos(self.omega * t) * self._share(t)
        if self.soft_start > 0:
            s = t / self.soft_start
            grows = self.ease * s ** (self.ease - 1) * np.exp(-(s**self.ease)) / self.soft_start
            rate = rate + self.amplitude * np.sin(self.omega * t) * grows
        return rate

    def reversals(self, end: float) -> np.ndarray:
        """Instants in (0, end), s, at which joint 2 turns round; the soft start moves them."""
        from scipy.optimize import brentq

        t = np.linspace(0.0, end, 1 + round(64 * end * self.omega / (2 * np.pi) + 64))
        rate = self.rate(t)
        turns = np.flatnonzero(rate[:-1] * rate[1:] < 0)
        return np.array([brentq(self.rate, t[i], t[i + 1], xtol=1e-15) for i in turns])

    def _share(self, t: Any) -> Any:
        return 1.0 - np.exp(-((t / self.soft_start) ** self.ease)) if self.soft_start > 0 else 1.0


def printed_drive(*, period: float | None = None, soft_start: float = 0.0) -> Drive:
    """The paper's input, 10 sin(0.5 pi t) in degrees (10 rad would unwind the cables), or one of `period`, s."""
    rows = table("S4_table2_parameters").set_index("symbol")["value"].astype(float)
    omega = float(rows["omega"]) if period is None else 2 * np.pi / period
    return Drive(amplitude=math.radians(rows["A"]), omega=omega, soft_start=soft_start)

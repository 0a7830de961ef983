"""Ball bearings of the idle pulleys: the constructor's law of their friction torque (S1 eqs 7, 8)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tendonlab.errors import ParameterError

RPM = np.pi / 30.0  # rad/s


@dataclass(frozen=True, kw_only=True)
class BallBearing:
    """A ball bearing: it holds torques up to alpha_b p at rest, and resists with beta_b p + h(n) when it turns.

    `alpha_b`, `beta_b`: torque per load p, m. `viscosity` of the oil, mm²/s, `mean_diameter`, mm, and the factor `f0`
    are those of the constructor's catalogue; h is in N·m and n in rad/s all the same. The law jumps by 0.8 % at its
    transition speed; `continuous` closes that. Raises ParameterError. Source: S1 eqs 7, 8 (Palmgren's law)."""

    f0: float
    viscosity: float
    mean_diameter: float
    alpha_b: float = 0.0
    beta_b: float = 0.0
    continuous: bool = False

    def __post_init__(self) -> None:
        for name, lowest in (("f0", 0), ("viscosity", 1e-300), ("mean_diameter", 0), ("alpha_b", 0), ("beta_b", 0)):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= lowest):
                raise ParameterError(f"{name} = {value}: expected a number of at least {lowest}")

    @property
    def transition_speed(self) -> float:
        """n0, rad/s: from there on the oil film decides."""
        return 2000.0 / self.viscosity * RPM

    def speed_torque(self, speed: ArrayLike) -> np.ndarray:
        """h with the sign of `speed`, N·m, at `speed`, rad/s; 0 at rest. Source: S1 eq. 8."""
        n = np.asarray(speed, dtype=float)
        volume = 1e-3 * 1e-7 * self.f0 * self.mean_diameter**3  # N·m
        film = volume * (self.viscosity * np.abs(n) / RPM) ** (2 / 3)
        slow = volume * (2000.0 ** (2 / 3) if self.continuous else 160.0)
        return np.asarray(np.sign(n) * np.where(np.abs(n) < self.transition_speed, slow, film))

    def torque(self, speed: ArrayLike, load: ArrayLike, *, external_torque: ArrayLike = 0.0) -> np.ndarray:
        """Friction torque, N·m, at `speed`, rad/s, under `load` p, N. At rest it balances `external_torque`, N·m, up to
        alpha_b p: what exceeds that sets the bearing in motion. Source: S1 eq. 7."""
        n, p = np.asarray(speed, dtype=float), np.abs(np.asarray(load, dtype=float))
        held = np.clip(external_torque, -self.alpha_b * p, self.alpha_b * p)
        return np.where(n == 0, held, np.sign(n) * self.beta_b * p + self.speed_torque(n))

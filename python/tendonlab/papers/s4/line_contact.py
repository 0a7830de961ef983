"""One contact of a cable with a pulley, from the library's laws: S4 eqs (27) to (29), alone and driven by a log."""

from __future__ import annotations

from typing import Any

import numpy as np

from tendonlab._core import friction, transmission
from tendonlab.papers.s4.constants import Contact

Array = Any  # a number or an array of numbers


class LineContactLuGre:
    """LuGre friction whose level follows the capstan relation: f = sigma_0 z + sigma_1 z' + sigma_2 v = T_in - T_out.

    v: slip, m/s, positive towards the middle section, whose tension is T_in, N; `wrap`, rad; z: bristle deflection, m.
    Where `of.mu_back` is given the friction coefficients differ by direction."""

    def __init__(self, of: Contact) -> None:
        self.of = of
        back = of.mu_c if of.mu_back is None else of.mu_back
        ratio = of.mu_s / of.mu_c
        self._forwards, self._backwards = (
            (
                transmission.Capstan(friction_coefficient=mu, smallest_level=of.eps),
                transmission.Stribeck(
                    friction_coefficient=mu, static_friction_coefficient=ratio * mu, stribeck_velocity=of.v_s
                ),
            )
            for mu in (of.mu_c, back)
        )
        self._bristle = friction.Presliding(bristle_stiffness=of.sigma_0, bristle_damping=of.sigma_1)
        self._viscous = friction.Viscous(viscous=of.sigma_2)

    def level(self, v: Array, T_in: Array, wrap: Array) -> Array:
        """f_c, N (S4 eq. 28): larger for v < 0, where the cable drags itself tighter; eps at rest."""
        return np.where(
            np.asarray(v) < 0, *(law[0].level(velocity=v, load=T_in, wrap_angle=wrap) for law in self._both)
        )

    def g(self, v: Array, T_in: Array, wrap: Array) -> Array:
        """Level with the Stribeck excess, N (S4 eqs 27, 29)."""
        return self.level(v, T_in, wrap) * np.where(
            np.asarray(v) < 0, *(law[1].factor(velocity=v) for law in self._both)
        )

    def rate(self, z: Array, v: Array, T_in: Array, wrap: Array) -> Array:
        """z', m/s (S4 eq. 27)."""
        return self._bristle.rate(velocity=v, deflection=z, level=self.g(v, T_in, wrap))

    def force(self, z: Array, v: Array, T_in: Array, wrap: Array) -> Array:
        """f, N (S4 eq. 27)."""
        bristle = self._bristle.force(velocity=v, deflection=z, level=self.g(v, T_in, wrap))
        return bristle + self._viscous.force(velocity=v)

    def steady_force(self, v: Array, T_in: Array, wrap: Array) -> Array:
        """f, N, in steady slip: g sign(v) + sigma_2 v."""
        return self.g(v, T_in, wrap) * np.sign(v) + self._viscous.force(velocity=v)

    def follow(self, time: np.ndarray, v: np.ndarray, T_in: np.ndarray, wrap: np.ndarray) -> np.ndarray:
        """Friction, N, along a measured motion and tension (S4 Fig. 14b), from an unloaded bristle; shape of `time`.

        v and g are taken as their means over each interval; the bristle is then exact: it decays to its steady value
        as exp(-sigma_0 |v| dt / g)."""
        mean = [0.5 * (x[1:] + x[:-1]) for x in (np.asarray(v), np.asarray(T_in), np.asarray(wrap))]
        g = self.g(*mean)
        settled = g * np.sign(mean[0]) / self.of.sigma_0
        left = np.exp(-self.of.sigma_0 * np.abs(mean[0]) * np.diff(time) / g)
        z = np.zeros(len(time))
        for i in range(len(left)):
            z[i + 1] = settled[i] + (z[i] - settled[i]) * left[i]
        return np.asarray(self.force(z, v, T_in, wrap))

    @property
    def _both(self) -> tuple[Any, Any]:
        return self._backwards, self._forwards

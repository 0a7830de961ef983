"""The two links of a joint of two equal geared rotations: the second turns by twice the angle of the first."""

from __future__ import annotations

import numpy as np

from tendonlab.blind.description import Array, Lanes


class Links:
    """Inertia and weight of n lanes; all by the angle of the first link from the base, rad, (n,)."""

    def __init__(self, lanes: Lanes) -> None:
        get = lanes.get
        near, length, far = get("link_1_center"), get("link_1_length"), get("link_2_center")
        mass, tip = get("link_1_mass"), get("link_2_mass")
        self.fixed = get("link_1_inertia") + 4.0 * get("link_2_inertia") + mass * near**2
        self.fixed = self.fixed + tip * (length**2 + 4.0 * far**2)
        self.coupling = 2.0 * tip * length * far
        self.one, self.two = get("gravity") * (mass * near + tip * length), get("gravity") * tip * far
        self.tilt = get("mounting_angle")

    def inertia(self, angle: Array) -> Array:
        """kg*m^2: both links on a lever that folds."""
        return np.asarray(self.fixed + 2.0 * self.coupling * np.cos(angle))

    def whirl(self, angle: Array) -> Array:
        """Torque per squared velocity, kg*m^2: half of what the inertia loses per angle."""
        return np.asarray(self.coupling * np.sin(angle))

    def weight(self, angle: Array) -> Array:
        """Torque of gravity, N*m: against the slope of the potential m g y of both links."""
        return np.asarray(-self.one * np.cos(angle + self.tilt) - 2.0 * self.two * np.cos(2.0 * angle + self.tilt))

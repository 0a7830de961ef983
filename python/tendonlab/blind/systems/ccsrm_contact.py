"""Friction of cables on pulleys, four contacts of many lanes at once, (4, n): 11, 12, 21, 22, slip positive towards the
middle section of the cable:

    friction = sigma0 z + sigma1 z' + sigma2 v,    z' = v - sigma0 |v| z / level
    level    = (T |1 - exp(-mu wrap sign v)| + coulomb + load_dependence T) (1 + excess exp(-(v/v_s)^2))

T: tension of the middle section. A lane whose `form` is not 0 uses another functional form of its effect. Nothing here
is shared with the library under test.
"""

from __future__ import annotations

import numpy as np

from tendonlab.blind.description import Array, Lanes
from tendonlab.blind.friction import ASYMMETRY_GROWTH, COULOMB_FADE, LOAD_POWER, VISCOUS_POWER
from tendonlab.blind.unknown import bump, contact_age, dwell

SMALLEST_LEVEL = 1e-3  # N, of a slack cable
USUAL_SPEED, USUAL_TENSION = 0.01, 50.0  # m/s, N


class Contacts:
    """The laws of n lanes and their bristles, z, m; relaxed at first."""

    def __init__(self, lanes: Lanes, step: float) -> None:
        get = lanes.get
        self.step, self.scale = step, lanes.scale[0]
        self.kinetic = get("contact_kinetic")
        self.excess, self.falloff = get("contact_excess"), _or_one(get("contact_stribeck_velocity"))
        self.sigma0, self.sigma1 = get("contact_bristle_stiffness"), get("contact_bristle_damping")
        self.sigma2 = get("contact_viscous") * self.scale
        self.coulomb, self.load_dependence = get("contact_coulomb"), get("contact_load_dependence")
        self.asymmetry = get("contact_asymmetry")
        named = lanes.effect or ("",) * lanes.size
        self.other = {
            effect: (lanes.form != 0) & np.array([name == f"contact:{effect}" for name in named], dtype=bool)
            for effect in ("viscous", "stribeck", "coulomb", "load_dependence", "asymmetry")
        }
        self.bump, self.bump_angle, self.bump_width = get("bump"), get("bump_angle"), _or_one(get("bump_width"))
        self.dwell, self.dwell_time = get("dwell"), _or_one(get("dwell_time"))
        self.dwell_distance = _or_one(get("dwell_distance"))
        self.has = {
            name: bool(np.any(value))
            for name, value in [
                ("asymmetry", self.asymmetry),
                ("coulomb", self.coulomb),
                ("load_dependence", self.load_dependence),
                ("excess", self.excess),
                ("bump", self.bump),
                ("dwell", self.dwell),
                ("bent", self.other["viscous"]),
            ]
        }
        self.z, self.age = np.zeros((4, lanes.size)), np.zeros((4, lanes.size))

    def level(self, slip: Array, *, tension: Array, wrap: Array, angle: Array) -> Array:
        """Dry friction level, N, of all contacts; `angle`: of the pulley under each, rad."""
        direction, speed = np.where(slip < 0, -1.0, 1.0), np.abs(slip)
        mu = self.kinetic
        if self.has["asymmetry"]:
            growth = 1.0 + self.other["asymmetry"] * ASYMMETRY_GROWTH * speed / (speed + USUAL_SPEED)
            mu = mu * (1.0 + self.asymmetry * direction * growth)
        level = tension * np.abs(np.expm1(-mu * wrap * direction)) + SMALLEST_LEVEL
        if self.has["coulomb"]:
            level = level + self.coulomb * (1.0 - self.other["coulomb"] * COULOMB_FADE * speed / (speed + USUAL_SPEED))
        if self.has["load_dependence"]:
            bent = USUAL_TENSION * np.power(tension / USUAL_TENSION, LOAD_POWER)
            level = level + self.load_dependence * np.where(self.other["load_dependence"], bent, tension)
        if self.has["excess"]:
            square = np.square(slip / self.falloff)
            decay = np.where(self.other["stribeck"], 1.0 / (1.0 + square), np.exp(-square))
            level = level * (1.0 + self.excess * decay)
        level = level * self.scale
        if self.has["bump"]:
            level[::2] *= bump(angle[::2], height=self.bump, at=self.bump_angle, width=self.bump_width)
        if self.has["dwell"]:
            level = level * dwell(self.age, share=self.dwell, time=self.dwell_time)
        return np.asarray(np.maximum(level, SMALLEST_LEVEL))

    def force(self, slip: Array, level: Array) -> tuple[Array, Array]:
        """Friction, N, at the end of a step with this slip, m/s, and its slope over slip, N*s/m."""
        h, stiff = self.step, self.step * self.sigma0 / level
        below = 1.0 + stiff * np.abs(slip)
        z = (self.z + h * slip) / below  # implicit: never overshoots the level
        slope = (h - z * stiff * np.sign(slip)) / below
        drag, more = self.sigma2 * slip, self.sigma2
        if self.has["bent"]:
            bent = np.power(np.abs(slip) / USUAL_SPEED + 1e-9, VISCOUS_POWER - 1.0)
            bent = np.where(self.other["viscous"], bent, 1.0)
            drag, more = drag * bent, more * bent
        force = self.sigma0 * z + self.sigma1 * (z - self.z) / h + drag
        return force, (self.sigma0 + self.sigma1 / h) * slope + more

    def advance(self, slip: Array, level: Array) -> None:
        """Bristles and ages after a step."""
        self.z = (self.z + self.step * slip) / (1.0 + self.step * self.sigma0 * np.abs(slip) / level)
        if self.has["dwell"]:
            self.age = contact_age(self.age, np.abs(slip), distance=self.dwell_distance, step=self.step)


def _or_one(value: Array) -> Array:
    """Where a lane lacks the law, any number will do."""
    return np.where(value > 0, value, 1.0)

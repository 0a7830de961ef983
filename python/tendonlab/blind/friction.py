"""Friction of the bodies of many lanes at once; arrays are (slots, n): of a two-inertia rig row 0 is the motor, row 1
the joint.

    friction = level(v) sign(v) + viscous v + viscous_asymmetry |v|
    level    = (coulomb + static_excess exp(-(v/stribeck_velocity)^2) + load_dependence |load|)
                   (1 + level_asymmetry sign v)

With presliding a LuGre bristle replaces the dry part: z' = v - sigma0 |v| z / level, F = sigma0 z + sigma1 z'. A
lane whose `form` is not 0 uses another functional form of its effect, so that a diagnosis with the laws above meets
a world that resembles them only. Nothing here is shared with the library under test.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .description import Slot

Array = NDArray[np.float64]

PARAMETERS = (
    "coulomb",
    "viscous",
    "static_excess",
    "stribeck_velocity",
    "bristle_stiffness",
    "bristle_damping",
    "load_dependence",
    "level_asymmetry",
    "viscous_asymmetry",
)
LOAD_POWER = 0.9
VISCOUS_POWER = 0.93
COULOMB_FADE = 0.08
ASYMMETRY_GROWTH = 0.3
DAHL_EXPONENT = 1.6
MAXWELL_STIFFNESS = (0.55, 0.3, 0.15)  # shares of bristle_stiffness and of the level, three elements
MAXWELL_LEVEL = (0.25, 0.35, 0.4)


@dataclass
class Bristle:
    """State of the presliding slots: LuGre deflection z, Dahl force, forces of three Maxwell slip elements, each
    (slots, n).
    """

    deflection: Array
    dahl: Array
    maxwell: list[Array]


class Friction:
    """The friction laws of n lanes. `parameters`: name -> (n,), `scale`: (slots, n) run-to-run factor, `form`: (n,)
    integers.
    """

    def __init__(
        self, parameters: Mapping[str, Array], *, slots: Sequence[Slot], scale: Array, form: NDArray[np.int64]
    ) -> None:
        zero = np.zeros(form.size)
        rows = {p: np.stack([parameters.get(f"{slot.name}_{p}", zero) for slot in slots]) for p in PARAMETERS}
        self.usual_speed = np.array([[slot.speed] for slot in slots])
        self.usual_load = np.array([[slot.load] for slot in slots])
        self.scale = scale
        self.coulomb, self.viscous = rows["coulomb"], rows["viscous"]
        self.excess, self.falloff = (
            rows["static_excess"],
            np.where(rows["stribeck_velocity"] > 0, rows["stribeck_velocity"], 1.0),
        )
        self.load_dependence = rows["load_dependence"]
        self.level_asymmetry, self.viscous_asymmetry = rows["level_asymmetry"], rows["viscous_asymmetry"]
        self.contact = parameters.get("contact_load_dependence", zero)
        self.sigma0, self.sigma1 = rows["bristle_stiffness"], rows["bristle_damping"]
        self.bristled = self.sigma0 > 0
        self.form, self.other = form, form[None, :] != 0
        self.has_stribeck, self.has_load = bool(np.any(self.excess)), bool(np.any(self.load_dependence))
        self.has_contact, self.has_bristle = bool(np.any(self.contact)), bool(np.any(self.bristled))
        self.has_asymmetry = bool(np.any(self.level_asymmetry) or np.any(self.viscous_asymmetry))
        self.faded = np.zeros_like(self.scale)
        self.bent = np.zeros_like(self.scale, dtype=bool)
        self.is_plain = not (
            self.has_stribeck or self.has_load or self.has_contact or self.has_bristle or self.has_asymmetry
        )

    def choose_other_form(self, slot: int, lanes: NDArray[np.bool_], *, effect: str) -> None:
        """Let `coulomb` fade with speed, or bend `viscous`, in one slot of the chosen lanes (their other functional
        form).
        """
        if effect == "coulomb":
            self.faded[slot, lanes] = COULOMB_FADE
        else:
            self.bent[slot, lanes] = True
        if np.any(lanes):
            self.is_plain = False

    def bristle(self) -> Bristle:
        """The relaxed state."""
        return Bristle(
            np.zeros_like(self.scale), np.zeros_like(self.scale), [np.zeros_like(self.scale) for _ in MAXWELL_LEVEL]
        )

    def smooth(self, velocity: Array) -> Array:
        """Friction that needs no sign at rest: viscous and its asymmetry, N*m, (slots, n)."""
        drag = self.viscous * velocity
        if self.bent.any():
            size = np.abs(velocity[self.bent]) / np.broadcast_to(self.usual_speed, velocity.shape)[self.bent]
            drag[self.bent] *= np.power(size + 1e-9, VISCOUS_POWER - 1.0)
        if self.has_asymmetry:
            size = np.abs(velocity)
            size = np.where(
                self.other, size * (1.0 + ASYMMETRY_GROWTH * self.usual_speed / (self.usual_speed + size)), size
            )
            drag += self.viscous_asymmetry * size
        return drag * self.scale

    def level(self, velocity: Array, *, load: Array, direction: Array) -> Array:
        """Dry friction level >= 0 of all slots, N*m, (slots, n); `direction` is the sign of (attempted) sliding."""
        level = self.coulomb
        if self.has_stribeck:
            square = np.square(velocity / self.falloff)
            level = level + self.excess * np.where(self.other, 1.0 / (1.0 + square), np.exp(-square))
        if self.has_load:
            size = np.abs(load)
            size = np.where(self.other, self.usual_load * np.power(size / self.usual_load, LOAD_POWER), size)
            level = level + self.load_dependence * size
        if self.faded.any():
            size = np.abs(velocity)
            level = level * (1.0 - self.faded * size / (size + self.usual_speed))
        if self.has_asymmetry:
            size = np.abs(velocity)
            growth = np.where(self.other, 1.0 + ASYMMETRY_GROWTH * size / (size + self.usual_speed), 1.0)
            level = level * (1.0 + self.level_asymmetry * direction * growth)
        return np.maximum(level * self.scale, 0.0)

    def contact_level(self, cable_torque: Array) -> Array:
        """Dry friction of the pulley contact, which acts on the joint, N*m, (n,)."""
        size = np.abs(cable_torque)
        size = np.where(self.form != 0, np.power(size, LOAD_POWER), size)
        level: Array = self.contact * size * self.scale[-1]
        return level

    def bristle_force(self, state: Bristle, velocity: Array, *, level: Array, step: float) -> Array:
        """Advance the presliding state by one step, s, and return its force, N*m; 0 in slots without presliding."""
        safe = np.where(self.bristled, np.maximum(level, 1e-12), 1.0)
        speed = np.abs(velocity)
        before = state.deflection
        # implicit in z: never overshoots the level, whatever the step
        state.deflection = (before + step * velocity) / (1.0 + step * self.sigma0 * speed / safe)
        force = self.sigma0 * state.deflection + self.sigma1 * (state.deflection - before) / step
        if np.any(self.form):
            left = 1.0 - state.dahl * np.sign(velocity) / safe
            rate = self.sigma0 * velocity * np.power(np.abs(left), DAHL_EXPONENT)
            state.dahl = np.clip(state.dahl + step * rate * np.sign(left), -safe, safe)
            force = np.where(self.form[None, :] == 1, state.dahl, force)
            stretch = step * self.sigma0 * velocity
            total = np.zeros_like(force)
            for i, (stiffness, share) in enumerate(zip(MAXWELL_STIFFNESS, MAXWELL_LEVEL, strict=True)):
                state.maxwell[i] = np.clip(state.maxwell[i] + stiffness * stretch, -share * safe, share * safe)
                total += state.maxwell[i]
            force = np.where(self.form[None, :] == 2, total, force)
        return np.where(self.bristled, force, 0.0)

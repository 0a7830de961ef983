"""Forces of the two cables in their bushings, N, by the angle of the joint and the sense in which it last moved.

    force = (forwards + backwards)/2 + sense (forwards - backwards)/2,   each: a + b T sin((theta - c)/2)   (S2 eq. 11)
    added levels, against the run of each cable: by wrap (sine, capstan) and those of `Friction` at the guided velocity
Where friction holds, a share of it follows the sense in which the nuts last moved; in the other form that share fades
while they rest. Nothing here is shared with the library under test.
"""

from __future__ import annotations

import numpy as np

from tendonlab.blind.description import Array, Lanes
from tendonlab.blind.friction import Friction
from tendonlab.blind.unknown import bump

REST_SPEED, REST_NUT = 1e-9, 1e-12  # rad/s of the joint, m/s of the nuts, up to which they rest
NAMES = ("bushing_1", "bushing_2")
RUNS = np.array([[1.0], [-1.0]])  # forwards of each cable as the joint turns forwards
AT_REST = 0.05  # rad of wrap that the other form of the sine has at angle 0
WRAP_POWER = 0.85  # of the other form of the capstan
FADING = 1.5  # s, in which what holds at rest fades in the other form


class Bushings:
    """The bushings of n lanes; rows are cables."""

    def __init__(self, lanes: Lanes, step: float) -> None:
        self.lanes, self.step, self.other = lanes, step, lanes.form != 0
        self.scale = lanes.scale[1:]
        self.a, self.b, self.c = (self._rows(names) for names in (("a1", "a2"), ("b", ""), ("c1", "c2")))
        self.sine, self.capstan = self._of("sine_coefficient"), self._of("capstan_coefficient")
        self.laws, self.has_laws = _friction(lanes), False
        for name in ("coulomb", "viscous", "static_excess"):
            self.has_laws |= bool(self._of(name).any())
        self.hold = lanes.get("stiction_hold")
        self.sense, self.nut_sense = np.ones(lanes.size), np.ones(lanes.size)
        self.rested = np.zeros(lanes.size)  # s

    def _of(self, name: str) -> Array:
        return np.stack([self.lanes.get(f"{bushing}_{name}") for bushing in NAMES])

    def _rows(self, names: tuple[str, str]) -> Array:
        """Numbers forwards and backwards, (2, 2, n); of the slopes also above and below, (2, 2, 2, n)."""
        if names[0] == "b":
            return np.stack([np.stack([self._of(f"b{i}{j}") for j in "12"]) for i in "12"])
        return np.stack([self._of(name) for name in names])

    def follow(self, velocity: Array, nut: Array) -> None:
        """Take the sense of the joint's velocity, rad/s, and of the nuts', m/s; at rest the last one stays."""
        self.sense = np.where(np.abs(velocity) > REST_SPEED, np.sign(velocity), self.sense)
        moves = np.abs(nut) > REST_NUT
        self.nut_sense = np.where(moves, np.sign(nut), self.nut_sense)
        self.rested = np.where(moves, 0.0, self.rested + self.step)

    def force(self, angle: Array, guided: Array, preload: Array) -> Array:
        """Force on each cable at the guided velocity, m/s, and `preload`, N, (2, n)."""
        moving = self._at(angle, guided, preload, self.sense)
        if not self.hold.any():
            return moving
        share = self.hold * np.where(self.other, np.exp(-self.rested / FADING), 1.0)
        return moving + share * (self._at(angle, guided, preload, self.nut_sense) - moving)

    def _at(self, angle: Array, guided: Array, preload: Array, sense: Array) -> Array:
        away = angle - self.c
        slope = np.where(away >= 0.0, self.b[:, 0], self.b[:, 1])
        forwards, backwards = self.a + slope * preload * np.sin(0.5 * away)
        common, level = 0.5 * (forwards + backwards), 0.5 * (forwards - backwards) * self.scale
        level = level + RUNS * self._wrapped(angle, preload) * self.scale
        if self.lanes.get("bump").any():
            width = self.lanes.get("bump_width")
            height, at = self.lanes.get("bump"), self.lanes.get("bump_angle")
            level = level * bump(angle, height=height, at=at, width=np.where(width > 0, width, 1.0))
        force = common + sense * level
        return np.asarray(force + self._rubbing(guided, sense) if self.has_laws else force)

    def _wrapped(self, angle: Array, preload: Array) -> Array:
        """Friction that grows with the wrap, N."""
        size = np.abs(angle)
        by_sine = np.where(self.other, np.hypot(np.sin(0.5 * angle), 0.5 * AT_REST), np.abs(np.sin(0.5 * angle)))
        wrap = np.where(self.other, 0.5 * np.power(2.0 * size, WRAP_POWER), size)
        return np.asarray(preload * (2.0 * self.sine * by_sine + np.expm1(self.capstan * wrap)))

    def _rubbing(self, guided: Array, sense: Array) -> Array:
        velocity, direction = RUNS * guided, RUNS * sense
        level = self.laws.level(velocity, load=np.zeros_like(velocity), direction=direction)
        return np.asarray(self.laws.smooth(velocity) + direction * level)


def _friction(lanes: Lanes) -> Friction:
    laws = Friction(lanes.parameters, slots=lanes.system.slots[1:], scale=lanes.scale[1:], form=lanes.form)
    for row, name in enumerate(NAMES):
        for effect in ("coulomb", "viscous"):
            chosen = np.array([of == f"{name}:{effect}" for of in lanes.effect] or np.zeros(lanes.size), dtype=bool)
            laws.choose_other_form(row, chosen & (lanes.form != 0), effect=effect)
    return laws

"""The two cables of a joint that nuts pull: what they carry, N, by their stretch beyond the preloaded state, m.

    tension = max(0, line(stretch) + c stretch')         line: T + K stretch, T at stretch 0
    toe     fibres that straighten first: a parabola from the natural length up to the toe's tension F_s, from there the
            line; in the other form the stiffness is K (1 - exp(-F/F_e)), F_e = F_s/3
    path    what the paths of both cables gain with the angle: (P/K) (1 - cos(theta)); in the other form a hyperbola
Creep and settling are unknown causes. Nothing here is shared with the library under test.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tendonlab.blind.description import Array, Lanes
from tendonlab.blind.unknown import creep

EARLY = 1.0 / 3.0  # of the toe's tension, in the other form
CORNER = 0.25  # rad, half width of the other form's hyperbola
PATH = (1.0 - np.cos(0.5)) / (np.hypot(0.5, CORNER) - CORNER)  # both forms gain alike at 0.5 rad


@dataclass(frozen=True)
class Pull:
    """Both cables: tension, N, and its slopes, N/m and N*s/m, by stretch and its rate; (2, n)."""

    tension: Array
    stiffness: Array
    damping: Array


class Cables:
    """The cables of n lanes."""

    def __init__(self, lanes: Lanes, step: float) -> None:
        self.lanes, self.step, self.other = lanes, step, lanes.form != 0
        self.preload, self.stiffness = lanes.get("pretension"), lanes.get("cable_stiffness")
        self.damping, self.toe = lanes.get("cable_damping"), lanes.get("cable_toe_tension")
        self.reach = lanes.get("cable_preload_variation") / self.stiffness
        self.has_toe, self.has_path = bool(self.toe.any()), bool(self.reach.any())
        self.share, self.lost = lanes.get("creep"), np.zeros((2, lanes.size))
        self.before = self.lost  # creep in the preloaded state
        self.creeps, self.settles = bool(self.share.any()), lanes.get("settling")
        time = lanes.get("creep_time"), lanes.get("settling_time")
        self.creep_time, self.settling_time = (np.where(of > 0, of, 1.0) for of in time)

    def path(self, angle: Array) -> tuple[Array, Array]:
        """What both paths gain, m, and its slope, m/rad."""
        root = np.hypot(angle, CORNER)
        gain = np.where(self.other, PATH * (root - CORNER), 1.0 - np.cos(angle))
        slope = np.where(self.other, PATH * angle / root, np.sin(angle))
        return self.reach * gain, self.reach * slope

    def pull(self, stretch: Array, rate: Array) -> Pull:
        """Tensions at `stretch`, m, and its `rate`, m/s, of both cables, (2, n)."""
        line, stiffness = self._line(stretch - (self.lost - self.before) if self.creeps else stretch)
        tension = line + self.damping * rate
        taut = tension > 0.0
        return Pull(np.where(taut, tension, 0.0), np.where(taut, stiffness, 0.0), np.where(taut, self.damping, 0.0))

    def balance(self, difference: Array) -> Array:
        """Stretch of cable 1, and shortening of cable 2, m, at which they pull by `difference`, N, at rest, (n,)."""
        stretch = difference / (2.0 * self.stiffness)
        for _ in range(30):
            (one, other), slopes = self._line(np.stack([stretch, -stretch]))
            stretch = stretch + (difference - one + other) / np.maximum(slopes.sum(axis=0), 0.05 * self.stiffness)
        return np.asarray(stretch)

    def _line(self, stretch: Array) -> tuple[Array, Array]:
        """Tension without damping, N, and its slope, N/m."""
        line, slope = self.preload + self.stiffness * stretch, np.broadcast_to(self.stiffness, stretch.shape)
        if not self.has_toe:
            return line, slope
        soft = self.toe > 0.0
        toe = np.where(soft, self.toe, 1.0)
        load, share = np.where(self.other, *[of(toe, stretch) for of in (self._straightening, self._parabola)])
        return np.where(soft, load, line), np.where(soft, self.stiffness * share, slope)

    def _parabola(self, toe: Array, stretch: Array) -> Array:
        """Tension, N, and share of the stiffness: (length/span)^2 of the toe's, from the natural length on."""
        span = 2.0 * toe / self.stiffness
        early = span * np.sqrt(np.minimum(self.preload / toe, 1.0))
        length = stretch + early + np.maximum(self.preload - toe, 0.0) / self.stiffness
        share = np.clip(length / span, 0.0, 1.0)
        return np.stack([toe * share**2 + self.stiffness * np.maximum(length - span, 0.0), share])

    def _straightening(self, toe: Array, stretch: Array) -> Array:
        """Tension, N, and share of the stiffness: all of it far above F_e."""
        early = EARLY * toe
        start = self.preload + early * np.log(-np.expm1(-self.preload / early))  # K times the length at T
        load = early * np.logaddexp(0.0, (start + self.stiffness * stretch) / early)
        return np.stack([load, -np.expm1(-load / early)])

    def age(self, stretch: Array, time: float) -> None:
        """Creep over the next step; settle until `time`, s, after the start of the log."""
        if self.creeps:
            self.lost = creep(self.lost, stretch, share=self.share, time=self.creep_time, step=self.step)
        if self.settles.any() and time > 0.0:
            settled = -np.expm1(-time / self.settling_time)
            self.preload = self.lanes.get("pretension") * (1.0 - self.settles * settled)

    def rest(self, stretch: Array) -> None:
        """Let cables that creep have crept for long at `stretch`, m."""
        self.lost = self.before = self.share * stretch

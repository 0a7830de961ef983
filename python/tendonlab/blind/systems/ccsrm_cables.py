"""The two cables of n lanes: their tensions at given angles and rates of the joints, (6, n): 11, 12, 13, 21, 22, 23.

T12 = T_p - k longer,  T22 = T_p + k longer,  longer = r (theta2 - theta1)        (middle sections)
T_i1 = T_i2 - friction_i1,  T_i3 = T_i2 - friction_i2                             (end sections)
"""

from __future__ import annotations

import numpy as np

from tendonlab.blind.description import Array, Lanes
from tendonlab.blind.unknown import creep

from .ccsrm_contact import Contacts

FLIP = np.array([[-1.0], [1.0], [1.0], [-1.0]])  # slip towards the middle section per turn of the contact's joint
RELAXATION = 0.03  # s, of the damping of a middle section in its other form
MOST_ITERATIONS, CLOSE = 12, 1e-6  # of the slip on elastic ends; N


class Cables:
    """Ends that do not stretch: the joints' motion is the slip. Rows of angles and rates: joint 1, joint 2."""

    def __init__(self, lanes: Lanes, step: float) -> None:
        get = lanes.get
        self.step = step
        self.contacts = Contacts(lanes, step)
        self.stiffness, self.pretension, self.radius = get("cable_stiffness"), get("pretension"), get("pulley_radius")
        self.wrap, self.viscous, self.compliance = (
            get("initial_wrap_angle"),
            get("cable_viscous"),
            get("ends_compliance"),
        )
        self.bent = (lanes.form != 0) & (self.viscous > 0)
        self.relaxing = np.zeros(lanes.size)
        self.creep, time = get("creep"), get("creep_time")
        self.creep_time, self.crept = np.where(time > 0, time, 1.0), np.zeros(lanes.size)
        self.eccentric, self.phase = get("eccentric"), get("eccentric_phase")
        self.is_eccentric, self.is_damped, self.creeps = (
            bool(np.any(value)) for value in (self.eccentric, self.viscous, self.creep)
        )

    def lever(self, angle: Array) -> Array:
        """Radius of pulley 1, m, where the cables of joint 1 leave it."""
        if not self.is_eccentric:
            return self.radius
        return np.asarray(self.radius * (1.0 + self.eccentric * np.cos(angle[0] + self.phase)))

    def unwound(self, angle: Array) -> Array:
        """Cable that the turn of each joint winds, m, (2, n)."""
        wound = angle * self.radius
        if self.is_eccentric:
            wound[0] += self.radius * self.eccentric * (np.sin(angle[0] + self.phase) - np.sin(self.phase))
        return wound

    def tensions(self, angle: Array, rate: Array) -> Array:
        """Advance by one step in whose middle the joints are at `angle`, rad, and turn at `rate`, rad/s."""
        wound, speed = self.unwound(angle), rate * np.stack([self.lever(angle), self.radius])
        longer = wound[1] - wound[0]
        if self.creeps:
            self.crept = creep(self.crept, longer, share=self.creep, time=self.creep_time, step=self.step)
            longer = longer - self.crept
        middle = self.middle(self.stiffness * longer + self._damping(speed[1] - speed[0]))
        slip = FLIP * speed[[0, 1, 0, 1]]
        level = self.level(slip, middle, angle)
        friction, _ = self.contacts.force(slip, level)
        self.contacts.advance(slip, level)
        return self.six(middle, middle[[0, 0, 1, 1]] - friction)

    def _damping(self, rate: Array) -> Array:
        """Of the middle sections, N: c rate, or what a Maxwell element passes on of it."""
        if not self.is_damped:
            return np.zeros_like(rate)
        self.relaxing = self.relaxing + self.step / RELAXATION * (self.viscous * rate - self.relaxing)
        return np.where(self.bent, self.relaxing, self.viscous * rate)

    def middle(self, more: Array) -> Array:
        """Tension of the middle sections, N, (2, n); a cable does not push."""
        return np.maximum(np.stack([self.pretension - more, self.pretension + more]), 0.0)

    def level(self, slip: Array, middle: Array, angle: Array) -> Array:
        under = angle[[0, 1, 0, 1]]
        return self.contacts.level(slip, tension=middle[[0, 0, 1, 1]], wrap=self.wrap - FLIP * under, angle=under)

    @staticmethod
    def six(middle: Array, ends: Array) -> Array:
        return np.stack([ends[0], middle[0], ends[1], ends[2], middle[1], ends[3]])


class ElasticEnds(Cables):
    """Ends that stretch: slip is what balances middle section, friction and end section. In the other form an end
    stiffens as it is pulled, like a strand whose wires still settle: its stiffness is √(T/T_p)/c."""

    def __init__(self, lanes: Lanes, step: float) -> None:
        super().__init__(lanes, step)
        self.stiffens = lanes.form != 0
        self.slipped: Array | None = None  # m

    def _ends(self, stretch: Array) -> tuple[Array, Array]:
        """Tension of the end sections, N, and its slope, N/m."""
        straight = self.pretension + stretch / self.compliance
        root = np.maximum(1.0 + 0.5 * stretch / (self.compliance * self.pretension), 0.0)
        tension = np.where(self.stiffens, self.pretension * root * root, straight)
        slope = np.where(self.stiffens, root, 1.0) / self.compliance
        return np.maximum(tension, 0.0), slope

    def tensions(self, angle: Array, rate: Array) -> Array:
        h, wound = self.step, FLIP * self.unwound(angle)[[0, 1, 0, 1]]
        if self.slipped is None:
            self.slipped = wound
        slip = (wound - self.slipped) / h
        for _ in range(MOST_ITERATIONS):
            slipped = self.slipped + h * slip
            middle = np.maximum(self.pretension - self.stiffness * (slipped[::2] + slipped[1::2]), 0.0)
            out, slope = self._ends(slipped - wound)
            level = self.level(slip, middle, angle)
            friction, drag = self.contacts.force(slip, level)
            left = middle[[0, 0, 1, 1]] - out - friction
            if np.max(np.abs(left)) < CLOSE:
                break
            own, both = h * slope + drag, h * self.stiffness
            for a in (0, 2):  # contacts of one cable: (own + both) da + both db = left_a, and so for b
                sum_ = (left[a] / own[a] + left[a + 1] / own[a + 1]) / (1.0 + both / own[a] + both / own[a + 1])
                new = slip[a : a + 2] + (left[a : a + 2] - both * sum_) / own[a : a + 2]
                slip[a : a + 2] = np.where(new * slip[a : a + 2] < 0, 0.0, new)  # where friction bends most
        self.contacts.advance(slip, level)
        self.slipped = slipped
        return self.six(middle, out)

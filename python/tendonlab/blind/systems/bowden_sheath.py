"""Two pretensioned cables in their sheaths, which are cut into elements that rub; arrays are (elements, n) or (n,).

    T_(i+1) = T_i (1 - m_i/2)/(1 + m_i/2),  m_i = mu kappa_i L/N      an element of the cable that slides to the drive
    r_in (T_1 - T_3) = u,  both cables together keep their length     tensions T_1, T_3 at the drive
    y = r_out (T_2 - T_4)                                             torque of the tensions at the load

Half the sum of y over both senses is `middle`, half the difference a level of dry friction. Coulomb friction, what
grows with the load, an excess at low speed and viscous friction of ends and guides add to it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tendonlab.blind.description import Array, Lanes

NUM_ELEMENTS = 10
USUAL_SPEED, USUAL_LOAD = 0.4, 10.0  # rad/s, N*m: where the other forms cross the documented ones
LOAD_POWER, VISCOUS_POWER = 0.9, 0.9
COULOMB_FADE, ASYMMETRY_GROWTH = 0.2, 0.3
BREAKAWAY = np.linspace(0.2, 1.8, 8)[:, None]  # of the other form of presliding: bristles that give way in turn


class Slide(NamedTuple):
    """Cables that slide, N*m, (n,): torque without friction, without dry friction, and the level of dry friction with
    its sense.
    """

    middle: Array
    smooth: Array
    level: Array
    sense: Array


class Sheath:
    """The sheaths of n lanes."""

    def __init__(self, lanes: Lanes) -> None:
        self.lanes, self.get = lanes, lanes.get
        self.other, self.scale = lanes.form != 0, lanes.scale[0]
        chosen = [name == "sheath:viscous" for name in lanes.effect] or [False] * lanes.size
        self.bends_viscous = np.array(chosen) & self.other  # a nominal law: bent only where it is the effect
        place = (np.arange(NUM_ELEMENTS)[:, None] + 0.5) / NUM_ELEMENTS * 2.0 - 1.0
        outer = 5.0 / 3.0 * place**3  # of the same first moment: bent at the ends of the sheath
        uneven = 1.0 + self.get("sheath_curvature_skew") * np.where(self.other, outer, place)
        self.bends = self.get("wrap_angle") * uneven / NUM_ELEMENTS

    def slide(self, torque: Array, velocity: Array, *, pretension: Array, dry: Array) -> Slide:
        """`torque` u, N*m, at `velocity`, rad/s. `dry`: factor on dry friction."""
        get = self.get
        excess = get("static_friction_coefficient") - get("friction_coefficient")
        decay = np.exp(-np.square(velocity / _positive(get("stribeck_velocity"))))
        middle, level = self._pair((get("friction_coefficient") + excess * decay) * self.scale, torque, pretension)
        sense, load = np.sign(velocity), np.abs(torque) * get("output_radius") / get("input_radius")
        level = (level + self._further(velocity, load) * self.scale) * dry * self._by_sense(sense, velocity)
        return Slide(middle, middle - self._drag(velocity) * self.scale, np.maximum(level, 0.0), sense)

    def _pair(self, friction: Array, torque: Array, pretension: Array) -> tuple[Array, Array]:
        """Middle and half the height of the loop that the tensions draw."""
        half = 0.5 * friction * self.bends
        after = np.cumprod((1.0 - half) / (1.0 + half), axis=0)
        before = np.concatenate([np.ones((1, half.shape[1])), after[:-1]])
        down, up = np.mean(before + after, axis=0) / 2.0, np.mean(1.0 / before + 1.0 / after, axis=0) / 2.0
        stretch = 2.0 * down * pretension  # as the cables were tightened: each was pulled through its sheath
        pull = torque / self.get("input_radius")
        to_drive = self._load(stretch + up * pull, pull, down + up, after[-1])
        to_load = self._load(stretch + down * pull, pull, down + up, 1.0 / after[-1])
        middle, level = 0.5 * (to_drive + to_load), 0.5 * (to_load - to_drive)
        slack, hold = self.get("sheath_slack"), 2.0 * self.get("output_radius") * pretension
        if slack.any():
            beyond = np.maximum(np.abs(torque) * self.get("output_radius") / self.get("input_radius") / hold - 1.0, 0.0)
            level = level * np.where(self.other, 1.0, 1.0 + slack * beyond)
        return middle, level

    def _load(self, stretch: Array, pull: Array, shares: Array, passed: Array) -> Array:
        """Torque on the load where the first cable passes the share `passed` of its tension. In the other form of
        slack a cable does not push: what it lacks, the other one carries.
        """
        first = stretch / shares
        second = first - pull
        loose = np.maximum(-first, 0.0) + np.maximum(-second, 0.0)
        more = np.where(self.other, self.get("sheath_slack") * loose, 0.0)
        return np.asarray(self.get("output_radius") * ((first + more) * passed - (second + more) / passed))

    def _further(self, velocity: Array, load: Array) -> Array:
        """Dry friction besides that of the bends, N*m."""
        get, speed = self.get, np.abs(velocity)
        fading = np.where(self.other, 1.0 + COULOMB_FADE * (USUAL_SPEED - speed) / (USUAL_SPEED + speed), 1.0)
        square = np.square(velocity / _positive(get("sheath_stribeck_velocity")))
        peak = np.where(self.other, 1.0 / (1.0 + square), np.exp(-square))
        loaded = np.where(self.other, USUAL_LOAD * np.power(load / USUAL_LOAD, LOAD_POWER), load)
        further = get("sheath_coulomb") * fading + get("sheath_static_excess") * peak
        return np.asarray(further + get("sheath_load_dependence") * loaded)

    def _by_sense(self, sense: Array, velocity: Array) -> Array:
        speed = np.abs(velocity)
        growth = np.where(self.other, 1.0 + ASYMMETRY_GROWTH * speed / (speed + USUAL_SPEED), 1.0)
        return np.asarray(1.0 + self.get("sheath_level_asymmetry") * sense * growth)

    def _drag(self, velocity: Array) -> Array:
        """Viscous friction, N*m."""
        speed = np.abs(velocity)
        bent = velocity * np.power(speed / USUAL_SPEED + 1e-9, VISCOUS_POWER - 1.0)
        uneven = speed * np.where(self.other, 1.0 + ASYMMETRY_GROWTH * USUAL_SPEED / (USUAL_SPEED + speed), 1.0)
        drag = self.get("sheath_viscous") * np.where(self.bends_viscous, bent, velocity)
        return np.asarray(drag + self.get("sheath_viscous_asymmetry") * uneven)


class Bristles:
    """Presliding: bristles bend until they slip, where else the gate holds the output."""

    def __init__(self, lanes: Lanes, period: float) -> None:
        self.stiffness, self.other, self.period = lanes.get("sheath_bristle_stiffness"), lanes.form != 0, period
        self.force, self.turns = np.zeros(lanes.size), np.zeros((len(BREAKAWAY), lanes.size))

    def output(self, held: Array, at: Slide, velocity: Array) -> Array:
        """Torque on the load after a sample at `velocity`, N*m; `held` where there are no bristles."""
        if not self.stiffness.any():
            return held
        slipping, bent = at.sense * at.level, self.stiffness * velocity * self.period
        self.force = slipping + (self.force - slipping) * np.exp(-np.abs(bent) / np.maximum(at.level, 1e-12))
        limit = at.level / len(BREAKAWAY)
        self.turns = np.clip(self.turns + bent / len(BREAKAWAY) / BREAKAWAY, -limit, limit)
        friction = np.where(self.other, self.turns.sum(axis=0), self.force)
        return np.where(self.stiffness > 0, at.smooth - friction, held)


def _positive(values: Array) -> Array:
    """1 where a lane lacks what has these values."""
    return np.where(values > 0, values, 1.0)

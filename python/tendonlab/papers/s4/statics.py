"""Statics of the mechanism in closed form: kinematics, tensions behind friction, equilibria, stiffness, backlash.

Signs (the paper's, made consistent): Delta theta = theta_2 - theta_1 > 0 tightens cable 2 and loosens cable 1; s_j is
the sign of joint j's velocity. Angles in rad, tensions in N, torques in N·m; arrays broadcast."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from tendonlab.arguments import whole, within
from tendonlab.errors import ParameterError
from tendonlab.papers.s4.constants import Mechanism

Array = Any  # a number or an array of numbers: the closed forms take either


class WrapAngles(NamedTuple):
    """Wrap angles of the four contacts, rad (S4 eq. 16)."""

    w11: Array
    w12: Array
    w21: Array
    w22: Array


class Tensions(NamedTuple):
    """The six tensions, N: cable (1, 2) and section (1: at joint 1, 2: middle, 3: at joint 2)."""

    T11: Array
    T12: Array
    T13: Array
    T21: Array
    T22: Array
    T23: Array

    @property
    def difference(self) -> Array:
        """T21 - T11, N: what turns joint 1 (S4 eq. 17)."""
        return self.T21 - self.T11


def cable_stiffness(E: float, A: float, l_0: float) -> float:
    """k = E A / l_0, N/m, of a section of length l_0, m, cross-section A, m², modulus E, Pa (S4 eq. 4)."""
    return E * A / l_0


def stretch(theta_1: Array, theta_2: Array, *, r: float) -> Array:
    """Delta l = r (theta_2 - theta_1), m: the lengthening of cable 2; cable 1 shortens by as much (S4 eqs 1 to 5)."""
    return r * (np.asarray(theta_2) - theta_1)


def wrap_angles(theta_1: Array, theta_2: Array, *, theta_w0: float) -> WrapAngles:
    """Wrap angles (S4 eq. 16). Raises ParameterError where a cable leaves its pulley (|theta| >= theta_w0)."""
    largest = float(np.max(np.abs([theta_1, theta_2])))
    if not largest < theta_w0:
        raise ParameterError(f"joint angle = {largest:g} rad: expected less than theta_w0 = {theta_w0:g} rad")
    return WrapAngles(theta_w0 + theta_1, theta_w0 - theta_2, theta_w0 - theta_1, theta_w0 + theta_2)


def capstan_ratio(mu: Array, wrap: Array, sign: Array) -> Array:
    """eta = T_out / T_in = exp(-mu theta_w sign(v)) of a cable that slides over a pulley (S4 eqs 10 to 13)."""
    return np.exp(-np.multiply(mu, wrap) * sign)


def static_tensions(
    theta_1: Array, theta_2: Array, *, s_1: Array, s_2: Array, mechanism: Mechanism, mu: float
) -> Tensions:
    """Tensions in steady slip, joints turning in the directions s_1 and s_2 (S4 eqs 14 to 16)."""
    m, mu = mechanism, within("mu", mu, 0.0, math.inf)
    w = wrap_angles(theta_1, theta_2, theta_w0=m.theta_w0)
    pull = m.k * stretch(theta_1, theta_2, r=m.r)
    T12, T22 = m.T_p - pull, m.T_p + pull
    return Tensions(
        T12 / capstan_ratio(mu, w.w11, s_1),
        T12,
        T12 * capstan_ratio(mu, w.w12, s_2),
        T22 * capstan_ratio(mu, w.w21, s_1),
        T22,
        T22 / capstan_ratio(mu, w.w22, s_2),
    )


def joint_torque(tensions: Tensions, *, r: float) -> Array:
    """tau_c = r (T21 - T11), N·m, on joint 1 (S4 eqs 19, 30)."""
    return r * tensions.difference


def frictionless_stiffness(mechanism: Mechanism) -> float:
    """k_equal = 2 k r², N·m/rad (S4 eq. 9)."""
    return 2 * mechanism.k * mechanism.r**2


def stiffness(theta_1: Array, *, sign: int, mechanism: Mechanism, mu: float) -> Array:
    """Stiffness of joint 1 while it goes on slipping in the direction `sign`, N·m/rad (S4 eqs 22, 24).

    A joint that sticks is stiffer: 2 k r² and the bristles of two contacts, 2 sigma_0 r²."""
    m = mechanism
    return np.exp(mu * np.multiply(theta_1, _direction(sign))) * np.cosh(mu * m.theta_w0) * frictionless_stiffness(m)


def equilibrium_error(*, sign: int, mechanism: Mechanism, mu: float) -> float:
    """Synchronous error at which joint 1 is in balance while it turns in the direction `sign`, rad (S4 eqs 20, 23)."""
    m = mechanism
    return float(_direction(sign) * m.T_p * np.tanh(mu * m.theta_w0) / (m.k * m.r))


def backlash(*, mechanism: Mechanism, mu: float) -> float:
    """What the synchronous error changes by at a reversal, rad (S4 eq. 25): no joint friction, no viscous friction."""
    return 2 * equilibrium_error(sign=1, mechanism=mechanism, mu=mu)


def series_stiffness(*sections: float) -> float:
    """Stiffness of sections in series, N/m: what a middle section looks like where its ends stretch too."""
    whole("number of sections", len(sections), 1)
    return float(1.0 / np.sum(1.0 / np.asarray(sections)))


def _direction(sign: int) -> int:
    if sign not in (-1, 1):
        raise ParameterError(f"sign = {sign}: expected +1 or -1")
    return sign

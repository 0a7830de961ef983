"""Line-contact LuGre friction, written apart from the library: the twins must share no law with what they test."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tendonlab.papers.s4.constants import Contact, Joint


def sign(x: float) -> float:
    """Sign of x with sign(0) = 0 (added to S4 eq. 11)."""
    return float((x > 0) - (x < 0))


def level(v: float, T_in: float, wrap: float, of: Contact) -> float:
    """f_c = |T_in (1 - exp(-mu_c theta_w sign v))| + eps, N (S4 eq. 28): larger where the cable moves to the middle
    section's far side. As printed, without the magnitude, it is negative for v < 0 and the bristle diverges."""
    mu = of.mu_c if v >= 0 or of.mu_back is None else of.mu_back
    return abs(max(T_in, 0.0) * (1.0 - math.exp(-mu * wrap * sign(v)))) + of.eps


def stribeck(v: float, f_c: float, f_s: float, v_s: float) -> float:
    """g(v) = f_c + (f_s - f_c) exp(-(v/v_s)²), N (S4 eq. 27)."""
    return f_c + (f_s - f_c) * math.exp(-((v / v_s) ** 2))


@dataclass(frozen=True)
class LineContact:
    """One contact of a cable with a pulley (S4 eqs 27 to 29). v: slip, m/s, positive towards the middle section.

    `static`: "ratio", f_s = mu_s/mu_c f_c as printed, or "capstan", f_s = T_in |1 - exp(-mu_s theta_w sign v)|."""

    of: Contact
    static: str = "ratio"

    def g(self, v: float, T_in: float, wrap: float) -> float:
        """Level of dry friction at slip v, N."""
        return stribeck(v, *self.levels(v, T_in, wrap), self.of.v_s)

    def levels(self, v: float, T_in: float, wrap: float) -> tuple[float, float]:
        """Kinetic and static level of dry friction at slips in the direction of v, N."""
        f_c = level(v, T_in, wrap, self.of)
        if self.static == "capstan":
            return f_c, abs(T_in * (1.0 - math.exp(-self.of.mu_s * wrap * sign(v)))) + self.of.eps
        return f_c, f_c * self.of.mu_s / self.of.mu_c

    def rate(self, z: float, v: float, T_in: float, wrap: float) -> float:
        """Rate of the bristle deflection z, m/s."""
        return v - self.of.sigma_0 * abs(v) * z / self.g(v, T_in, wrap)

    def force(self, z: float, v: float, rate: float) -> float:
        """Friction f = T_in - T_out, N, at the deflection z and its rate."""
        return self.of.sigma_0 * z + self.of.sigma_1 * rate + self.of.sigma_2 * v

    def slip(self, z: float, f: float, T_in: float, wrap: float) -> float:
        """Slip v, m/s, of a massless cable on which T_in - T_out = f: the root of force(z, v, rate) = f.

        v = (f - sigma_0 z) / (sigma_1 + sigma_2 - sigma_1 sigma_0 z sign(v) / g(v)), iterated on g; the denominator
        stays positive, so that the sign of v is that of f - sigma_0 z."""
        c = self.of
        excess = f - c.sigma_0 * z
        f_c, f_s = self.levels(excess, T_in, wrap)
        v = sign(excess) * 1e3 * c.v_s
        for _ in range(100):
            last = v
            v = excess / (
                c.sigma_1 + c.sigma_2 - c.sigma_1 * c.sigma_0 * z * sign(excess) / stribeck(v, f_c, f_s, c.v_s)
            )
            if abs(v - last) <= 1e-14 * (abs(v) + c.v_s):
                break
        return v


def joint_friction(z: float, omega: float, of: Joint) -> tuple[float, float]:
    """Rate of the joint's bristle, rad/s, and its friction torque, N·m (S4 eq. 27); none where f_c = 0."""
    if of.f_c == 0:
        return 0.0, 0.0
    rate = omega - of.sigma_0 * abs(omega) * z / stribeck(omega, of.f_c, of.f_s, of.v_s)
    return rate, of.sigma_0 * z + of.sigma_1 * rate

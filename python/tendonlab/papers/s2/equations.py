"""The corrected equations (1)-(6) of S2 in its own symbols, for twins: plain numpy, apart from the compiled laws.

Signs: omega > 0 pulls cable 1, releases cable 2 and drives theta > 0. Elongations count from the preloaded state.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tendonlab.errors import ParameterError
from tendonlab.papers.s2.values import Constants

Array = NDArray[np.float64]
CORIOLIS = {"corrected": 2.0, "printed": -4.0}  # times m_2 l_1 d_21 sin(theta) theta'^2


def winding_rate(of: Constants, x_1: ArrayLike, x_2: ArrayLike, voltage: ArrayLike) -> Array:
    """x_1' of the flux linkage x_1 = L_m i, V (S2 eq. 1)."""
    return np.asarray(voltage) - of.R_m / of.L_m * np.asarray(x_1) - of.k_m / of.J_m * np.asarray(x_2)


def motor_rate(of: Constants, x_1: ArrayLike, x_2: ArrayLike, force_difference: ArrayLike) -> Array:
    """x_2' of the motor's momentum x_2 = J_m omega, N*m, where the nuts carry F_act,1 - F_act,2, N (S2 eq. 1; gear
    friction and cable forces subtract)."""
    omega = np.asarray(x_2) / of.J_m
    torque = of.k_m / of.L_m * np.asarray(x_1) - of.c_m * omega - gear_torque(of, omega)
    return np.asarray(torque - of.N * np.asarray(force_difference))


def gear_torque(of: Constants, omega: ArrayLike) -> Array:
    """Friction of the harmonic gear at motor speed omega, rad/s, against the motion, N*m (S2 eq. 12)."""
    return of.alpha * np.arctan(of.beta * np.asarray(omega))


def elongation_rates(
    of: Constants, theta: ArrayLike, theta_rate: ArrayLike, nut_rate: ArrayLike
) -> tuple[Array, Array]:
    """x_4' of both cables, m/s (S2 eq. 2)."""
    stretch = np.asarray(nut_rate) - of.r * np.cos(theta) * np.asarray(theta_rate)
    return stretch, -stretch


def cable_force(of: Constants, x_4: ArrayLike, x_4_rate: ArrayLike) -> Array:
    """Tension of a cable, N: spring parallel damper on the preload, never a push (S2 eq. 3)."""
    return np.maximum(0.0, of.T + of.K * np.asarray(x_4) + of.c * np.asarray(x_4_rate))


def positions(of: Constants, theta: ArrayLike) -> dict[str, Array]:
    """Centres of mass of both links and the end effector, m, last axis (x, y) (S2 eq. 4)."""
    one, two = np.asarray(theta) + of.phi, 2.0 * np.asarray(theta) + of.phi
    along_1 = np.stack([np.cos(one), np.sin(one)], axis=-1)
    along_2 = np.stack([np.cos(two), np.sin(two)], axis=-1)
    end_1 = of.l_1 * along_1
    return {"P_cm1": of.d_11 * along_1, "P_cm2": end_1 + of.d_21 * along_2, "P_ee": end_1 + of.l_2 * along_2}


def inertia(of: Constants, theta: ArrayLike) -> Array:
    """I(theta) of the joint, kg*m^2: J_1 times the denominator of S2 eq. 5."""
    fixed = of.J_1 + 4.0 * of.J_2 + of.m_1 * of.d_11**2 + of.m_2 * (of.l_1**2 + 4.0 * of.d_21**2)
    return fixed + 4.0 * of.m_2 * of.l_1 * of.d_21 * np.cos(theta)


def gravity_torque(of: Constants, theta: ArrayLike) -> Array:
    """Torque of gravity on the joint, N*m, theta from the horizontal (S2 eq. 6 with signed forces -m g)."""
    one, two = np.cos(np.asarray(theta) + of.phi), np.cos(2.0 * np.asarray(theta) + of.phi)
    return -of.g * (of.m_1 * of.d_11 * one + of.m_2 * (of.l_1 * one + 2.0 * of.d_21 * two))


def potential(of: Constants, theta: ArrayLike) -> Array:
    """Potential energy of gravity, J, 0 at the height of the first axis."""
    at = positions(of, theta)
    return of.g * (of.m_1 * at["P_cm1"][..., 1] + of.m_2 * at["P_cm2"][..., 1])


def joint_energy(of: Constants, theta: ArrayLike, theta_rate: ArrayLike) -> Array:
    """Kinetic and potential energy of both links, J."""
    return 0.5 * inertia(of, theta) * np.square(theta_rate) + potential(of, theta)


def joint_rate(
    of: Constants, theta: ArrayLike, x_5: ArrayLike, force_difference: ArrayLike, *, coriolis: str = "corrected"
) -> Array:
    """x_5' of x_5 = J_1 theta', N*m, under F_r,1 - F_r,2, N (S2 eq. 5).

    `coriolis`: "corrected" (+2, from I'/2 theta'^2) or "printed" (-4), which does not conserve energy: a free swing
    from 0.3 rad loses up to 1.16 J and regains most of it. Raises ParameterError for another word."""
    if coriolis not in CORIOLIS:
        raise ParameterError(f"coriolis = {coriolis!r}: expected one of {', '.join(CORIOLIS)}")
    share = CORIOLIS[coriolis] * of.m_2 * of.l_1 * of.d_21 * np.sin(theta)
    pull = of.r * np.cos(theta) * np.asarray(force_difference)
    moment = share * np.square(np.asarray(x_5) / of.J_1) + pull + gravity_torque(of, theta)
    return np.asarray(moment * of.J_1 / inertia(of, theta))


def holding_difference(of: Constants, theta: ArrayLike) -> Array:
    """F_r,1 - F_r,2 that holds the joint still at theta, N."""
    return -gravity_torque(of, theta) / (of.r * np.cos(theta))


def bushing_force(branches: Mapping[str, float], theta: ArrayLike, velocity: ArrayLike, tension: float) -> Array:
    """Force of a cable in its bushing at joint angle theta, rad, N: four branches (S2 eq. 11).

    `branches`: a1, a2, N, b11 … b22, 1, c1, c2, rad; `velocity`: its sign chooses, 0 counts as backwards; `tension` of
    the cable, N. Contains what changes with theta alone as well as friction: see `split_common_friction`."""
    forward = np.asarray(velocity) > 0
    sides = []
    for i in (1, 2):
        away = np.asarray(theta) - branches[f"c{i}"]
        slope = np.where(away >= 0, branches[f"b{i}1"], branches[f"b{i}2"])
        sides.append(branches[f"a{i}"] + slope * tension * np.sin(0.5 * away))
    return np.where(forward, sides[0], sides[1])


def bushing_reaction(tension: ArrayLike, theta: ArrayLike) -> Array:
    """Reaction of the bushing on a cable that turns by theta, N, last axis (x, y) (S2 eq. 8)."""
    force = np.asarray(tension)
    return np.stack([force * (1.0 - np.cos(theta)), -force * np.sin(theta)], axis=-1)

"""The drive: rigid transmission (S0 eqs 7, 8), torsional stiffness of the cable (Figs 4, 5), dynamic LuGre (2)."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import solve_ivp

from tendonlab.arguments import positive, samples
from tendonlab.errors import ParameterError
from tendonlab.papers.s0.bench import CENTRES, Configuration

if TYPE_CHECKING:
    from tendonlab._core import Law

AXIAL_STIFFNESS = 70e3  # N, EA of the cable; reconstructed
WRAP_FRICTION = 0.15  # 1, cable on capstan and pulley; reconstructed
SMALLEST_LEVEL = 1e-3  # N·m, below which no bristle is put on the static curve: 1/g would blow up


def motor_torque(
    *,
    speed: float | np.ndarray,
    acceleration: float | np.ndarray,
    ratio: float,
    inertias: tuple[float, float, float, float],
    viscous: tuple[float, float],
    load_torque: float = 0.0,
    friction: float | np.ndarray = 0.0,
) -> float | np.ndarray:
    """Torque of the motor, N·m, on a rigid transmission (S0 eq. 7):

    T_M = [(J_M + J_1) + (J_2 + J_L)/N²] acceleration + (B_M + B_L/N²) speed + T_L/N + T_fs

    `speed` rad/s and `acceleration` rad/s² of the motor; `inertias` J_M, J_1 (capstan), J_2 (pulley), J_L, kg·m²;
    `viscous` B_M, B_L, N·m·s/rad; `load_torque` T_L at the pulley and `friction` T_fs at the motor, N·m.
    Raises ParameterError for a value that is not finite, or a ratio that is not positive."""
    positive("ratio", ratio)
    for name, values in (("inertias", inertias), ("viscous", viscous), ("load_torque", load_torque)):
        samples(name, np.ravel(values))
    for name, along in (("speed", speed), ("acceleration", acceleration), ("friction", friction)):
        samples(name, np.ravel(along), fewest=0)
    motor, capstan, pulley, load = inertias
    inertia = motor + capstan + (pulley + load) / ratio**2
    return inertia * acceleration + (viscous[0] + viscous[1] / ratio**2) * speed + load_torque / ratio + friction


def viscous_factor(ratio: float) -> float:
    """(N² + 1)/N², 1: by how much the second shaft raises viscous friction where both have the same (S0 eq. 8).

    Raises ParameterError for a ratio that is not positive."""
    positive("ratio", ratio)
    return (ratio**2 + 1) / ratio**2


def torsional_stiffness(
    of: Configuration,
    *,
    load_torque: float,
    pretension: float,
    axial_stiffness: float = AXIAL_STIFFNESS,
    friction: float = WRAP_FRICTION,
    centres: float = CENTRES,
) -> float:
    """Stiffness at the pulley, N·m/rad, of two cable sides, each a free span and two wraps in which the change of
    tension decays as friction has it (Figs 4, 5; S0 gives no equation: reconstructed).

    `load_torque` N·m at the pulley, `pretension` N, `axial_stiffness` EA in N, `friction` 1. Raises ParameterError
    where the slack side would lose its tension."""
    r_1, r_2 = of.radii()
    change = abs(load_torque) / (2 * r_2)
    if not pretension > change:
        raise ParameterError(f"pretension = {pretension}: expected more than {change} N, or one side goes slack")
    span, wraps = np.sqrt(centres**2 - (r_1 + r_2) ** 2), (r_1 + r_2) / friction
    tight = span + wraps * (1 - pretension / (pretension + change))
    slack = span + wraps * (pretension / (pretension - change) - 1)
    return float(r_2**2 * axial_stiffness * (1 / tight + 1 / slack))


def dynamic_lugre(
    time: np.ndarray,
    *,
    velocity: np.ndarray,
    curve: Law,
    bristle: Law,
    viscous: float,
    tolerance: float = 1e-10,
) -> tuple[np.ndarray, np.ndarray]:
    """Bristle deflection, rad, and torque, N·m, of the LuGre model along a motion (S0 eqs 2, 3), from z = 0.

    `time` s and `velocity` rad/s, shape (n,), joined by a cubic spline; `curve` and `bristle` are the laws StaticLugre
    and Presliding of the library; `viscous` N·m·s/rad. The level g is held above 1e-3 N·m: with F_s near 0, as in S0
    Tables 6 and 7, sigma_0 |v|/g blows up. Warns where that may happen, F_s < F_c."""
    from scipy.interpolate import CubicSpline

    if curve.static_friction < curve.coulomb:
        told = f"static_friction = {curve.static_friction} < coulomb = {curve.coulomb} N·m"
        warnings.warn(f"{told}: shape parameters, no stiction; the level is held above 1e-3 N·m", stacklevel=2)
    motion = CubicSpline(time, velocity)

    def rate(t: float, z: np.ndarray) -> np.ndarray:
        v = float(motion(t))
        level = max(float(curve.level(velocity=v)), SMALLEST_LEVEL)
        return np.asarray(bristle.rate(velocity=v, deflection=z, level=level))

    run = solve_ivp(rate, (time[0], time[-1]), [0.0], "Radau", time, rtol=tolerance, atol=1e-14)
    z = run.y[0]
    level = np.maximum(curve.level(velocity=velocity), SMALLEST_LEVEL)
    return z, bristle.force(velocity=velocity, deflection=z, level=level) + viscous * velocity

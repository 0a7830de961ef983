"""How the losses are identified with motor currents and position sensors alone: one motor at a time, at constant speeds
(S1 sec. III). Strategy "S1" locks the other motors, "S2" the other joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import pandas as pd

from tendonlab.arguments import samples, within
from tendonlab.errors import DatasetError, ParameterError
from tendonlab.mechanics.tendons import BranchLosses, Model, TendonTransmission
from tendonlab.procedures import steady_averages

Strategy = Literal["S1", "S2"]
Form = Literal["exact", "first_order", "printed"]


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Commands that identify one transmission: one row per constant speed. Arrays (samples, n), rad/s."""

    joint: int
    strategy: Strategy
    motor_velocity: np.ndarray
    joint_velocity: np.ndarray

    @property
    def speed(self) -> np.ndarray:
        """Speed of the motor under test (samples,), rad/s."""
        return self.motor_velocity[:, self.joint - 1]


def plan_identification(
    transmission: TendonTransmission, joint: int, *, strategy: Strategy, speeds: Sequence[float]
) -> Plan:
    """Motor and joint speeds that test the transmission of `joint` (counted from 1) at motor `speeds`, rad/s.

    "S1": the other motors rest, so joints behind turn along; "S2": the other joints rest, so their motors follow.
    Raises ParameterError unless each speed comes in both directions, over the same joint range. Source: S1 eq. 14."""
    require_joint(transmission, joint)
    values = np.asarray(speeds, dtype=float)
    if values.size == 0 or not np.allclose(np.sort(values), np.sort(-values)) or np.any(values == 0):
        raise ParameterError(f"speeds = {values.tolist()}: expected each of them in both directions, none of them 0")
    moved = np.zeros((values.size, transmission.num_joints))
    if strategy == "S1":
        moved[:, joint - 1] = values
        joints = transmission.kinematics.motor_to_joint(moved)
        return Plan(joint=joint, strategy=strategy, motor_velocity=moved, joint_velocity=joints)
    if strategy != "S2":
        raise ParameterError(f"strategy = {strategy!r}: expected S1 or S2")
    own = transmission.motor_radius[joint - 1] / transmission.radius[joint - 1, joint - 1]
    moved[:, joint - 1] = own * values
    motors = transmission.kinematics.joint_to_motor(moved)
    return Plan(joint=joint, strategy=strategy, motor_velocity=motors, joint_velocity=moved)


def steady_average(log: pd.DataFrame) -> pd.DataFrame:
    """One row per plateau of constant speed: `speed`, rad/s, and `torque`, N·m, of the motor, gravity removed.

    `log`: indexed by time, s, with columns `motor_velocity`, `motor_torque` and `joint_angle`, rad. What does not
    change its sign with the direction at equal angles, gravity above all, is taken away. Raises DatasetError for a
    missing column, ParameterError where a speed lacks its opposite over the same angles. Source: S1 sec. III-B; the
    half-difference is reconstructed."""
    for name in ("motor_velocity", "motor_torque", "joint_angle"):
        if name not in log:
            raise DatasetError(f"{name}: missing; expected columns motor_velocity, motor_torque and joint_angle")
    found = steady_averages(log.index, log["motor_velocity"], log["motor_torque"], position=log["joint_angle"])
    return found[["speed", "friction", "num_samples"]].rename(columns={"friction": "torque"})


@dataclass(frozen=True, kw_only=True)
class MotorFriction:
    """Friction of a transmission as its motor feels it: `constant` C_m0, N·m, and `viscous` ν, N·m·s/rad, with their
    `covariance` (2, 2)."""

    constant: float
    viscous: float
    covariance: np.ndarray

    @property
    def sd(self) -> np.ndarray:
        """Standard deviations of `constant` and `viscous`."""
        return np.sqrt(np.diag(self.covariance))


def fit_motor_friction(speed: Sequence[float] | np.ndarray, torque: Sequence[float] | np.ndarray) -> MotorFriction:
    """Least squares of motor torque, N·m, over sgn and value of motor speed, rad/s. Raises DatasetError where the
    speeds are fewer than three or all alike in magnitude. Source: S1 eq. 13, with the sign."""
    v, c = np.asarray(speed, dtype=float), np.asarray(torque, dtype=float)
    if v.shape != c.shape or v.size < 3 or np.ptp(np.abs(v)) == 0 or np.any(v == 0):
        raise DatasetError(
            f"speeds {v.tolist()}: expected three or more, not 0, of different magnitude, one torque each"
        )
    columns = np.column_stack([np.sign(v), v])
    found, *_ = np.linalg.lstsq(columns, c, rcond=None)
    variance = float(np.sum((c - columns @ found) ** 2)) / (v.size - 2)
    covariance = variance * np.linalg.inv(columns.T @ columns)
    return MotorFriction(constant=float(found[0]), viscous=float(found[1]), covariance=covariance)


def true_motor_friction(transmission: TendonTransmission, joint: int) -> tuple[float, float]:
    """C_m0, N·m, and ν, N·m·s/rad, of a transmission that moves alone. Source: S1 eqs 18, 19."""
    require_joint(transmission, joint)
    i, r = joint - 1, abs(transmission.motor_radius[joint - 1])
    losses = transmission.losses
    return float(r * losses.constant[i].sum()), float(r**2 * losses.viscous[i].sum())


def identify_joint(
    transmission: TendonTransmission, joint: int, *, strategy: Strategy, speeds: Sequence[float], model: Model = "eq12"
) -> MotorFriction:
    """Result of a strategy on a device with these losses and no gravity."""
    plan = plan_identification(transmission, joint, strategy=strategy, speeds=speeds)
    torque = transmission.statics.inverse(np.zeros_like(plan.joint_velocity), plan.joint_velocity, model=model).torque
    return fit_motor_friction(plan.speed, torque[:, joint - 1])


def residual_error(
    transmission: TendonTransmission,
    joint: int,
    *,
    strategy: Strategy,
    speed: float,
    form: Form = "exact",
    model: Model = "eq12",
) -> float:
    """Torque, N·m, that friction of the other transmissions adds at the motor under test, turning at `speed`, rad/s.

    "exact" runs the recursion with nothing to hold and takes away the own friction; "first_order" sums what the other
    loops lose on links behind the joint and is no upper bound; "printed" has the motor radius of the other
    transmission, as the paper does, which is right only where it equals that of the way through the joint.
    Source: S1 eq. 15."""
    plan = plan_identification(transmission, joint, strategy=strategy, speeds=(speed, -speed))
    nothing, moving = np.zeros(transmission.num_joints), plan.joint_velocity[0]
    if form == "exact":
        both = [
            of.statics.inverse(nothing, moving, model=model).torque
            for of in (transmission, _alone(transmission, joint))
        ]
        return float(np.abs(both[0][joint - 1]) - np.abs(both[1][joint - 1]))
    if form not in ("first_order", "printed"):
        raise ParameterError(f"form = {form!r}: expected exact, first_order or printed")
    speeds = np.abs(transmission.kinematics.branches(moving)) if strategy == "S1" else 0.0  # S2: the others rest
    lost = transmission.losses.constant + transmission.losses.viscous * speeds
    return _first_order(transmission, joint, lost, printed=form == "printed")


def _first_order(transmission: TendonTransmission, joint: int, lost: np.ndarray, *, printed: bool) -> float:
    """Losses `lost` (n, n), N, of the transmissions behind, on links from the joint on, as motor `joint` feels them."""
    j = joint - 1
    behind = np.array([lost[k, joint : k + 1].sum() for k in range(transmission.num_joints)])
    way = np.abs(transmission.motor_radius[j] * transmission.radius[:, j] / transmission.radius[j, j])
    arm = np.abs(transmission.motor_radius) if printed else way
    return float(np.sum((arm * behind)[joint:]))


def _alone(transmission: TendonTransmission, joint: int) -> TendonTransmission:
    """The device where only the transmission of `joint` has losses."""
    own = np.zeros((transmission.num_joints, 1))
    own[joint - 1] = 1.0
    of = transmission.losses
    losses = BranchLosses(constant=own * of.constant, tension=own * of.tension, viscous=own * of.viscous)
    return replace(transmission, losses=losses)


@dataclass(frozen=True, kw_only=True)
class Decomposition:
    """Losses of each branch from those at the motor: `constant` N and `viscous` N·s/m, (branches,), with the weights
    `w_static` α, 1/m, and `w_viscous` γ, 1/m²."""

    constant: np.ndarray
    viscous: np.ndarray
    w_static: np.ndarray
    w_viscous: np.ndarray


def decompose(
    constant: float,
    viscous: float,
    branch_per_motor: Sequence[float] | np.ndarray,
    *,
    shares_static: Sequence[float] | np.ndarray,
    shares_viscous: Sequence[float] | np.ndarray,
) -> Decomposition:
    """Split C_m0, N·m, and ν, N·m·s/rad, over the branches by their shares of the dissipated power.

    `branch_per_motor` k, m: velocity of each branch per motor velocity (S1 eq. 16), the motor radius in both
    strategies. The shares come from the design, e.g. from the number of bearings (`shares_by_bearings`), and add up to
    1: only they are a guess, the sums at the motor hold exactly. Raises ParameterError. Source: S1 eqs 17-21."""
    within("constant", constant, -np.inf, np.inf, "N·m"), within("viscous", viscous, -np.inf, np.inf, "N·m·s/rad")
    k = np.abs(samples("branch_per_motor", branch_per_motor))
    if np.any(k == 0):
        raise ParameterError(f"branch_per_motor = {k.tolist()}: expected lengths other than 0, one per branch")
    shares = {"shares_static": shares_static, "shares_viscous": shares_viscous}
    p = {name: samples(name, values) for name, values in shares.items()}
    for name, values in p.items():
        if values.shape != k.shape or np.any(values < 0) or abs(values.sum() - 1.0) > 1e-9:
            raise ParameterError(f"{name} = {values.tolist()}: expected {k.size} shares of power that add up to 1")
    w_static, w_viscous = p["shares_static"] / k, p["shares_viscous"] / k**2
    found = Decomposition(
        constant=w_static * constant, viscous=w_viscous * viscous, w_static=w_static, w_viscous=w_viscous
    )
    for total, of in ((constant, found.constant @ k), (viscous, found.viscous @ k**2)):
        if abs(total - of) > 1e-9 * abs(total):
            raise ParameterError(f"shares: they give {of}, expected {total} at the motor")
    return found


def shares_by_bearings(num_bearings: Sequence[int]) -> np.ndarray:
    """Shares of the dissipated power in proportion to the bearings on each branch [reconstructed default]."""
    counts = np.asarray(num_bearings, dtype=float)
    if counts.size == 0 or np.any(counts < 0) or counts.sum() == 0:
        raise ParameterError(f"num_bearings = {counts.tolist()}: expected counts, at least one above 0")
    return np.asarray(counts / counts.sum())


def require_joint(transmission: TendonTransmission, joint: int) -> None:
    """Raises ParameterError unless there is such a joint, counted from 1."""
    if not isinstance(joint, int | np.integer) or not 1 <= joint <= transmission.num_joints:
        raise ParameterError(f"joint = {joint}: expected 1 to {transmission.num_joints}")

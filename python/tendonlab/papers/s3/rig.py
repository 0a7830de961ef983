"""The rig of S3 and the five numbers the paper fitted, in its own notation; values that it leaves out are assumed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from tendonlab.errors import ParameterError
from tendonlab.papers.tables import table
from tendonlab.procedures import pretension_from_load_cells

DEGREE = math.pi / 180.0
VELOCITY_UNITS = {"deg/s": DEGREE, "rad/s": 1.0}  # rad/s per unit


@dataclass(frozen=True, kw_only=True)
class FrictionParameters:
    """p of the paper: kinetic and static friction coefficient, Stribeck velocity, and the gate of eq. 20, its threshold
    velocity and its steepness s_v (1/velocity²).

    The paper does not say in which unit its velocities are; deg/s is assumed here and always stated."""

    mu_d: float
    mu_s: float
    v_s: float
    v_thres: float
    s_v: float
    velocity_unit: str = "deg/s"

    def __post_init__(self) -> None:
        if self.velocity_unit not in VELOCITY_UNITS:
            raise ParameterError(f"velocity_unit = {self.velocity_unit!r}: expected one of {', '.join(VELOCITY_UNITS)}")

    def in_unit(self, velocity_unit: str) -> FrictionParameters:
        """The same law with velocities in another unit: v_thres and v_s scale with it, s_v with its inverse square."""
        if velocity_unit not in VELOCITY_UNITS:
            raise ParameterError(f"velocity_unit = {velocity_unit!r}: expected one of {', '.join(VELOCITY_UNITS)}")
        scale = VELOCITY_UNITS[self.velocity_unit] / VELOCITY_UNITS[velocity_unit]
        return replace(
            self,
            v_s=self.v_s * scale,
            v_thres=self.v_thres * scale,
            s_v=self.s_v / scale**2,
            velocity_unit=velocity_unit,
        )

    def with_values(self, values: Mapping[str, float]) -> FrictionParameters:
        """The same law with other values for some of the numbers, in the same unit of velocity."""
        given: dict[str, Any] = dict(values)
        return replace(self, **given)

    def system_parameters(self) -> dict[str, float]:
        """The same numbers, SI, under the names of `bowden_pair`."""
        si = self.in_unit("rad/s")
        return {
            "friction_coefficient": si.mu_d,
            "static_friction_coefficient": si.mu_s,
            "stribeck_velocity": si.v_s,
            "threshold_velocity": si.v_thres,
            "threshold_slope": si.s_v,
        }


@cache
def paper_parameters() -> FrictionParameters:
    """p as printed, identified by the paper on theta_6 at a load-cell reading of 54 kg."""
    values = table("S3_fitted_parameters").set_index("name")["value"]
    given: dict[str, Any] = {str(name): float(value) for name, value in values.items()}
    return FrictionParameters(**given)


@dataclass(frozen=True, kw_only=True)
class Rig:
    """Radii of the pulleys and length of the sheath, m, axial stiffness of a cable `EA`, N, the load's gains `K_p`,
    N·m/rad, and `K_d`, N·m·s/rad, inertias, kg·m², and viscous friction of the drive, N·m·s/rad. All assumed."""

    r_in: float
    r_out: float
    L: float
    EA: float
    K_p: float
    K_d: float
    J_A: float
    J_B: float
    b_A: float  # noqa: N815
    A: float


@cache
def assumed_rig() -> Rig:
    """The values of `S3_setup`, which the paper does not print; A is the amplitude of the input torque, N·m."""
    rows = table("S3_setup").set_index("quantity")["value"]
    radius, inertia = float(rows["pulley radius r_in = r_out"]), float(rows["motor-side inertia J_A and J_B"])
    return Rig(
        r_in=radius,
        r_out=radius,
        L=float(rows["cable length L"]),
        EA=float(rows["EA"]),
        K_p=float(rows["K_p"]),
        K_d=float(rows["K_d"]),
        J_A=inertia,
        J_B=inertia,
        b_A=float(rows["motor-side viscous b_A"]),
        A=float(rows["torque amplitude A"]),
    )


def cable_pretension(reading: float) -> float:
    """T_s, N, of each cable where both load cells read `reading`, kg. Source: S3 eq. 3."""
    return float(pretension_from_load_cells(reading, reading))


def free_body(load_force: float, *, guide_force: float = 0.0) -> tuple[float, float]:
    """Tensions T_O1 and T_O2 of the two cables, N, that hold the drive unit against its load cell.

    `load_force`: T_L of the load cell, N; `guide_force`: T_A of the slide, N, 0 in the steady state (S3 eq. 1). Solves
    the balance of forces and of moments (S3 eq. 2); without a guide force each cable carries half (S3 eq. 3)."""
    each = 0.5 * (load_force - guide_force)
    return each, each

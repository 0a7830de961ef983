"""Numbers that S4 states for its mechanism, contacts and rig (Tables II and III, section V), in its notation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from tendonlab.papers.tables import table

ENCODER_BITS = 17
RESOLUTION = 2 * np.pi / 2**ENCODER_BITS  # rad, of both encoders
ERROR_ON_THE_RIG = np.deg2rad(1.56)  # rad, largest synchronous error measured (Fig. 11)


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """Table II: stiffness of a middle cable section k, N/m; pretension T_p, N; pulley radius r, m; wrap angle of the
    straight joint theta_w0, rad; inertia of the driven link J, kg·m²."""

    k: float
    T_p: float
    r: float
    theta_w0: float
    J: float

    @property
    def slack_error(self) -> float:
        """Synchronous error, rad, at which one middle section goes slack."""
        return self.T_p / (self.k * self.r)


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Table III: bristle stiffness sigma_0, N/m, and damping sigma_1, N·s/m; viscous friction sigma_2, N·s/m; friction
    coefficients mu_c (kinetic) and mu_s (static); Stribeck velocity v_s, m/s. `eps`, N, keeps the level above zero.

    `mu_back`: mu_c where the cable slides away from the middle section (v < 0), mu_s/mu_c kept; None: mu_c too."""

    sigma_0: float
    sigma_1: float
    sigma_2: float
    mu_c: float
    mu_s: float
    v_s: float
    eps: float = 1e-3
    mu_back: float | None = None


@dataclass(frozen=True, kw_only=True)
class Joint:
    """Friction of joint 1 (the paper's LuGre values, and levels that it leaves at zero): f_c, f_s, N·m; v_s, rad/s;
    sigma_0, N·m/rad; sigma_1, N·m·s/rad. f_c = 0 is no friction: the limit of g to 0."""

    f_c: float
    f_s: float
    v_s: float
    sigma_0: float
    sigma_1: float


@dataclass(frozen=True, kw_only=True)
class Identified:
    """What the paper fitted on its rig: k, N/m, and mu_c of contact 21 for joint 1 turning forwards and backwards."""

    k: float
    mu_plus: float
    mu_minus: float


@cache
def design() -> Mechanism:
    """Table II: the design values, with which sections III and IV simulate."""
    rows = _numbers("S4_table2_parameters")
    return Mechanism(**{name: rows[name] for name in ("k", "T_p", "r", "theta_w0", "J")})


@cache
def contact() -> Contact:
    """Table III."""
    rows = _numbers("S4_table3_lugre")
    return Contact(**{name: rows[name] for name in ("sigma_0", "sigma_1", "sigma_2", "mu_c", "mu_s", "v_s")})


@cache
def joint(f_c: float = 0.0, f_s: float = 0.0) -> Joint:
    """The joint's LuGre values; the paper prints no level, so f_c and f_s, N·m, are the caller's."""
    rows = _numbers("S4_joint_lugre")
    return Joint(f_c=f_c, f_s=f_s, v_s=rows["v_s"], sigma_0=rows["sigma_0"], sigma_1=rows["sigma_1"])


@cache
def identified() -> Identified:
    """Section V: the identified stiffness and friction coefficients."""
    rows = _numbers("S4_identified")
    return Identified(k=rows["k"], mu_plus=rows["mu_c,21 plus"], mu_minus=rows["mu_c,21 minus"])


def _numbers(name: str) -> dict[str, float]:
    """Values of a table by the names in its first columns."""
    rows = table(name)
    names = rows["symbol"] if "symbol" in rows else rows["quantity"]
    return dict(zip(names, rows["value"].astype(float).tolist(), strict=True))

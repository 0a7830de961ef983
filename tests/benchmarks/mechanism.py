"""J2: two joints coupled by crossed cables, with friction at four contacts and in the joint (system `ccsrm`).

    J theta_1'' = r (T_21 - T_11) - tau,   T_12 = T_p - k r (theta_2 - theta_1),   T_22 = T_p + k r (theta_2 - theta_1)
    T_i1 = T_i2 - f_i1,   f = s0 z + s1 z' + s2 v,   z' = v - s0 |v| z / g
    g = (|T (1 - exp(-mu w sgn v))| + eps) (1 + (mu_s / mu - 1) exp(-(v / v_s)^2))

v and w: sliding velocity and wrap angle of each contact. The joint's friction tau is a bristle on a constant level."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.problem import Problem
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.system import System

EFFECTS = (
    "joint:coulomb",
    "joint:presliding",
    "contact:capstan",
    "contact:stribeck",
    "contact:presliding",
    "contact:viscous",
)
# In the order of the parameters of `rate`; after them amplitude and angular frequency of joint 2.
VALUES = {
    "cable_stiffness": 1e6,
    "pretension": 50.0,
    "pulley_radius": 0.012,
    "initial_wrap_angle": 1.69,
    "inertia": 0.01,
    "bristle_stiffness": 1e6,
    "bristle_damping": 1e3,
    "contact_viscous": 500.0,
    "friction_coefficient": 0.15,
    "static_friction_coefficient": 0.18,
    "stribeck_velocity": 5e-5,
    "joint_bristle_stiffness": 1e3,
    "joint_bristle_damping": 10.0,
    "joint_coulomb": 1e-3,
    "smallest_level": 1e-6,
}
AMPLITUDE, OMEGA = math.radians(10.0), 0.5 * math.pi
SIX = tuple(VALUES)[5:11]  # the parameters of the gradients


def contact(v, tension, wrap, z, p):  # type: ignore[no-untyped-def]
    """The rate of a contact's bristle."""
    capstan = abs(tension * (1.0 - math.exp(-p[8] * wrap if v >= 0.0 else p[8] * wrap))) + p[14]
    level = capstan * (1.0 + (p[9] / p[8] - 1.0) * math.exp(-((v / p[10]) ** 2)))
    return v - p[5] * abs(v) * z / level


def rate(t, y, p, out):  # type: ignore[no-untyped-def]
    """y: theta_1, its rate, z_11, z_12, z_21, z_22 of the contacts, z of the joint. p: `VALUES`, amplitude, omega."""
    angle, driver = y[0], p[15] * math.sin(p[16] * t)
    speed, pull = p[2] * y[1], p[0] * p[2] * (driver - angle)
    driven = p[2] * p[15] * p[16] * math.cos(p[16] * t)
    out[2] = contact(-speed, p[1] - pull, p[3] + angle, y[2], p)
    out[3] = contact(driven, p[1] - pull, p[3] - driver, y[3], p)
    out[4] = contact(speed, p[1] + pull, p[3] - angle, y[4], p)
    out[5] = contact(-driven, p[1] + pull, p[3] + driver, y[5], p)
    out[6] = y[1] - p[11] * abs(y[1]) / p[13] * y[6]
    f11 = p[5] * y[2] + p[6] * out[2] - p[7] * speed
    f21 = p[5] * y[4] + p[6] * out[4] + p[7] * speed
    out[0] = y[1]
    out[1] = ((2.0 * pull + f11 - f21) * p[2] - p[11] * y[6] - p[12] * out[6]) / p[4]


def angle_and_friction(t, y, p, out):  # type: ignore[no-untyped-def]
    """Angle of joint 1, and the friction between cable 1 and pulley 1: the difference of two tensions."""
    angle, driver = y[0], p[15] * math.sin(p[16] * t)
    speed, pull = p[2] * y[1], p[0] * p[2] * (driver - angle)
    out[0] = angle
    out[1] = p[5] * y[2] + p[6] * contact(-speed, p[1] - pull, p[3] + angle, y[2], p) - p[7] * speed


def angle_alone(t, y, p, out):  # type: ignore[no-untyped-def]
    """Angle of joint 1."""
    out[0] = y[0]


def coupled(*, tensions: bool, duration: float = 10.0) -> Problem:
    """J2. `tensions`: asks for the friction of a contact besides the angle."""
    time = np.linspace(0.0, duration, round(1000 * duration) + 1)
    driver = AMPLITUDE * np.sin(OMEGA * time)
    break_z = VALUES["pretension"] * VALUES["friction_coefficient"] * VALUES["initial_wrap_angle"]
    break_z /= VALUES["bristle_stiffness"]
    break_joint = VALUES["joint_coulomb"] / VALUES["joint_bristle_stiffness"]
    return Problem(
        name="J2" if tensions else "J2, angle only",
        text=f"ccsrm with friction in the joint, {duration:g} s, angle" + (" and a contact's friction" * tensions),
        time=time,
        parameters=np.array([*VALUES.values(), AMPLITUDE, OMEGA]),
        units=np.array([AMPLITUDE, AMPLITUDE * OMEGA, *[break_z] * 4, break_joint]),
        rate=rate,
        outputs=angle_and_friction if tensions else angle_alone,
        num_outputs=2 if tensions else 1,
        system=System(kind="ccsrm", effects=EFFECTS, parameters=VALUES),
        experiment=Experiment(name="sine", data=pd.DataFrame({"driver_angle": driver}, index=pd.Index(time, name="t"))),
        read=_read_friction if tensions else _read_angle,
        reads=(0, 1, 2) if tensions else (0,),
    )


def _read_angle(run: dict[str, Any]) -> np.ndarray:
    return np.asarray(run["outputs"][:1]).T


def _read_friction(run: dict[str, Any]) -> np.ndarray:
    angle, t11, t12 = run["outputs"][:3]
    return np.stack([angle, t12 - t11], axis=1)

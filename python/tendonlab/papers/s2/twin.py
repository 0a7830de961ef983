"""The twin of S2: cables and joint behind nuts whose motion is prescribed, by a linearly implicit step.

It shares no law and no stepper with the library. The gaps that the paper names are switches: velocity ripple of the
gear, stiction that holds the sense of bushing friction at rest, a path that changes with the angle, a softer cable
at low tension.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sin
from typing import Literal

import numpy as np
import pandas as pd

from tendonlab.arguments import within
from tendonlab.errors import ParameterError
from tendonlab.papers.s2 import equations
from tendonlab.papers.s2.cable import Spring
from tendonlab.papers.s2.equations import Array
from tendonlab.papers.s2.joint import Joint
from tendonlab.papers.s2.trapezoids import Reference
from tendonlab.papers.s2.values import Constants

Sense = Literal["instantaneous", "hold", "reference", "smooth"]
SENSES: tuple[Sense, ...] = ("instantaneous", "hold", "reference", "smooth")
SMOOTH_SPEED = 1e-4  # m/s, over which "smooth" friction turns
RESTING = 1e-12  # m/s, up to which a velocity of the joint is rounding


@dataclass(frozen=True, kw_only=True)
class PID:
    """Velocity of the nuts from the angle error: the reference's own, plus kp e + ki int e + kd e'. Gains in m/s per
    rad, rad*s, rad/s; `limit` in m/s. Reconstructed: the paper gives no gains."""

    kp: float = 0.5
    ki: float = 0.5
    kd: float = 0.0
    limit: float = 0.02


def simulate(
    of: Constants,
    reference: Reference,
    *,
    controller: PID | None = None,
    ripple: float = 0.0,
    sense: Sense = "instantaneous",
    path_error: float = 0.0,
    toe_tension: float = 0.0,
) -> pd.DataFrame:
    """Simulate the joint behind nuts that follow `reference`; a frame by time "t", s, SI.

    `controller`: closes the loop on theta; without one the nuts move as the reference asks, r cos(theta) theta'.
    `ripple`: u' -> u' (1 + ripple sin(2 pi u / p)) of the nuts. `sense`: what friction of the bushings follows, the
    joint's velocity ("instantaneous"), the nuts' and at rest their last ("hold"), the reference's, held likewise
    ("reference"), or the joint's over 1e-4 m/s ("smooth"). `path_error`: path, m, that both cables gain as
    1 - cos(theta), which stretches them and brakes the joint. `toe_tension`: N, below which the cables are softer
    (`Spring`). Columns: theta, theta_rate, nut_rate, elongation (common to both, cable 1 longer and 2 shorter), F_r_1,
    F_r_2, F_act_1, F_act_2. S2 eqs. 2 to 11.
    Raises ParameterError for an unknown `sense`, and for a `toe_tension` that is no number or negative."""
    if sense not in SENSES:
        raise ParameterError(f"sense = {sense!r}: expected one of {', '.join(SENSES)}")
    spring = Spring(of, within("toe_tension", toe_tension, 0.0, np.inf, "N"))
    steps = _steps(of, reference, controller, ripple, spring, path_error)
    motion = pd.DataFrame(steps, index=pd.Index(reference.time, name="t"))
    return motion.join(_forces(of, motion, reference, sense, path_error, spring))


def _steps(
    of: Constants, reference: Reference, controller: PID | None, ripple: float, spring: Spring, path_error: float
) -> dict[str, Array]:
    """Theta, its rate, common elongation e of cable 1 (that of cable 2 is -e), and its rate at every step."""
    h = reference.step
    wanted = (of.r * np.cos(reference.angle) * reference.velocity).tolist()
    aims, aim_rates = reference.angle.tolist(), reference.velocity.tolist()
    joint = Joint.at_rest(of, spring, h, aims[0], path_error=path_error)
    u = integral = 0.0
    rows = []
    for nut, aim, aim_rate in zip(wanted, aims, aim_rates, strict=True):
        if controller is not None:
            error = aim - joint.theta
            integral += h * error
            nut += controller.kp * error + controller.ki * integral + controller.kd * (aim_rate - joint.rate)
            nut = min(max(nut, -controller.limit), controller.limit)
        if ripple:
            nut *= 1.0 + ripple * sin(2.0 * pi * u / of.p)
        rows.append((joint.theta, joint.rate, nut, joint.e, joint.stretch))
        joint.advance(nut)
        u += h * nut
    names = ("theta", "theta_rate", "nut_rate", "elongation", "elongation_rate")
    return dict(zip(names, np.array(rows).T, strict=True))


def _forces(
    of: Constants, motion: pd.DataFrame, reference: Reference, sense: Sense, path_error: float, spring: Spring
) -> pd.DataFrame:
    theta = motion["theta"].to_numpy()
    e, rate = motion["elongation"].to_numpy(), motion["elongation_rate"].to_numpy()
    path, growing = path_error * (1.0 - np.cos(theta)), path_error * np.sin(theta) * motion["theta_rate"].to_numpy()
    velocity = of.r * np.cos(theta) * motion["theta_rate"].to_numpy()
    velocity[np.abs(velocity) <= RESTING] = 0.0
    followed = {"hold": motion["nut_rate"].to_numpy(), "reference": reference.velocity}.get(sense, velocity)
    found: dict[str, Array] = {}
    for i, sign in enumerate((1.0, -1.0)):
        tension = np.array([spring.pull(x)[0] for x in (sign * e + path).tolist()])
        carried = np.maximum(0.0, tension + of.c * (sign * rate + growing))
        if sense == "smooth":
            forward, backward = (equations.bushing_force(of.bushings[i], theta, s, of.T) for s in (1.0, -1.0))
            share = np.tanh(velocity / SMOOTH_SPEED)
            friction = 0.5 * (forward + backward) + 0.5 * (forward - backward) * share
        else:
            friction = equations.bushing_force(of.bushings[i], theta, last_sense(followed), of.T)
        found |= {f"F_r_{i + 1}": carried, f"F_act_{i + 1}": carried + friction}
    return pd.DataFrame(found, index=motion.index)


def last_sense(velocity: Array) -> Array:
    """Sign of a velocity, at rest that of the motion before; +1 before any motion. Shape of `velocity`, (n,)."""
    sign = np.sign(velocity)
    latest = np.maximum.accumulate(np.where(sign != 0, np.arange(len(sign)), -1))
    return np.where(latest >= 0, sign[np.maximum(latest, 0)], 1.0)


def measured(run: pd.DataFrame, *, seed: int | np.random.Generator = 0, quantize: float | None = None) -> pd.DataFrame:
    """What the rig would log of a run: joint_angle (18 bit), joint_velocity, cable_force_1, cable_force_2 and the
    drive's actuator_velocity is left to the caller. Noise sd: 12 urad, without which repeats would repeat to the last
    bit, 2 mrad/s, 1.5 N; `quantize`: resolution of the forces, N (5 on the rig). Reconstructed: the paper prints
    resolutions only (S2 sec. IV-A)."""
    random = np.random.default_rng(seed)
    bit = 2.0 * np.pi / 2**18
    log = pd.DataFrame(index=run.index)
    log["joint_angle"] = run["theta"]
    log["joint_velocity"] = run["theta_rate"] + 2e-3 * random.normal(size=len(run))
    for i in (1, 2):
        force = run[f"F_act_{i}"] + 1.5 * random.normal(size=len(run))
        log[f"cable_force_{i}"] = force if quantize is None else quantize * np.round(force / quantize)
    log["joint_angle"] = bit * np.round(run["theta"] / bit + 0.5 * random.normal(size=len(run)))
    return log

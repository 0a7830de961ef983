"""The joint behind its motor: a PID controller of its angle sets the voltage, helped by a feed-forward of what is known
of motor, gear, cables and bushings (S2 sec. V). Motor and winding step implicitly, as cables and joint do."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan, tanh

import numpy as np
import pandas as pd

from tendonlab.arguments import reals
from tendonlab.errors import ParameterError
from tendonlab.papers.s2 import equations
from tendonlab.papers.s2.cable import Spring
from tendonlab.papers.s2.equations import Array
from tendonlab.papers.s2.forces import feedforward
from tendonlab.papers.s2.joint import Joint
from tendonlab.papers.s2.trapezoids import Reference
from tendonlab.papers.s2.values import Constants

CREEP = 1e-6  # m/s of the nuts, over which friction of the bushings turns
ANGLES = np.linspace(-1.2, 1.2, 4801)  # rad, at which that friction is tabulated


@dataclass(frozen=True, kw_only=True)
class VoltagePID:
    """Voltage from the angle error e: kp e + ki int e + kd e'. Gains in V per rad, rad*s, rad/s. Reconstructed."""

    kp: float = 1500.0
    ki: float = 1500.0
    kd: float = 0.0


def feedforward_voltage(of: Constants, reference: Reference, *, friction: bool = True) -> Array:
    """Voltage that moves the joint along `reference`, V, shape (n,): for the motor's speed, and with `friction` for
    gear, bushings in the sense of the reference, and gravity, by S2 eqs 1, 6, 11, 12."""
    held = equations.holding_difference(of, reference.angle)
    nut = of.r * np.sin(reference.angle) + held / (2.0 * of.K)
    omega = np.gradient(nut, reference.step) / of.N
    torque = of.c_m * omega + of.J_m * np.gradient(omega, reference.step)
    if friction:
        rubbed = feedforward(of, reference)
        torque += equations.gear_torque(of, omega)
        torque += of.N * (held + (rubbed["F_a_1"] - rubbed["F_a_2"]).to_numpy())
    return np.asarray(of.R_m / of.k_m * torque + of.k_m * omega)


def track(
    of: Constants, reference: Reference, *, controller: VoltagePID | None = None, ahead: Array | None = None
) -> pd.DataFrame:
    """The joint along `reference` under `controller` (default: its defaults) and a voltage `ahead`, V, shape (n,).

    Columns by time "t", s: voltage, motor_velocity, theta, theta_rate, error (of the angle, rad).
    Raises ParameterError for an `ahead` of another length."""
    gains, h = controller or VoltagePID(), reference.step
    given = np.zeros(len(reference.time)) if ahead is None else reals("ahead", ahead)
    if given.shape != reference.time.shape:
        raise ParameterError(f"ahead: {given.shape}; expected {reference.time.shape}, one voltage per sample")
    joint = Joint.at_rest(of, Spring(of), h, float(reference.angle[0]))
    rub = _nut_friction(of)
    current = omega = integral = 0.0
    rows = []
    for aim, aim_rate, extra in zip(reference.angle.tolist(), reference.velocity.tolist(), given.tolist(), strict=True):
        error = aim - joint.theta
        integral += h * error
        voltage = extra + gains.kp * error + gains.ki * integral + gains.kd * (aim_rate - joint.rate)
        rows.append((voltage, omega, joint.theta, joint.rate, error))
        even, odd = (float(np.interp(joint.theta, ANGLES, part)) for part in rub)
        carried = joint.pull_difference() + even + odd * tanh(of.N * omega / CREEP)
        load = of.N * carried + of.alpha * atan(of.beta * omega)
        current, omega = _motor(of, h, current, omega, voltage, load)
        joint.advance(of.N * omega)
    names = ["voltage", "motor_velocity", "theta", "theta_rate", "error"]
    return pd.DataFrame(rows, columns=names, index=pd.Index(reference.time, name="t"))


def _nut_friction(of: Constants) -> tuple[Array, Array]:
    """F_a,1 - F_a,2 at ANGLES, N: what does not change with the sense of motion, and what does."""
    one, two = ([equations.bushing_force(b, ANGLES, s, of.T) for s in (1.0, -1.0)] for b in of.bushings)
    forward, backward = one[0] - two[0], one[1] - two[1]
    return 0.5 * (forward + backward), 0.5 * (forward - backward)


def _motor(of: Constants, h: float, current: float, omega: float, voltage: float, load: float) -> tuple[float, float]:
    """Current, A, and speed, rad/s, after a step under `voltage` and the torque `load`, N*m (S2 eq. 1)."""
    resisting, inertia = of.L_m / h + of.R_m, of.J_m / h + of.c_m
    speed = (inertia - of.c_m) * omega - load + of.k_m * (of.L_m / h * current + voltage) / resisting
    omega = speed / (inertia + of.k_m**2 / resisting)
    return (of.L_m / h * current + voltage - of.k_m * omega) / resisting, omega

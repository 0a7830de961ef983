"""The mechanism as a twin: the equations of S4 (28) to (35) with consistent signs, solved by scipy.

It shares neither law nor stepper with the library, so that the library can be tested, and diagnosed, against it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pandas as pd

from tendonlab.errors import NumericalError, ParameterError
from tendonlab.papers.s4.constants import Contact, Joint, Mechanism
from tendonlab.papers.s4.drive import Drive
from tendonlab.papers.s4.friction import LineContact, joint_friction

TENSIONS = ("T11", "T12", "T13", "T21", "T22", "T23")
CONTACTS = ("11", "12", "21", "22")
FLIP = (-1.0, 1.0, 1.0, -1.0)  # direction of each contact's slip towards the middle section, per turn of its joint
PRINTED = (1.0, 1.0, -1.0, -1.0)  # as S4 eq. (35) prints it: friction then drives joint 1
JOINT_OF = (0, 1, 0, 1)
METHODS = ("LSODA", "Radau", "DOP853")
State = Sequence[float]


@dataclass(frozen=True, kw_only=True)
class CcsrmModel:
    """Joint 2 is driven, joint 1 follows through two cables; one bristle per contact (S4 eqs 30 to 35).

    `end_stiffness`, N/m: of the sections between pulleys and links; None: they do not stretch, as the paper has it.
    `signs`: "consistent", or "printed" to see why not."""

    mechanism: Mechanism
    contact: Contact
    joint: Joint | None = None
    end_stiffness: float | None = None
    static: str = "ratio"
    signs: str = "consistent"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the states, in order: theta1, om1, the bristles, the slips where the ends stretch."""
        slips = () if self.end_stiffness is None else tuple(f"w{c}" for c in CONTACTS)
        return ("theta1", "om1", *(f"z{c}" for c in CONTACTS), "z_joint", *slips)

    def simulate(
        self,
        drive: Drive,
        time: np.ndarray,
        *,
        method: str = "LSODA",
        rtol: float = 1e-8,
        longest_step: float = 5e-3,
    ) -> pd.DataFrame:
        """Run from rest: states, theta2, om2, the six tensions and four frictions at `time`, s, which begins at 0.

        The integrator starts anew at every reversal of joint 2. `longest_step`, s. Raises ParameterError for another
        method, NumericalError where the solver fails (with the printed signs it does)."""
        if method not in METHODS:
            raise ParameterError(f"method = {method!r}: expected one of {', '.join(METHODS)}")
        x = np.zeros(len(self.names))
        rows = [x[None, :]]
        for begin, end, inside in _pieces(np.asarray(time, dtype=float), drive.reversals(float(time[-1]))):
            instants = np.unique([*inside, end])
            states = self._solve(drive, x, begin, instants, method, rtol, longest_step)
            rows.append(states[: len(inside)])
            x = states[-1]
        return self._frame(drive, np.asarray(time, dtype=float), np.concatenate(rows))

    def rate(self, drive: Drive, t: float, x: State) -> list[float]:
        """Rate of the state (`names`) at t, s."""
        tensions, _, v, zdot = self.forces(float(drive.angle(t)), float(drive.rate(t)), x)
        torque = self.mechanism.r * (tensions[3] - tensions[0])
        zj, held = (0.0, 0.0) if self.joint is None else joint_friction(x[6], x[1], self.joint)
        slips = [] if self.end_stiffness is None else v
        return [x[1], (torque - held) / self.mechanism.J, *zdot, zj, *slips]

    def forces(
        self, theta_2: float, om_2: float, x: State
    ) -> tuple[list[float], list[float], list[float], list[float]]:
        """The six tensions, N; friction of the contacts, N; their slip, m/s; the rates of their bristles, m/s."""
        m, theta, om = self.mechanism, (x[0], theta_2), (x[1], om_2)
        line = LineContact(self.contact, self.static)
        wraps = (m.theta_w0 + x[0], m.theta_w0 - theta_2, m.theta_w0 - x[0], m.theta_w0 + theta_2)
        middle = self._middle(theta_2, x)
        ends, friction, slip, zdot = [], [], [], []
        for i in range(4):
            T, z = middle[i // 2], x[2 + i]
            if self.end_stiffness is None:
                v = (PRINTED if self.signs == "printed" else FLIP)[i] * m.r * om[JOINT_OF[i]]
                zdot.append(line.rate(z, v, T, wraps[i]))
                f = line.force(z, v, zdot[i])
            else:
                end = m.T_p + self.end_stiffness * (x[7 + i] - FLIP[i] * m.r * theta[JOINT_OF[i]])
                f = T - max(end, 0.0)
                v = line.slip(z, f, T, wraps[i])
                zdot.append(line.rate(z, v, T, wraps[i]))
            ends.append(T - f)
            friction.append(f)
            slip.append(v)
        return [ends[0], middle[0], ends[1], ends[2], middle[1], ends[3]], friction, slip, zdot

    def _middle(self, theta_2: float, x: State) -> tuple[float, float]:
        """T12 and T22, N: no less than 0."""
        m = self.mechanism
        if self.end_stiffness is None:
            pull = m.k * m.r * (theta_2 - x[0])
            return max(m.T_p - pull, 0.0), max(m.T_p + pull, 0.0)
        return max(m.T_p - m.k * (x[7] + x[8]), 0.0), max(m.T_p - m.k * (x[9] + x[10]), 0.0)

    def _solve(
        self, drive: Drive, x: np.ndarray, begin: float, time: np.ndarray, method: str, rtol: float, longest_step: float
    ) -> np.ndarray:
        from scipy.integrate import solve_ivp

        scale = np.array([1e-1, 1e-1, *[1e-5] * 4, 1e-5, *[1e-3] * (len(x) - 7)])
        rate: Callable[[float, np.ndarray], list[float]] = lambda t, y: self.rate(drive, t, y.tolist())  # noqa: E731
        with np.errstate(over="ignore"):
            done = solve_ivp(
                rate, (begin, time[-1]), x, method=method, t_eval=time, rtol=rtol, atol=1e-2 * rtol * scale,
                max_step=longest_step,
            )  # fmt: skip
        if not done.success or not np.all(np.isfinite(done.y)):
            raise NumericalError(f"twin stopped at t = {done.t[-1] if len(done.t) else begin:g} s: {done.message}")
        return np.asarray(done.y.T)

    def _frame(self, drive: Drive, time: np.ndarray, states: np.ndarray) -> pd.DataFrame:
        theta_2, om_2 = drive.angle(time), drive.rate(time)
        rows = [self.forces(*at) for at in zip(theta_2.tolist(), om_2.tolist(), states.tolist(), strict=True)]
        frame = pd.DataFrame(states, index=pd.Index(time, name="t"), columns=list(self.names))
        frame.insert(0, "theta2", theta_2)
        frame.insert(1, "om2", om_2)
        for k, name in enumerate(TENSIONS):
            frame[name] = [row[0][k] for row in rows]
        for k, name in enumerate(CONTACTS):
            frame[f"f{name}"] = [row[1][k] for row in rows]
        return frame


def _pieces(time: np.ndarray, reversals: np.ndarray) -> Iterator[tuple[float, float, np.ndarray]]:
    """Start and end of each stretch between reversals, and the instants after its start up to its end."""
    borders = [time[0], *reversals[reversals < time[-1]], time[-1]]
    for begin, end in pairwise(borders):
        yield begin, end, time[(time > begin) & (time <= end)]

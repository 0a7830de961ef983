"""Cables and joint of the twin behind nuts that move, by a linearly implicit step."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin

from tendonlab.papers.s2 import equations
from tendonlab.papers.s2.cable import Spring
from tendonlab.papers.s2.values import Constants


@dataclass(slots=True)
class Joint:
    """Angle `theta`, rad, and its `rate`; elongation `e`, m, of cable 1 (that of cable 2 is -e) and its rate `stretch`.
    `step`: s; `path_error`: path, m, that both cables gain as 1 - cos(theta)."""

    of: Constants
    spring: Spring
    step: float
    path_error: float
    fixed: float
    swinging: float
    theta: float
    e: float
    rate: float = 0.0
    stretch: float = 0.0

    @classmethod
    def at_rest(cls, of: Constants, spring: Spring, step: float, theta: float, *, path_error: float = 0.0) -> Joint:
        """Held by its cables at `theta`."""
        fixed = float(equations.inertia(of, pi / 2.0))
        swinging = float(equations.inertia(of, 0.0)) - fixed
        held = spring.holding(float(equations.holding_difference(of, theta)))
        return cls(of, spring, step, path_error, fixed, swinging, theta, held)

    def advance(self, nut: float) -> None:
        """One step with nuts at velocity `nut`, m/s, by S2 eqs 2 to 6: stiffness and damping count at its end."""
        of, h, theta, rate, e = self.of, self.step, self.theta, self.rate, self.e
        arm = of.r * cos(theta)
        inertia = self.fixed + self.swinging * cos(theta)
        near, far = cos(theta + of.phi), cos(2.0 * theta + of.phi)
        gravity = -of.g * (of.m_1 * of.d_11 * near + of.m_2 * (of.l_1 * near + 2.0 * of.d_21 * far))
        path, slope = self.path_error * (1.0 - cos(theta)), self.path_error * sin(theta)
        (one, stiff_1), (two, stiff_2) = self.spring.pull(path + e), self.spring.pull(path - e)
        stiffness = stiff_1 + stiff_2
        pull = arm * (one - two + (h * stiffness + 2.0 * of.c) * nut)
        pull -= slope * (one + two + 2.0 * of.c * slope * rate)
        whirl = 2.0 * of.m_2 * of.l_1 * of.d_21 * sin(theta) * rate * rate
        rate = (inertia * rate + h * (pull + gravity + whirl)) / (
            inertia + h * arm * arm * (h * stiffness + 2.0 * of.c)
        )
        self.rate, self.stretch = rate, nut - arm * rate
        self.e, self.theta = e + h * self.stretch, theta + h * rate

    def pull_difference(self) -> float:
        """F_r,1 - F_r,2, N, of taut cables."""
        path = self.path_error * (1.0 - cos(self.theta))
        return self.spring.pull(path + self.e)[0] - self.spring.pull(path - self.e)[0] + 2.0 * self.of.c * self.stretch

"""The motion of the S2 experiments: trapezoids of velocity between set points, with dwells (reconstructed)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from tendonlab.arguments import positive, samples, within
from tendonlab.errors import ParameterError
from tendonlab.papers.s2.equations import Array


@dataclass(frozen=True)
class Reference:
    """Angle, rad, and velocity, rad/s, of the joint at `time`, s, shape (n,), every `step` s. `moves`: start and end
    of each move, s."""

    time: Array
    angle: Array
    velocity: Array
    moves: tuple[tuple[float, float], ...]

    @property
    def step(self) -> float:
        """Time between samples, s."""
        return float(self.time[1] - self.time[0])

    def cruise(self) -> np.ndarray:
        """True where the reference moves at its full speed, shape (n,)."""
        top = np.abs(self.velocity).max()
        return np.asarray(np.abs(np.abs(self.velocity) - top) < 1e-9 * top)


def reference(
    points: Sequence[float] = (0.0, 0.6, -0.6, 0.0),
    *,
    speed: float = 0.06,
    acceleration: float = 0.08,
    dwell: float = 2.0,
    start: float = 1.0,
    end: float | None = None,
    step: float = 1e-3,
) -> Reference:
    """Moves between `points`, rad, at `speed`, rad/s, with ramps of `acceleration`, rad/s^2, `dwell` s apart, the first
    at `start` s. `end`: of time, s; 1 s after the last move unless given. The paper prints none of this:
    the defaults are reconstructed.

    Raises ParameterError for a speed, acceleration or step that is not positive, a negative dwell, and where a move is
    too short to reach its speed."""
    samples("points", points)
    positive("speed", speed, "rad/s")
    positive("acceleration", acceleration, "rad/s^2")
    positive("step", step, "s")
    within("dwell", dwell, 0.0, np.inf, "s")
    within("start", start, -np.inf, np.inf, "s")
    ramp = speed / acceleration
    pieces, moves, now = [], [], start
    for a, b in pairwise(points):
        length = abs(b - a) / speed + ramp
        if abs(b - a) < speed * ramp:
            raise ParameterError(
                f"move of {b - a:g} rad: expected at least {speed * ramp:g} rad to reach {speed:g} rad/s"
            )
        pieces.append((now, length, b - a))
        moves.append((now, now + length))
        now += length + dwell
    count = round(((now - dwell + 1.0) if end is None else end) / step) + 1
    time: Array = step * np.arange(count, dtype=np.float64)
    angle, velocity = np.full(count, float(points[0])), np.zeros(count)
    for begin, length, way in pieces:
        since = np.clip(time - begin, 0.0, length)
        left = length - since
        rise, fall = np.minimum(since, ramp), ramp - np.minimum(left, ramp)
        sign = np.sign(way)
        velocity += sign * acceleration * (rise - fall)
        late = np.maximum(left - ramp, 0.0)
        middle = length - 2.0 * ramp - late  # time at full speed so far, negative while speeding up
        cruise = speed * np.maximum(middle, 0.0)
        angle += sign * (0.5 * acceleration * rise**2 + cruise + speed * fall - 0.5 * acceleration * fall**2)
    return Reference(time, angle, velocity, tuple(moves))

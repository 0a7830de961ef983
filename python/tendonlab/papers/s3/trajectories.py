"""The torques that the paper commands (S3 Table I): sines of three periods and a superposition of odd harmonics."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tendonlab.errors import ParameterError

HARMONICS = {"sine": ((1, 1.0),), "superposed": ((1, 1.0), (3, 1.0 / 3.0), (5, 0.2))}


@dataclass(frozen=True)
class Trajectory:
    """A commanded torque of `amplitude` A, N·m, and `period`, s: A sin(w t), or, `kind` "superposed", A times the sum
    of sin(n w t)/n over n = 1, 3, 5 (the argument of its first sine is misprinted)."""

    kind: str
    amplitude: float
    period: float

    def __post_init__(self) -> None:
        if self.kind not in HARMONICS:
            raise ParameterError(f"kind = {self.kind!r}: expected one of {', '.join(HARMONICS)}")
        if not (self.period > 0 and np.isfinite(self.amplitude)):
            raise ParameterError(
                f"amplitude = {self.amplitude} N*m, period = {self.period} s: expected finite numbers and a period > 0"
            )

    @property
    def frequency(self) -> float:
        """1/period, Hz."""
        return 1.0 / self.period

    def torque(self, time: np.ndarray | float) -> np.ndarray:
        """tau_in, N·m, shape of `time`, s."""
        turns = 2.0 * np.pi * np.asarray(time, dtype=float) / self.period
        return np.asarray(self.amplitude * sum(share * np.sin(n * turns) for n, share in HARMONICS[self.kind]))


def table_1(*, amplitude: float = 15.0, superposed_period: float = 10.0) -> tuple[Trajectory, ...]:
    """The four trajectories of each group: sines of 5, 7 and 10 s, then the superposed one (its period is not given in
    the paper; 10 s is assumed). Source: S3 Table I."""
    sines = tuple(Trajectory("sine", amplitude, period) for period in (5.0, 7.0, 10.0))
    return (*sines, Trajectory("superposed", amplitude, superposed_period))

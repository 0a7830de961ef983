"""Many simulations of one problem with drawn parameters."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pandas as pd

import tendonlab as tl
from benchmarks import mass, mechanism
from benchmarks.clock import Call
from benchmarks.problem import Problem

# Of the mechanisms: factors on the values of J2.
RANGES = {
    "cable_stiffness": (0.3, 1.2),
    "pretension": (1.0, 2.0),
    "friction_coefficient": (0.6, 1.3),
    "bristle_stiffness": (0.5, 2.0),
    "stribeck_velocity": (0.5, 4.0),
}


@dataclass(frozen=True, eq=False)
class Sweep:
    """`points`: parameters of the rate, one row per simulation. `table`: the same for the library. `outputs`: what the
    library keeps."""

    problem: Problem
    points: np.ndarray
    table: pd.DataFrame
    outputs: tuple[str, ...]

    def first(self, num: int) -> Sweep:
        return replace(self, points=self.points[:num], table=self.table[:num])

    def call(self, tolerance: float) -> Call:
        """One call of `tl.sweep`."""
        return partial(
            tl.sweep,
            self.problem.system,
            self.table,
            experiment=self.problem.experiment,
            outputs=self.outputs,
            tolerance=tolerance,
            progress=False,
        )

    def read_call(self, tolerance: float) -> Call:
        """The same, and its outputs gathered as the peers give them: shape (points, samples, k)."""
        call = self.call(tolerance)

        def read() -> np.ndarray:
            found = call()
            columns = [found[name].to_numpy() for name in self.outputs]
            return np.stack([self.problem.read({"outputs": run}) for run in zip(*columns, strict=True)])

        return read


def masses(num: int) -> Sweep:
    """J1a with drawn friction and amplitude; position and velocity are asked for."""
    problem, share = mass.driven(force=False), _shares(num, 7)
    points = np.tile(problem.parameters, (num, 1))
    points[:, 1] = 10.0 ** (4.0 + 2.0 * share[0])
    points[:, 2] = np.sqrt(points[:, 1]) * (0.5 + share[1])
    points[:, 3] = share[2]
    points[:, 4] = 0.5 + share[3]
    points[:, 5] = points[:, 4] * (0.1 + 0.9 * share[4])
    points[:, 6] = 5e-4 * 10.0 ** share[5]
    points[:, 7] = (points[:, 4] + points[:, 5]) * (1.1 + 1.4 * share[6])
    table = pd.DataFrame(points[:, 1:8], columns=[*mass.FRICTION, "torque_constant"])
    return Sweep(problem, points, table, ("joint_angle", "joint_velocity"))


def mechanisms(num: int, duration: float = 10.0) -> Sweep:
    """J2 with drawn cables and contacts; the angle and the friction of a contact are asked for."""
    problem, share = mechanism.coupled(tensions=True, duration=duration), _shares(num, 6)
    points = np.tile(problem.parameters, (num, 1))
    place = {name: k for k, name in enumerate(mechanism.VALUES)}
    for (name, (low, high)), drawn in zip(RANGES.items(), share, strict=False):
        points[:, place[name]] *= low + (high - low) * drawn
    static, kinetic = place["static_friction_coefficient"], place["friction_coefficient"]
    points[:, static] = points[:, kinetic] * (1.1 + 0.4 * share[5])
    names = [*RANGES, "static_friction_coefficient"]
    table = pd.DataFrame(points[:, [place[name] for name in names]], columns=names)
    return Sweep(problem, points, table, ("joint_angle", "tension_11", "tension_12"))


def _shares(num: int, columns: int) -> np.ndarray:
    """Uniform in [0, 1), shape (columns, num): the first points are the same however many there are."""
    return np.random.default_rng(1).uniform(size=(num, columns)).T

"""A motor on a pendulum under position control, in plain numpy, and its logs with mistakes in them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

import tendonlab as tl

INERTIA, GRAVITY, CONSTANT, COULOMB, VISCOUS = 0.02, 1.1, 0.5, 0.08, 0.03
Motion = Callable[[np.ndarray], np.ndarray]
RATE, FINE = 250, 8  # samples per second, steps of the simulation per sample
MOTIONS: dict[str, Motion] = {
    "reversals": lambda t: 0.9 * np.sin(1.1 * t),
    "quick": lambda t: 0.5 * np.sin(4.0 * t) + 0.15 * np.sin(11.0 * t),
    "sweep": lambda t: 0.4 * np.sin((0.8 + 0.5 * t) * t),
    "other": lambda t: 0.6 * np.sin(2.3 * t) * np.sin(0.4 * t),
}


@dataclass(frozen=True)
class Logs:
    """Time, s, angle, rad, and current, A, of every run, as they are written: `units` of time, angle and current."""

    runs: dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]
    units: tuple[str, str, str] = ("s", "rad", "A")
    constant: float = CONSTANT
    extra: str = field(default="")

    def changed(self, *, time: float = 1.0, angle: float = 1.0, current: float = 1.0) -> "Logs":
        """The logs with factors on their columns."""
        return replace(self, runs={n: (time * t, angle * q, current * i) for n, (t, q, i) in self.runs.items()})

    def write(self, folder: Path) -> tl.Dataset:
        """As a dataset folder, and what `load` makes of it."""
        folder.mkdir(exist_ok=True)
        for name, columns in self.runs.items():
            table = np.column_stack(columns)
            np.savetxt(folder / f"{name}.csv", table, delimiter=",", header="t,q,i", comments="", fmt="%.9g")
        time, angle, current = self.units
        experiments = "".join(f'[[experiments]]\nname = "{n}"\nfile = "{n}.csv"\n{self.extra}\n' for n in self.runs)
        (folder / "dataset.toml").write_text(
            f"""format = "tendonlab-dataset/1"
name = "pendulum"
time = {{ column = "t", unit = "{time}" }}
[system]
kind = "rigid_joint"
[system.parameters]
inertia = {{ value = 0.019, sd = 0.002 }}
gravity_torque = {{ value = 1.15, sd = 0.1 }}
torque_constant = {{ value = {self.constant}, sd = 0 }}
coulomb = {{ value = 0.06 }}
viscous = {{ value = 0.04 }}
[signals]
motor_torque = {{ column = "i", unit = "{current}" }}
joint_angle = {{ column = "q", unit = "{angle}" }}
{experiments}"""
        )
        return tl.load(folder)


def record(*, late: float = 0.0, seed: int = 0, motions: Mapping[str, Motion] = MOTIONS) -> Logs:
    """Correct logs; the angle is read `late`, s, with a noise of 0.2 mrad, the current with one of 10 mA."""
    rng, runs = np.random.default_rng(seed), {}
    for name, motion in motions.items():
        time, angle, current = _simulate(motion)
        seen = np.interp(time - late, time, angle) + 2e-4 * rng.standard_normal(len(time))
        runs[name] = (time, seen, current + 0.01 * rng.standard_normal(len(time)))
    return Logs(runs)


def late_run(logs: Logs, name: str, by: float) -> Logs:
    """One run whose angle comes later than in the others."""
    time, angle, current = logs.runs[name]
    return replace(logs, runs={**logs.runs, name: (time, np.interp(time - by, time, angle), current)})


def _simulate(motion, seconds: float = 8.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Semi-implicit Euler, dry friction implicit; the current is held from sample to sample."""
    num, step = int(seconds * RATE) + 1, 1.0 / RATE / FINE
    time, angle, current = np.arange(num) / RATE, np.empty(num), np.empty(num)
    wanted = motion(time)
    speed = np.gradient(wanted, time)
    q, v = float(wanted[0]), float(speed[0])
    for k in range(num):
        drive = 20.0 * (wanted[k] - q) + 0.8 * (speed[k] - v) + GRAVITY * np.sin(wanted[k]) / CONSTANT
        angle[k], current[k] = q, drive
        for _ in range(FINE):
            free = v + step * (CONSTANT * drive - VISCOUS * v - GRAVITY * np.sin(q)) / INERTIA
            v = float(np.sign(free) * max(0.0, abs(free) - step * COULOMB / INERTIA))
            q += step * v
    return time, angle, current

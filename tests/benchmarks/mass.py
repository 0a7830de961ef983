"""J1: a mass with LuGre friction, driven by a sine force (J1a) or dragged by a spring (J1b).

    m v' = A sin(2 pi f t) + k (V t - x) - F,   F = s0 z + s1 z' + s2 v,   z' = v - s0 |v| z / g(v)
    g(v) = Fc + Fe exp(-(v / vs)^2)

tendonlab states it as a `rigid_joint` on a linear axis. The spring of J1b is a proportional controller in continuous
time whose reference runs at the constant speed V: its effort, kp (reference - x), is that of a spring."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.problem import Problem
from tendonlab import _core
from tendonlab.simulation.records import Controller, Experiment
from tendonlab.simulation.signals import smooth
from tendonlab.simulation.system import System

EFFECTS = ("joint:coulomb", "joint:viscous", "joint:stribeck", "joint:presliding")
# The six of the gradients and fits, in the order in which they lie in the parameters of `rate`, from 1.
FRICTION = {
    "joint_bristle_stiffness": 1e5,
    "joint_bristle_damping": 1e5**0.5,
    "viscous": 0.4,
    "coulomb": 1.0,
    "joint_static_excess": 0.5,
    "joint_stribeck_velocity": 1e-3,
}
INERTIA, AMPLITUDE, FREQUENCY, SPRING, SPEED = 1.0, 2.0, 1.0, 2.0, 0.1
BREAKAWAY = FRICTION["coulomb"] / FRICTION["joint_bristle_stiffness"]  # size of the bristle's deflection, m


def rate(t, y, p, out):  # type: ignore[no-untyped-def]
    """y: x, v, z. p: m, s0, s1, s2, Fc, Fe, vs, A, f, k, V."""
    v, z = y[1], y[2]
    level = p[4] + p[5] * math.exp(-((v / p[6]) ** 2))
    bristle = v - p[1] * abs(v) * z / level
    drive = p[7] * math.sin(2.0 * math.pi * p[8] * t) + p[9] * (p[10] * t - y[0])
    out[0] = v
    out[1] = (drive - p[1] * z - p[2] * bristle - p[3] * v) / p[0]
    out[2] = bristle


def motion(t, y, p, out):  # type: ignore[no-untyped-def]
    """Position and velocity."""
    out[0], out[1] = y[0], y[1]


def position_and_force(t, y, p, out):  # type: ignore[no-untyped-def]
    """Position and friction force."""
    v, z = y[1], y[2]
    level = p[4] + p[5] * math.exp(-((v / p[6]) ** 2))
    out[0] = y[0]
    out[1] = p[1] * z + p[2] * (v - p[1] * abs(v) * z / level) + p[3] * v


def driven(*, force: bool) -> Problem:
    """J1a: 1 s under a sine force. `force`: asks for position and friction force instead of position and velocity."""
    time = np.linspace(0.0, 1.0, 1001)
    return Problem(
        name="J1a with force" if force else "J1a",
        text="mass with LuGre friction under a sine force, 1 s, "
        + ("position and friction force" if force else "position and velocity"),
        time=time,
        parameters=np.array([INERTIA, *FRICTION.values(), AMPLITUDE, FREQUENCY, 0.0, 0.0]),
        units=np.array([0.05, 0.5, BREAKAWAY]),
        rate=rate,
        outputs=position_and_force if force else motion,
        num_outputs=2,
        system=_system(AMPLITUDE),
        experiment=sine(time),
        read=_read_force if force else _read_motion,
        reads=(0,) if force else (0, 1),
        ports=("force",) if force else (),
        core=_splined(time),
    )


def dragged() -> Problem:
    """J1b: 20 s of stick-slip behind a spring whose other end moves at constant speed."""
    time = np.linspace(0.0, 20.0, 20001)
    spring = Controller(kind="pd", kp=SPRING, kd=0.0, measured="joint_angle", reference="pulled_end")
    return Problem(
        name="J1b",
        text="stick-slip of the mass behind a spring, 20 s, position and friction force",
        time=time,
        parameters=np.array([INERTIA, *FRICTION.values(), 0.0, 0.0, SPRING, SPEED]),
        units=np.array([1.0, 0.5, BREAKAWAY]),
        rate=rate,
        outputs=position_and_force,
        num_outputs=2,
        system=_system(1.0, spring),
        experiment=Experiment(name="drag", data=_frame(time, "pulled_end", SPEED * time)),
        read=_read_force,
        reads=(0,),
        ports=("force",),
    )


def sine(time: np.ndarray) -> Experiment:
    """A command sin(2 pi f t), given by its means between samples: held samples would delay it by half an interval."""
    omega, step = 2.0 * np.pi * FREQUENCY, time[1] - time[0]
    means = (np.cos(omega * time) - np.cos(omega * (time + step))) / (omega * step)
    return Experiment(name="sine", data=_frame(time, "motor_torque", means), averaged=True)


def _splined(time: np.ndarray) -> _core.Experiment:
    """The same command as a spline through its samples, which is exact to 1e-11: a frame has no way to say so."""
    command = smooth(time, np.sin(2.0 * np.pi * FREQUENCY * time))
    given = {"inputs": [command, _core.Signal()], "loop": _core.Loop(), "position": [0.0], "velocity": [0.0]}
    return _core.Experiment(kind="rigid_joint", time=time.tolist(), **given)


def _system(amplitude: float, controller: Controller | None = None) -> System:
    return System(
        kind="rigid_joint",
        axis="linear",
        effects=EFFECTS,
        parameters={"inertia": INERTIA, "gravity_torque": 0.0, "torque_constant": amplitude, **FRICTION},
        controller=controller,
    )


def _frame(time: np.ndarray, name: str, values: np.ndarray) -> pd.DataFrame:
    return pd.DataFrame({name: values}, index=pd.Index(time, name="t"))


def _read_motion(run: dict[str, Any]) -> np.ndarray:
    return np.asarray(run["outputs"]).T


def _read_force(run: dict[str, Any]) -> np.ndarray:
    return np.stack([run["outputs"][0], run["ports"][0][0]], axis=1)

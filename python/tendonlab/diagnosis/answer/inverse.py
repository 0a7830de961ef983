"""Inverse dynamics: the classical check of a rigid axis, a linear regression of its drive effort."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from tendonlab.fitting.case import Case
from tendonlab.report.diagnosis import SideTable
from tendonlab.simulation.system import System

CUTOFF = 60.0  # Hz, of a Butterworth filter of fourth order, forwards and backwards: it shifts no phase
TRIM = 0.1  # s at each end, where the filter starts and stops

Motion = tuple[np.ndarray, np.ndarray, np.ndarray]


def inverse_dynamics(case: Case, systems: Sequence[System], judged: Sequence[int]) -> SideTable | None:
    """Rms error of the drive effort for each of `systems`, fitted to the training experiments by least squares. None
    for a system of more than one axis, where the angle was not measured, or sampled too slowly."""
    info = case.system.info
    output = next((c for c, s in enumerate(info.outputs) if s.axis == 0 and c in case.measured), None)
    steps = [float(np.median(np.diff(e.time))) for e in case.experiments]
    if info.dof != 1 or not info.commanded or output is None or max(steps) > 0.25 / CUTOFF:
        return None
    motions = [_motion(case, i, output) for i in range(len(case.experiments))]
    rows = []
    for system in systems:
        names = ["inertia", *amplitudes(system)]
        train = np.concatenate([_regressors(system, motions[i]) for i in case.train])
        effort = np.concatenate([motions[i][2] for i in case.train])
        fit = np.linalg.lstsq(train, effort, rcond=None)[0]
        held = [motions[i][2] - _regressors(system, motions[i]) @ fit for i in judged]
        added = [e for e in system.effects if e not in case.system.effects]
        rows.append(
            {"model": " + ".join(["nominal structure", *added]), "fitted rms": _rms(effort - train @ fit),
             "held-out rms": _rms(np.concatenate(held)), **dict(zip(names, fit, strict=True))}
        )  # fmt: skip
    unit = "N" if case.system.axis == "linear" else "N·m"
    return SideTable(
        title="Inverse dynamics",
        frame=pd.DataFrame(rows).set_index("model"),
        note=f"Least squares on the drive effort, rms in {unit}; position, its derivatives and the effort filtered at "
        f"{CUTOFF:.0f} Hz without phase shift. Independent of the replay; blind to what the loop does with an error.",
    )


def _motion(case: Case, i: int, output: int) -> Motion:
    """Velocity and acceleration, and the drive effort, of a filtered experiment."""
    from scipy.signal import butter, filtfilt

    time = np.asarray(case.experiments[i].time)
    step = float(np.median(np.diff(time)))
    b, a = butter(4, 2 * CUTOFF * step)
    command = case.experiments[i].data[case.system.info.inputs[0].name].to_numpy(dtype=float)
    effort = command * _command_gain(case.system)
    recorded = pd.DataFrame({"position": case.prepared[i].measured[output], "effort": effort})
    whole = recorded.interpolate(limit_direction="both")
    position, effort = (filtfilt(b, a, whole[name].to_numpy()) for name in whole)
    velocity = np.gradient(position, time)
    kept = slice(round(TRIM / step), -round(TRIM / step))
    return velocity[kept], np.gradient(velocity, time)[kept], effort[kept]


def amplitudes(system: System) -> list[str]:
    """Amplitudes that enter the effort linearly: those of friction seen at the axis, and offsets."""
    info = system.info
    rows = [p for e in system.effects for p in map(info.parameter, info.effect(e).parameters)]
    return [
        p.name
        for p in rows
        if p.purpose == "amplitude" and np.any(effort_column(system, p.name, np.array([-1.0, 0.5])))
    ]


def _regressors(system: System, motion: Motion) -> np.ndarray:
    velocity, acceleration, _ = motion
    return np.column_stack([acceleration, *(effort_column(system, name, velocity) for name in amplitudes(system))])


def effort_column(system: System, name: str, velocity: np.ndarray) -> np.ndarray:
    """Drive effort per unit of one amplitude: the force of its own law, everything else switched off."""
    p = system.info.parameter(name)
    effect = system.info.effect(f"{p.element}:{p.effect}")
    own = {q: system.parameters[q] for q in effect.parameters}
    switched = {
        system.info.parameter(q).own: 1.0 if q == name else 0.0 if system.info.parameter(q).amplitude else value
        for q, value in own.items()
    }
    if (effect.group, effect.effect) == ("actuation", "offset"):
        return np.full_like(velocity, -_command_gain(system))
    if effect.group != "friction":
        return np.zeros_like(velocity)
    return np.asarray(effect.law(**switched).force(velocity=velocity))


def _command_gain(system: System) -> float:
    """Effort per unit of the command."""
    gain = system.info.with_role("command_gain")
    return 1.0 if gain is None else system.parameters[gain.name]


def _rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(x))))

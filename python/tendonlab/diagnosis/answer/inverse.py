"""Inverse dynamics: the classical check of a rigid axis, a linear regression of its drive effort."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from tendonlab.fitting.case import Case
from tendonlab.report.diagnosis import SideTable
from tendonlab.report.numbers import unit_text
from tendonlab.simulation.catalog import unit
from tendonlab.simulation.motor import effort_per_command
from tendonlab.simulation.system import System

CUTOFF = 60.0  # Hz, of a Butterworth filter of fourth order, forwards and backwards: it shifts no phase
SETTLED = 6.0  # periods of the cutoff by which a record is lengthened at its ends
HALF = 0.5  # of one amplitude, to see its column: forces are proportional, and a share keeps within its bounds
TRIM = 0.1  # s at each end, where the filter starts and stops


@dataclass(frozen=True)
class Motion:
    """A filtered experiment: position, velocity and acceleration, and the drive effort less what is known to act
    against it."""

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    effort: np.ndarray


def inverse_dynamics(case: Case, systems: Sequence[System], judged: Sequence[int]) -> SideTable | None:
    """Rms error of the drive effort for each of `systems`, fitted to the training experiments by least squares. None
    for a system of more than one axis, where its drive or its angle was not measured, or sampled too slowly."""
    info = case.system.info
    output = next((c for c, s in enumerate(info.outputs) if s.axis == 0 and c in case.measured), None)
    steps = [float(np.median(np.diff(e.time))) for e in case.experiments]
    if info.dof != 1 or not info.commanded or output is None or max(steps) > 0.25 / CUTOFF:
        return None
    if any(info.inputs[0].name not in e.data for e in case.experiments):  # nuts that move as prescribed have no drive
        return None
    motions = [_motion(case, i, output) for i in range(len(case.experiments))]
    rows = []
    for system in systems:
        names = ["inertia", *_gravity(system), *amplitudes(system)]
        train = np.concatenate([_regressors(system, motions[i]) for i in case.train])
        effort = np.concatenate([motions[i].effort for i in case.train])
        fit = np.linalg.lstsq(train, effort, rcond=None)[0]
        held = [motions[i].effort - _regressors(system, motions[i]) @ fit for i in judged]
        added = [e for e in system.effects if e not in case.system.effects]
        rows.append(
            {"model": " + ".join(["nominal structure", *added]), "fitted rms": _rms(effort - train @ fit),
             "held-out rms": _rms(np.concatenate(held)), **dict(zip(names, fit, strict=True))}
        )  # fmt: skip
    effort_unit = unit_text(unit("effort", case.system.axis))
    return SideTable(
        title="Inverse dynamics",
        frame=pd.DataFrame(rows).set_index("model"),
        note=f"Least squares on the drive effort, rms in {effort_unit}; position, its derivatives and the effort "
        f"filtered at {CUTOFF:.0f} Hz without phase shift. Independent of the replay; blind to what the loop does with "
        "an error.",
    )


def _motion(case: Case, i: int, output: int) -> Motion:
    """Experiment i filtered. The payload that it states adds to gravity, and an effort known to act on the axis helps
    the drive."""
    from scipy.interpolate import CubicSpline

    experiment, info = case.experiments[i], case.system.info
    time = np.asarray(experiment.time)
    step = float(np.median(np.diff(time)))
    effort = experiment.data[info.inputs[0].name].to_numpy(dtype=float) * effort_per_command(case.system)
    for known in info.inputs[1:]:
        if known.name in experiment.data:
            effort = effort + experiment.data[known.name].to_numpy(dtype=float)
    recorded = pd.DataFrame({"position": case.prepared[i].measured[output], "effort": effort})
    whole = recorded.interpolate(limit_direction="both")
    even = np.arange(time[0], time[-1] + 0.5 * step, step)  # a filter knows no stamps
    position = low_passed(CubicSpline(time, whole["position"])(even), step)
    effort = low_passed(np.interp(even, time, whole["effort"]), step)
    gravity = info.with_role("payload")
    effort = effort - (experiment.add.get(gravity.name, 0.0) if gravity else 0.0) * np.sin(position)
    velocity = np.gradient(position, step)
    kept = slice(round(TRIM / step), -round(TRIM / step))
    return Motion(position[kept], velocity[kept], np.gradient(velocity, step)[kept], effort[kept])


def low_passed(values: np.ndarray, step: float) -> np.ndarray:
    """Samples of one `step`, filtered at `CUTOFF` without phase shift: the gain of a Butterworth filter of order four
    that runs forwards and backwards. Beyond its ends a record goes on as its mirror image turned upside down."""
    beyond = min(len(values) - 1, round(SETTLED / (CUTOFF * step)))
    before, after = 2 * values[0] - values[beyond:0:-1], 2 * values[-1] - values[-2 : -beyond - 2 : -1]
    longer = np.concatenate([before, values, after])
    trend = np.linspace(longer[0], longer[-1], len(longer))  # what is periodic has no jump at its ends
    gain = 1.0 / (1.0 + (np.fft.rfftfreq(len(longer), step) / CUTOFF) ** 8)
    smooth = trend + np.fft.irfft(gain * np.fft.rfft(longer - trend), len(longer))
    return np.asarray(smooth[beyond : beyond + len(values)])


def _gravity(system: System) -> list[str]:
    """The parameter of the effort of gravity at 90 degrees, where gravity acts."""
    gravity = system.info.with_role("payload")
    return [gravity.name] if gravity is not None and system.parameters.get(gravity.name, 0.0) != 0.0 else []


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
    gravity = [np.sin(motion.position) for _ in _gravity(system)]
    friction = [effort_column(system, name, motion.velocity) for name in amplitudes(system)]
    return np.column_stack([motion.acceleration, *gravity, *friction])


def effort_column(system: System, name: str, velocity: np.ndarray) -> np.ndarray:
    """Drive effort per unit of one amplitude: the force of its own law, everything else switched off."""
    p = system.info.parameter(name)
    effect = system.info.effect(f"{p.element}:{p.effect}")
    of_law = {p.name for p in effect.law.parameters}  # an effect may read parameters of the system as well
    rows = [q for q in map(system.info.parameter, effect.parameters) if q.own in of_law]
    switched = {q.own: HALF if q.name == name else 0.0 if q.amplitude else system.parameters[q.name] for q in rows}
    if (effect.group, effect.effect) == ("actuation", "offset"):
        return np.full_like(velocity, -effort_per_command(system))
    if effect.group != "friction":
        return np.zeros_like(velocity)
    return np.asarray(effect.law(**switched).force(velocity=velocity)) / HALF


def _rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(x))))

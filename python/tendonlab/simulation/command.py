"""What a controller commands, from its reference and what it reads, and what noise of its sensor adds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tendonlab.arguments import JITTER
from tendonlab.simulation.reading import is_noiseless
from tendonlab.simulation.records import Controller, Experiment

FEWEST = 10  # samples of which noise can be told
HEARD = 0.5  # share of the noise of the reading that the logged command must hold
OFF_CLOCK = 0.25  # of the period: samples that are further off the ticks do not show what the controller read


def command_of(controller: Controller, experiment: Experiment, measured: np.ndarray) -> np.ndarray:
    """The command of `controller` at the samples of `experiment`, where the output that it sees is `measured`, shape
    (n,), as the core computes it."""
    from scipy.interpolate import CubicSpline

    time, data = experiment.time, experiment.data
    proportional, weight = _gains(controller)
    reference = CubicSpline(time, data[controller.reference].to_numpy(dtype=float))
    seen = CubicSpline(time, measured)
    step = controller.sample_time
    if step > 0:
        now = time[0] + np.floor((time - time[0]) / step + JITTER) * step  # the last tick of its clock
        before = np.maximum(now - step, time[0])
        change = weight * (reference(now) - reference(before)) - (seen(now) - seen(before))
        command = proportional * (reference(now) - seen(now)) + controller.kd / step * change
    else:
        slope = weight * reference(time, 1) - seen(time, 1)
        command = proportional * (reference(time) - measured) + controller.kd * slope
    command = np.clip(command, -controller.limit, controller.limit)
    return np.asarray(command + disturbance_of(controller, experiment, now if step > 0 else time))


def _gains(controller: Controller) -> tuple[float, float]:
    """Command per displacement, and the share of the reference's slope that the derivative sees."""
    if controller.kind == "cascade":
        return controller.kd * controller.kp, 0.0
    return controller.kp, 1.0 if controller.derivative_on == "error" else 0.0


def mean_command_of(controller: Controller, experiment: Experiment, measured: np.ndarray) -> np.ndarray:
    """The mean command of `controller` from each sample of `experiment` to the next, shape (n - 1,), where its clock
    ticks several times between them and the output that it sees is `measured`, shape (n,)."""
    time, step = experiment.time, np.diff(experiment.time)
    reference = experiment.data[controller.reference].to_numpy(dtype=float)
    read, change = _over_ticks(time, measured, controller.sample_time)
    if experiment.holds.get(controller.reference, False):
        wanted, moved = reference[:-1], np.diff(reference, prepend=reference[0])[:-1]
    else:
        wanted, moved = _over_ticks(time, reference, controller.sample_time)
    proportional, weight = _gains(controller)
    command = proportional * (wanted - read) + controller.kd * (weight * moved - change) / step
    disturbance = disturbance_of(controller, experiment, time[:-1] + 0.5 * step)
    return np.asarray(np.clip(command, -controller.limit, controller.limit) + disturbance)


def _over_ticks(time: np.ndarray, values: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Mean of what is read at the ticks from each sample to the next, and the sum of its backward differences there."""
    from scipy.interpolate import CubicSpline

    curve = CubicSpline(time, values)
    area = np.diff(curve.antiderivative()(time - 0.5 * period))  # each tick stands for what is around it
    return area / np.diff(time), np.diff(curve(time - period))


def fed_noise(controller: Controller, experiment: Experiment, command: str) -> tuple[np.ndarray, np.ndarray] | None:
    """Ticks of the clock of `controller`, and what was added to its command there: the logged `command` less that of
    the smoothed reading, 0 where a sample is missing. So noise that the sensor feeds back shakes a simulated rig as it
    shook the real one, which eases friction. None where there is no noise or the log does not tell: without a clock,
    without one of the signals, with other instants than the ticks, or where the logged command does not follow the
    noise of the reading."""
    from tendonlab.simulation.smoothing import smoothing_spline  # loads scipy

    step, time = controller.sample_time, experiment.time
    names = [command, controller.measured, controller.reference, *({controller.disturbance} - {None})]
    if not step > 0 or len(time) < FEWEST or not set(names) <= set(experiment.data.columns):
        return None
    tick = np.rint((time - time[0]) / step).astype(int)
    if np.any(np.diff(tick) != 1) or np.max(np.abs(time - time[0] - step * tick)) > OFF_CLOCK * step:
        return None
    logged = experiment.data[names].to_numpy(dtype=float)
    there = np.isfinite(logged).all(axis=1)
    reading = logged[there, 1]
    if there.sum() < FEWEST or is_noiseless(reading):
        return None
    filled = replace(experiment, data=experiment.data.interpolate(method="index", limit_direction="both"))
    smooth = command_of(controller, filled, smoothing_spline(time[there], reading)(time))
    added = np.where(there, logged[:, 0] - smooth, 0.0)
    asked = command_of(controller, filled, filled.data[controller.measured].to_numpy(dtype=float)) - smooth
    if not added @ asked > HEARD * (asked @ asked):
        return None
    return time[0] + step * tick, disturbance_of(controller, filled, time) + added


def disturbance_of(controller: Controller, experiment: Experiment, at: np.ndarray) -> np.ndarray:
    """What is added to the command of a controller at the instants `at`."""
    if controller.disturbance is None:
        return np.zeros(len(at))
    time, values = experiment.time, experiment.data[controller.disturbance].to_numpy(dtype=float)
    if not experiment.holds.get(controller.disturbance, True):
        return np.asarray(np.interp(at, time, values))
    near = JITTER * float(np.min(np.diff(time)))
    return np.asarray(values[np.searchsorted(time, at + near, side="right") - 1])

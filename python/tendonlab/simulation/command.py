"""What a controller commands, from its reference and what it reads."""

from __future__ import annotations

import numpy as np

from tendonlab.arguments import JITTER
from tendonlab.simulation.records import Controller, Experiment


def command_of(controller: Controller, experiment: Experiment, measured: np.ndarray) -> np.ndarray:
    """The command of `controller` at the samples of `experiment`, where the output that it sees is `measured`, shape
    (n,), as the core computes it."""
    from scipy.interpolate import CubicSpline

    time, data = experiment.time, experiment.data
    cascade = controller.kind == "cascade"
    proportional = controller.kd * controller.kp if cascade else controller.kp
    weight = 1.0 if not cascade and controller.derivative_on == "error" else 0.0
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
    return np.asarray(command + _disturbance(controller, experiment, now if step > 0 else time))


def _disturbance(controller: Controller, experiment: Experiment, at: np.ndarray) -> np.ndarray:
    """What is added to the command of a controller at the instants `at`."""
    if controller.disturbance is None:
        return np.zeros(len(at))
    time, values = experiment.time, experiment.data[controller.disturbance].to_numpy(dtype=float)
    if not experiment.holds.get(controller.disturbance, True):
        return np.asarray(np.interp(at, time, values))
    near = JITTER * float(np.min(np.diff(time)))
    return np.asarray(values[np.searchsorted(time, at + near, side="right") - 1])

"""How a simulated rig is driven: by the stated controller, by a loop that tracks the logged motion, or by inputs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from tendonlab.arguments import JITTER
from tendonlab.data import Dataset, Experiment
from tendonlab.fitting.replay import choose_replay
from tendonlab.simulation.prepare import is_held
from tendonlab.simulation.records import Controller
from tendonlab.simulation.signals import ROUNDING, white_noise_sd

REFERENCE, FEEDFORWARD = "_logged_motion", "_logged_command"  # columns of a tracking loop; no signal has these names


@dataclass(frozen=True)
class Drive:
    """`controller`: closes the loop of the simulated rig; None: its inputs alone drive it. `command`: the input that
    the controller makes, and that the simulated rig logs. `tracks`: whether the loop tracks a logged motion."""

    controller: Controller | None
    command: str | None
    tracks: bool = False

    def prepared(self, experiment: Experiment) -> Experiment:
        """The experiment with the columns that the loop needs: the logged motion and the logged command."""
        if not self.tracks or self.controller is None:
            return experiment
        data, time = experiment.data, experiment.time
        path = _smooth_path(time, data[self.controller.measured].to_numpy(dtype=float))
        added = {REFERENCE: path, FEEDFORWARD: data[self.command].to_numpy(dtype=float)}
        held = {**experiment.holds, FEEDFORWARD: experiment.holds.get(str(self.command), True)}
        return replace(experiment, data=data.assign(**added), holds=held)

    def commanded(self, experiment: Experiment, outputs: pd.DataFrame) -> np.ndarray | None:
        """What the controller commanded at each sample, shape (n,); None where there is no controller."""
        if self.controller is None or self.command is None:
            return None
        return command_of(self.controller, experiment, outputs[self.controller.measured].to_numpy(dtype=float))


def drive_of(rig: Dataset) -> Drive:
    """The stated controller; else, where the library would pull the simulated motor to the logged one, a loop of the
    same gains that tracks the logged motion beside the logged command; else the inputs alone."""
    info = rig.system().info
    command = info.command.name if info.command is not None and info.command.name in rig.inputs else None
    if rig.controller is not None:
        return Drive(rig.controller, command)
    logged = all(name in e.data.columns for e in rig for name in rig.outputs)
    replay = choose_replay(rig, rig.system()) if logged else None
    if replay is None or replay.kind != "injection" or command is None:
        return Drive(None, None)
    held = info.command is not None and is_held(rig.experiments[0], info.command)
    loop = Controller(
        kind="pd",
        kp=replay.kp or 0.0,
        kd=replay.kd or 0.0,
        measured=str(replay.output),
        reference=REFERENCE,
        disturbance=FEEDFORWARD,
        sample_time=_step(rig) if held else 0.0,
    )
    return Drive(loop, command, tracks=True)


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
        now = time[0] + np.floor((time - time[0]) / step + 1e-6) * step  # the last tick of its clock
        before = np.maximum(now - step, time[0])
        change = weight * (reference(now) - reference(before)) - (seen(now) - seen(before))
        command = proportional * (reference(now) - seen(now)) + controller.kd / step * change
    else:
        slope = weight * reference(time, 1) - seen(time, 1)
        command = proportional * (reference(time) - measured) + controller.kd * slope
    command = np.clip(command, -controller.limit, controller.limit)
    added = 0.0 if controller.disturbance is None else data[controller.disturbance].to_numpy(dtype=float)
    return np.asarray(command + added)


def _smooth_path(time: np.ndarray, logged: np.ndarray) -> np.ndarray:
    """A logged motion without its noise, at every sample."""
    from scipy.interpolate import CubicSpline

    from tendonlab.simulation.smoothing import smoothing_spline

    kept = np.isfinite(logged)
    noiseless = white_noise_sd(logged) <= ROUNDING * float(np.ptp(logged[kept]))
    make = CubicSpline if noiseless else smoothing_spline
    return np.asarray(make(time[kept], logged[kept])(time))


def _step(rig: Dataset) -> float:
    """The sampling interval that all experiments share, s; 0 where there is none."""
    first = rig.experiments[0]
    step = first.duration / (len(first.data) - 1)
    late = max(float(np.max(np.abs(e.time - e.time[0] - step * np.arange(len(e.data))))) for e in rig)
    return step if late <= JITTER * step else 0.0

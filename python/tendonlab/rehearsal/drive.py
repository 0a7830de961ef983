"""How a simulated rig is driven: by the stated controller, by a loop that tracks the logged motion, or by inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from tendonlab.arguments import JITTER
from tendonlab.data import Dataset, Experiment
from tendonlab.errors import NumericalError
from tendonlab.fitting.replay import choose_replay
from tendonlab.simulation.command import OFF_CLOCK, command_of, disturbance_of
from tendonlab.simulation.records import Controller
from tendonlab.simulation.signals import spline_near
from tendonlab.simulation.system import System

REFERENCE, FEEDFORWARD = "_logged_motion", "_logged_command"  # columns of a tracking loop; no signal has these names
FED = "_fed_noise"  # column of what noise of the sensor adds to the command
NEAR = 0.1  # of the sd of the motion: how far a rig may drift from the tracked motion when its command is played alone


@dataclass(frozen=True)
class Drive:
    """`controller`: closes the loop of the simulated rig; None: its inputs alone drive it. `command`: the input that
    the controller makes, and that the simulated rig logs. `tracks`: whether the loop tracks a logged motion."""

    controller: Controller | None
    command: str | None
    tracks: bool = False

    def prepared(self, experiment: Experiment) -> Experiment:
        """The experiment with the columns that the loop needs: the logged motion and the logged command."""
        if not self.tracks or self.controller is None or self.controller.measured not in experiment.data:
            return experiment
        data, time = experiment.data, experiment.time
        path = _smooth_path(time, data[self.controller.measured].to_numpy(dtype=float))
        added = {REFERENCE: path, FEEDFORWARD: data[self.command].to_numpy(dtype=float)}
        # Not held where a clock ticks: a tick that is a rounding error early would read the sample before.
        held = self._holds(experiment) and self._clock(experiment) == 0
        return replace(experiment, data=data.assign(**added), holds={**experiment.holds, FEEDFORWARD: held})

    def driven(
        self, system: System, run: Experiment, tolerance: float, noise: Mapping[str, np.ndarray | float]
    ) -> tuple[pd.DataFrame, np.ndarray | None]:
        """The outputs of `system` in `run`, and the command that moved it, shape (n,); None where there is no loop.
        `noise`: of the sensor of each output. A stated controller whose clock the log has hears that of its own sensor.

        What a tracking loop commands between samples is not logged. So the rig moves as the logged command alone moves
        it: only then can a diagnosis explain the logs by the rig. A rig that would fall or drift away keeps the motion
        in the loop."""
        if self.controller is None or self.command is None or (self.tracks and REFERENCE not in run.data):
            system = replace(system, controller=None if self.tracks else system.controller)
            return system.simulate(run, tolerance=tolerance).outputs, None
        loop = self.controller if not self.tracks else replace(self.controller, sample_time=self._clock(run))
        looped = replace(system, controller=loop).simulate(run, tolerance=tolerance).outputs
        command = command_of(loop, run, looped[loop.measured].to_numpy(dtype=float))
        if not self.tracks:
            heard = noise[loop.measured]
            return self._shaken(system, run, looped, heard, tolerance) if np.any(heard) else (looped, command)
        alone = _played(system, replace(run, data=run.data.assign(**{self.command: command})), tolerance)
        return (looped if alone is None or _drifts(alone, looped, loop.measured) else alone), command

    def _shaken(
        self, system: System, run: Experiment, looped: pd.DataFrame, noise: np.ndarray | float, tolerance: float
    ) -> tuple[pd.DataFrame, np.ndarray]:
        """Outputs and command where the stated controller hears `noise`, from the outputs `looped` where it does not.
        What it hears between the samples of a log that is slower, or in continuous time, is not known."""
        loop = self.controller
        assert loop is not None
        read = looped[loop.measured].to_numpy(dtype=float)
        command = command_of(loop, run, read)
        if not _is_clocked(run, loop.sample_time):
            return looped, command
        fed = command_of(loop, run, read + noise) - command + disturbance_of(loop, run, run.time)
        heard = replace(run, data=run.data.assign(**{FED: fed}), holds={**run.holds, FED: True})
        moved = replace(system, controller=replace(loop, disturbance=FED)).simulate(heard, tolerance=tolerance).outputs
        return moved, command_of(loop, run, moved[loop.measured].to_numpy(dtype=float) + noise)

    def _clock(self, run: Experiment) -> float:
        """The sampling interval of a tracking loop, s: that of the samples. 0, a loop in continuous time, where the
        command was not held or the samples are uneven."""
        ticks = np.linspace(run.time[0], run.time[-1], len(run.time))
        step = float(ticks[1] - ticks[0])
        even = float(np.max(np.abs(run.time - ticks))) <= JITTER * step
        return step if even and self._holds(run) else 0.0

    def _holds(self, run: Experiment) -> bool:
        return run.holds.get(str(self.command), True)


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
    loop = Controller(
        kind="pd",
        kp=replay.kp or 0.0,
        kd=replay.kd or 0.0,
        measured=str(replay.output),
        reference=REFERENCE,
        disturbance=FEEDFORWARD,
    )
    return Drive(loop, command, tracks=True)


def _is_clocked(run: Experiment, period: float) -> bool:
    """Whether each sample of a log is a tick of a controller's clock."""
    ticks = run.time[0] + period * np.arange(len(run.time))
    return period > 0.0 and bool(np.max(np.abs(run.time - ticks)) <= OFF_CLOCK * period)


def _smooth_path(time: np.ndarray, logged: np.ndarray) -> np.ndarray:
    """A logged motion without its noise, at every sample."""
    kept = np.isfinite(logged)
    return np.asarray(spline_near(time[kept], logged[kept])(time))


def _played(system: System, run: Experiment, tolerance: float) -> pd.DataFrame | None:
    """The outputs where the inputs alone drive the rig; None where it runs away."""
    try:
        return replace(system, controller=None).simulate(run, tolerance=tolerance).outputs
    except NumericalError:
        return None


def _drifts(alone: pd.DataFrame, looped: pd.DataFrame, measured: str) -> bool:
    """Whether the rig leaves the tracked motion where no loop holds it there."""
    off = (alone[measured] - looped[measured]).to_numpy()
    return not float(np.sqrt(np.mean(off**2))) <= NEAR * float(looped[measured].std())

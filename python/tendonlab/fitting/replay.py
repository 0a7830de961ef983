"""Which loop the simulator is replayed in: the same for every model that is compared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tendonlab import _core
from tendonlab.data import Dataset
from tendonlab.fitting.noise import noise_of
from tendonlab.simulation.command import command_of, fed_noise, mean_command_of
from tendonlab.simulation.prepare import Replay
from tendonlab.simulation.records import Controller, Experiment
from tendonlab.simulation.signals import spline_near
from tendonlab.simulation.system import System

UNEXPLAINED, SHOWN = 0.1, 10.0  # share of the effort that no model explains, and by how many times the noise it shows
SAME_CLOCK = 0.05  # of the controller's period, by which the logs' may differ for the two to be compared
DAMPING = 1.0  # ratio of the loop: critical
CONTRADICTED = 0.1  # of the rms command, by which a stated controller may miss what was logged; right ones miss 0.014
MEANS = 0.05  # of the rms command, by which a log may miss the means of a faster controller; means miss 0.001 to 0.04
AT_LIMIT, MOSTLY = 0.99, 0.5  # of the limit, and share of samples there, from which on a loop is driven by its limits
RESOLVED = 0.25  # of the sampling rate, rad/s per Hz: the largest bandwidth of an injection; at most twice that,
NEEDED = 25.0  # rad/s: where logs are so slow that this is not reached, what no model explains would add up


def choose_replay(dataset: Dataset, system: System) -> Replay:
    """Free run with the known controller, and the noise that the sensor fed back into its command, unless the logged
    command contradicts the controller; else injection, the same for every model; else, without a measured motor, the
    logged command alone.

    The injection is so stiff that an effort of 10 % of the command's, which no model explains, moves the simulated
    sensor by ten times its noise: stiffer, and the effects drown in that noise; softer, and what no model explains
    adds up. At least half of the bandwidth that holds 95 % of the motion's power, at most what the samples resolve. The
    damper must outweigh friction that falls with speed: else the simulator sticks and slips where the rig slides."""
    controller = dataset.controller
    if controller is not None and missed_command(dataset, system) <= CONTRADICTED:
        driven = system.info.inputs[0].name
        feeds = any(fed_noise(controller, e, driven) is not None for e in dataset.train)
        return Replay("controller", controller.kp, controller.kd, controller.measured, feeds_noise=feeds)
    first = next((s.name for s in system.info.outputs if s.axis == 0), None)
    command = system.info.inputs[0].name if system.info.commanded else None  # another input may stand in for it
    if first is None or first not in dataset.outputs or command not in dataset.inputs:
        return Replay("free")
    _, inertia, _ = _core.rigid_motion(system.kind, system.values(), system.active())
    moved = [(e.time, e.data[first].to_numpy(dtype=float)) for e in dataset.train if first in e.data.columns]
    moved = [(time, values) for time, values in moved if np.isfinite(values).any()]
    if not moved:
        return Replay("free")
    slowest = 0.5 * float(np.median([2 * np.pi * _frequency_below(time, values) for time, values in moved]))
    resolved = RESOLVED * float(np.median([(len(time) - 1) / (time[-1] - time[0]) for time, _ in moved]))
    fastest = max(resolved, min(2.0 * resolved, NEEDED))
    commanded = np.concatenate(
        [e.data[command].to_numpy(dtype=float) for e in dataset.train if command in e.data.columns]
    )
    command_rms = float(np.sqrt(np.nanmean(np.square(commanded))))
    noise = noise_of(dataset.signals[first], [values for _, values in moved])
    omega = max(slowest, min(fastest, float(np.sqrt(UNEXPLAINED / SHOWN * command_rms / (inertia * noise)))))
    return Replay("injection", float(inertia * omega**2), float(2.0 * DAMPING * inertia * omega), first)


def opened(dataset: Dataset, system: System) -> Dataset:
    """The dataset without its controller, where every log holds what the controller commanded, at each tick or as means
    between its samples: the logged command then tells the same, and a simulation of it needs no step for each tick.
    Else the dataset itself."""
    controller, motor = dataset.controller, next((s.name for s in system.info.outputs if s.axis == 0), None)
    if controller is None or motor is None or not system.info.commanded:
        return dataset
    command = system.info.inputs[0].name
    lost = {e.name: _lost(controller, e, command) if _holds(e, motor) else np.inf for e in dataset}
    if not np.isfinite(list(lost.values())).all() or np.median([lost[e.name] for e in dataset.train]) > 1.0:
        return dataset
    runs = (replace(e, holds=e.holds | {command: True}) if is_slower(e, controller) else e for e in dataset)
    return replace(dataset, controller=None, experiments=tuple(runs))  # means hold from sample to sample


def is_mostly_at_its_limit(dataset: Dataset, system: System) -> bool:
    """Whether the controller commanded its limit, one way or the other, in most samples of the training experiments:
    there it does not react to the sensor, and a free run of its loop soon loses the phase of the logs."""
    controller = dataset.controller
    if controller is None or not system.info.commanded or not np.isfinite(controller.limit):
        return False
    command = system.info.inputs[0].name
    logged = [np.abs(e.data[command].to_numpy(dtype=float)) for e in dataset.train if command in e.data.columns]
    shares = [float(np.mean(values >= AT_LIMIT * controller.limit)) for values in logged]
    return bool(shares) and float(np.median(shares)) > MOSTLY


def _lost(controller: Controller, experiment: Experiment, command: str) -> float:
    """How much of what the controller commanded a log does not hold, over the most that is allowed."""
    missed = _missed(controller, experiment, command)
    return _misses_means(controller, experiment, command) / MEANS if missed is None else missed / CONTRADICTED


def _holds(experiment: Experiment, name: str) -> bool:
    return name in experiment.data.columns and int(experiment.data[name].count()) > 1


def missed_command(dataset: Dataset, system: System) -> float:
    """How far the stated controller's command is from the logged one: the rms of the difference over that of the
    command, the median over the training experiments. In continuous time of what is smooth in both: the noise that the
    controller hears between two samples was not logged. 0 where nothing can be compared: without controller or logs, or
    where the logs are not sampled at the clock of the controller."""
    controller = dataset.controller
    if controller is None or not system.info.commanded:
        return 0.0
    command = system.info.inputs[0].name
    shares = [share for e in dataset.train if (share := _missed(controller, e, command)) is not None]
    return float(np.median(shares)) if shares else 0.0


def _missed(controller: Controller, experiment: Experiment, command: str) -> float | None:
    """The same in one experiment; None where nothing can be compared."""
    filled = _compared(controller, experiment, command)
    steps = np.abs(np.diff(experiment.time) / controller.sample_time - 1.0) if controller.sample_time > 0 else 0.0
    if filled is None or np.median(steps) > SAME_CLOCK:
        return None
    reading = filled.data[controller.measured].to_numpy(dtype=float)
    logged = filled.data[command].to_numpy(dtype=float)
    is_continuous = controller.sample_time <= 0
    read = _smooth(experiment.time, reading) if is_continuous else reading
    missed = logged - command_of(controller, filled, read)
    if is_continuous:
        missed = _smooth(experiment.time, missed)
    return _share(missed, logged)


def _misses_means(controller: Controller, experiment: Experiment, command: str) -> float:
    """The same against means from sample to sample; inf of a log that is no slower than the controller's clock."""
    filled = _compared(controller, experiment, command)
    if filled is None or not is_slower(experiment, controller):
        return np.inf
    reading, logged = (filled.data[name].to_numpy(dtype=float) for name in (controller.measured, command))
    return _share(logged[:-1] - mean_command_of(controller, filled, reading), logged)


def is_slower(experiment: Experiment, controller: Controller) -> bool:
    """Whether a log has fewer samples than the clock of its controller has ticks."""
    return bool(0.0 < (1.0 + SAME_CLOCK) * controller.sample_time < np.median(np.diff(experiment.time)))


def _compared(controller: Controller, experiment: Experiment, command: str) -> Experiment | None:
    """The experiment without gaps, where it holds all that the controller reads and commands."""
    wanted = [command, controller.measured, controller.reference, *({controller.disturbance} - {None})]
    data = experiment.data
    if not set(wanted) <= set(data.columns) or not np.isfinite(data[wanted].to_numpy(dtype=float)).all(axis=1).any():
        return None
    return replace(experiment, data=data.interpolate(method="index", limit_direction="both"))


def _share(missed: np.ndarray, logged: np.ndarray) -> float:
    return float(np.sqrt(np.mean(missed**2) / max(np.mean(logged**2), 1e-300)))


def _smooth(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.asarray(spline_near(time, values)(time))


def _frequency_below(time: np.ndarray, values: np.ndarray, share: float = 0.95) -> float:
    """Frequency, Hz, below which `share` of the power of the moving part of a signal lies."""
    kept = np.isfinite(values)
    steady = np.linspace(time[0], time[-1], len(time))
    centred = np.interp(steady, time[kept], values[kept])
    centred = (centred - centred.mean()) * np.hanning(len(centred))
    power = np.abs(np.fft.rfft(centred)) ** 2
    total = np.cumsum(power[1:])
    k = int(np.searchsorted(total, share * total[-1])) + 1
    return float(k / (time[-1] - time[0]))

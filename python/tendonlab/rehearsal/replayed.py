"""Noise of the sensors that leaves, once replayed, what the logs of the rig leave.

A replay follows slow noise of the motion that it is told, so the floor holds less of that noise than the readings.
Readings with the noise of the floor would lose the slow part twice, and every effect would show too early."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tendonlab import _core
from tendonlab.fitting.case import make_case
from tendonlab.fitting.floor import estimate, remaining, sensitivities
from tendonlab.fitting.noise import Floor
from tendonlab.fitting.rough import rough_fit
from tendonlab.rehearsal.rig import SimulatedRig
from tendonlab.rehearsal.sensors import Noise, Sensor, at_the_fit

ROUNDS, DRAWS = 4, 3  # corrections, and sets of logs that are simulated for each
MOST_RUNS = 4  # simulated where nothing repeats
GRID = 4096  # frequencies, from 0 to the rate of the logs
MOST = 16.0  # times the power by which a correction changes a frequency
MEMORY = 12  # samples


def as_replayed(rigs: SimulatedRig, floor: Floor, random: np.random.Generator) -> Noise:
    """The noise of `rigs`, corrected until they leave the `floor` of the logs."""
    rigs = _telling(rigs)
    outputs = {signal.name: c for c, signal in enumerate(rigs.system.info.outputs)}
    for _ in range(ROUNDS):
        left = [_left(rigs, random) for _ in range(DRAWS)]
        sensors = []
        for sensor in rigs.noise.sensors:
            c = outputs[sensor.name]
            wanted = spectrum(floor.sd[c], floor.ar[c])
            found = np.mean([spectrum(one.sd[c], one.ar[c]) for one in left], axis=0)
            factor = np.divide(wanted, found, out=np.ones(GRID), where=found > 0.0)
            sensors.append(_with_power(sensor, np.clip(factor, 1.0 / MOST, MOST)))
        rigs = replace(rigs, noise=replace(rigs.noise, sensors=tuple(sensors)))
    return rigs.noise


def leaves(rigs: SimulatedRig, floor: Floor, random: np.random.Generator) -> float:
    """The power that these `rigs` leave, over that of the `floor`; of the output that leaves most."""
    left = [_left(_telling(rigs), random) for _ in range(DRAWS)]
    power = np.mean([np.square(one.rms) for one in left], axis=0)
    return float(np.nanmax(power / np.square(floor.rms)))


def _telling(rigs: SimulatedRig) -> SimulatedRig:
    """The rigs in the experiments that tell the floor: those that repeat, else some that a model is fitted to."""
    if rigs.noise.repeated:
        told = tuple(replace(e, split="train") for e in rigs.runs if e.repeat is not None)
    else:
        told = tuple(e for e in rigs.runs if e.split == "train")[:MOST_RUNS]
    return replace(rigs, rig=replace(rigs.rig, experiments=told), runs=told)


def spectrum(sd: float, memory: Sequence[float]) -> np.ndarray:
    """Power at each frequency of noise that `sd` drives through an autoregression."""
    response = np.fft.fft(np.concatenate([[1.0], -np.asarray(memory, dtype=float)]), GRID)
    return np.asarray(sd**2 / np.abs(response) ** 2)


def _left(rigs: SimulatedRig, random: np.random.Generator) -> Floor:
    """What the logs of one simulated rig leave, replayed by the simulator that made them; where nothing repeats, once
    tuned to them, as the model of the real logs was."""
    case = make_case(rigs.noisy(random, rigs.system))
    if not rigs.noise.repeated:
        return remaining(case, at_the_fit(case, rough_fit(case, _core.Cancel())))
    runs = range(len(case.experiments))
    return estimate(case, [sensitivities(case, case.system, i, case.own_mean(i).tolist()) for i in runs], list(runs))


def _with_power(sensor: Sensor, factor: np.ndarray) -> Sensor:
    """The sensor with `factor` times the power at each frequency, by Yule and Walker."""
    from scipy.linalg import solve_toeplitz

    lags = np.fft.ifft(spectrum(sensor.noise, sensor.memory) * factor).real[: MEMORY + 1]
    if not lags[0] > 0.0:
        return sensor
    memory = np.asarray(solve_toeplitz(lags[:-1] * (1.0 + 1e-9 * (np.arange(MEMORY) == 0)), lags[1:]))
    return replace(sensor, noise=float(np.sqrt(max(lags[0] - memory @ lags[1:], 0.0))), memory=tuple(memory.tolist()))

"""Simulated rigs like the user's, from its logs or for experiments that are planned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tendonlab.data import Dataset, Experiment
from tendonlab.fitting.case import make_case
from tendonlab.rehearsal.drive import drive_of
from tendonlab.rehearsal.replayed import as_replayed, leaves
from tendonlab.rehearsal.rig import SimulatedRig
from tendonlab.rehearsal.sensors import Noise, floor_of_repeats, noise_of_command, noise_of_rig, stated_noise

LESS = 0.7  # of the noise of a sensor that must be enough beside noise of the command
TOO_MUCH = 1.3  # times the power of the floor that repeats may leave with noise of the command


def simulated_rig(rig: Dataset, planned: tuple[Experiment, ...] | None = None) -> SimulatedRig:
    """Rigs like the user's, in the experiments of its logs or in `planned` ones. The noise is that of the logs where
    there are any."""
    noise = _noise_of_logs(rig) if rig.experiments else stated_noise(rig)
    if planned is not None:
        rig = replace(rig, experiments=planned)
    return replace(_driven(rig, noise), planned=planned is not None)


def _noise_of_logs(rig: Dataset) -> Noise:
    """Where runs repeat, the noise with which simulated ones differ as much, once replayed. Noise of a logged command
    that did not move the rig moves a replay: without it the sensors would seem to drift."""
    case = make_case(rig)
    floor = floor_of_repeats(rig, case)
    noise = noise_of_rig(rig, case, floor)
    if floor is None:
        return noise
    rigs = _driven(rig, noise)
    found = as_replayed(rigs, floor, np.random.default_rng(0))
    if not rigs.drive.tracks:
        return found
    white = noise_of_rig(rig, case, None).sensors
    read = replace(noise, sensors=white, command=noise_of_command(rig, str(rigs.drive.command)))
    other = as_replayed(replace(rigs, noise=read), floor, np.random.default_rng(0))
    less = [a.total / b.total for a, b in zip(other.sensors, found.sensors, strict=True)]
    suits = leaves(replace(rigs, noise=other), floor, np.random.default_rng(1)) < TOO_MUCH
    return other if suits and min(less) < LESS and max(less) <= 1.0 / LESS else found


def _driven(rig: Dataset, noise: Noise) -> SimulatedRig:
    drive = drive_of(rig)
    return SimulatedRig(rig, drive, tuple(drive.prepared(e) for e in rig), noise)

"""Simulated rigs like the user's, from its logs or for experiments that are planned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tendonlab.data import Dataset, Experiment
from tendonlab.fitting.case import make_case
from tendonlab.rehearsal.drive import drive_of
from tendonlab.rehearsal.replayed import as_replayed
from tendonlab.rehearsal.rig import SimulatedRig
from tendonlab.rehearsal.sensors import Noise, floor_of_repeats, noise_of_rig, stated_noise


def simulated_rig(rig: Dataset, planned: tuple[Experiment, ...] | None = None) -> SimulatedRig:
    """Rigs like the user's, in the experiments of its logs or in `planned` ones. The noise is that of the logs where
    there are any."""
    noise = _noise_of_logs(rig) if rig.experiments else stated_noise(rig)
    if planned is not None:
        rig = replace(rig, experiments=planned)
    return replace(_driven(rig, noise), planned=planned is not None)


def _noise_of_logs(rig: Dataset) -> Noise:
    """Where runs repeat, the noise with which simulated ones differ as much, once replayed."""
    case = make_case(rig)
    floor = floor_of_repeats(rig, case)
    noise = noise_of_rig(rig, case, floor)
    return noise if floor is None else as_replayed(_driven(rig, noise), floor, np.random.default_rng(0))


def _driven(rig: Dataset, noise: Noise) -> SimulatedRig:
    drive = drive_of(rig)
    return SimulatedRig(rig, drive, tuple(drive.prepared(e) for e in rig), noise)

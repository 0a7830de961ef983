"""Simulated rigs like the user's, from its logs or for experiments that are planned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tendonlab.checking.spikes import without_outliers
from tendonlab.data import Dataset, Experiment
from tendonlab.errors import DatasetError
from tendonlab.fitting.case import make_case
from tendonlab.rehearsal.drive import Drive, drive_of
from tendonlab.rehearsal.plan import followed
from tendonlab.rehearsal.replayed import as_replayed, leaves
from tendonlab.rehearsal.rig import SimulatedRig
from tendonlab.rehearsal.sensors import Noise, floor_of_logs, noise_of_command, noise_of_rig, stated_noise
from tendonlab.report.words import listing

LESS = 0.7  # of the noise of a sensor that must be enough beside noise of the command
TOO_MUCH = 1.3  # times the power of the floor that repeats may leave with noise of the command


def simulated_rig(
    rig: Dataset, planned: tuple[Experiment, ...] | None = None, *, progress: bool = False
) -> SimulatedRig:
    """Rigs like the user's, in the experiments of its logs or in `planned` ones. The noise is that of the logs where
    there are any."""
    noise = _noise_of_logs(rig, progress=progress) if rig.experiments else stated_noise(rig)
    if planned is None:
        return _driven(rig, noise)
    drive = _following(rig, asked) if (asked := followed(planned, rig)) else None
    return replace(_driven(replace(rig, experiments=planned), noise, drive), planned=True)


def _following(rig: Dataset, asked: Sequence[str]) -> Drive:
    """The loop of the logs, in which the rig follows the outputs `asked`. Raises DatasetError where there is none."""
    drive = drive_of(rig) if rig.experiments else Drive(None, None)
    measured = None if drive.controller is None else drive.controller.measured
    if set(asked) != {measured}:
        command = rig.system().info.command
        raise DatasetError(
            f"the plan asks the rig to follow {listing(asked)}; expected "
            + (f"{measured}, as the logs have it, or " if measured else "logs whose loop is known, or ")
            + f"a column of {command.name if command else 'the inputs'}"
        )
    return drive


def _noise_of_logs(rig: Dataset, *, progress: bool) -> Noise:
    """The noise with which simulated logs leave as much as those of the rig, once replayed. Outliers are no noise: a
    diagnosis leaves them out. Noise of a logged command that did not move the rig moves a replay: without it the
    sensors would seem to drift."""
    rig = without_outliers(rig)
    case = make_case(rig)
    floor = floor_of_logs(rig, case, progress=progress)
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
    pairs = [(a.total, b.total) for a, b in zip(other.sensors, found.sensors, strict=True)]
    less, more = any(a < LESS * b for a, b in pairs), any(LESS * a > b for a, b in pairs)
    suits = less and not more and leaves(replace(rigs, noise=other), floor, np.random.default_rng(1)) < TOO_MUCH
    return other if suits else found


def _driven(rig: Dataset, noise: Noise, drive: Drive | None = None) -> SimulatedRig:
    drive = drive_of(rig) if drive is None else drive
    return SimulatedRig(rig, drive, tuple(drive.prepared(e) for e in rig), noise)

"""The step of readings, found where nobody states it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.cli.demo import bundled
from tendonlab.fitting.noise import with_found_resolutions
from tendonlab.simulation.reading import common_step


@pytest.fixture(scope="module")
def rig() -> tl.Dataset:
    return tl.load(bundled())


def rounded(rig: tl.Dataset, step: float, share: float = 1.0) -> tl.Dataset:
    """The rig with the joint angle of this share of its runs rounded, and nothing stated of that sensor."""
    spec = replace(rig.signals["joint_angle"], resolution=None, noise_sd=None)
    num = round(share * len(rig.experiments))
    runs = [
        replace(e, data=e.data.assign(joint_angle=np.round(e.data.joint_angle / step) * step)) if k < num else e
        for k, e in enumerate(rig.experiments)
    ]
    return replace(rig, signals=rig.signals | {"joint_angle": spec}, experiments=tuple(runs))


def test_the_step_that_most_runs_show_counts(rig: tl.Dataset) -> None:
    found = with_found_resolutions(rounded(rig, 5e-3, share=0.8))
    assert found.signals["joint_angle"].resolution == pytest.approx(5e-3, rel=1e-6)
    assert found.signals["motor_angle"] == rig.signals["motor_angle"]


def test_the_step_of_few_runs_does_not(rig: tl.Dataset) -> None:
    assert with_found_resolutions(rounded(rig, 5e-3, share=0.3)).signals["joint_angle"].resolution is None


def test_what_is_stated_stays(rig: tl.Dataset) -> None:
    stated = replace(rig, signals={**rig.signals, "joint_angle": replace(rig.signals["joint_angle"], resolution=1e-3)})
    assert with_found_resolutions(stated).signals["joint_angle"].resolution == 1e-3


def test_the_step_of_a_coarse_sensor_in_fast_motion_is_found(rig: tl.Dataset) -> None:
    """Hardly a reading equals the one before, and the file has few digits: all changes are multiples all the same."""
    step = 2.0 * np.pi / 2048
    time = np.arange(0.0, 4.0, 0.004)
    records = [np.round(np.sin(w * time) / step) * step for w in (2.0, 5.0, 9.0)]
    printed = [np.round(np.rad2deg(record), 4) for record in records]
    assert common_step(printed) == pytest.approx(np.rad2deg(step), rel=1e-3)
    noisy = [record + step * np.random.default_rng(0).standard_normal(len(time)) for record in records]
    assert common_step(noisy) == 0.0
    assert common_step([*printed, np.rad2deg(noisy[0])]) == 0.0
    assert common_step([np.round(record, 5) for record in noisy]) == 0.0  # the digits of the file, far below the noise
    triangle = np.abs((0.3 * time) % 2.0 - 1.0)
    assert common_step([triangle, 2.0 * triangle]) == 0.0  # steady motions that nobody rounded
    assert common_step([]) == 0.0

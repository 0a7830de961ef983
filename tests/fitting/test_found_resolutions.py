"""The step of readings, found where nobody states it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.cli.demo import bundled
from tendonlab.fitting.noise import with_found_resolutions


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

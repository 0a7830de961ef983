"""The noise floor's parts on signals whose answers are known."""

from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter

from tendonlab import _core
from tendonlab.fitting import noise
from tendonlab.fitting.noise import integrated_time


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.9])
def test_integrated_time_of_an_autoregression(memory: float) -> None:
    """1 + 2 sum of a^k = (1 + a)/(1 - a)."""
    rng = np.random.default_rng(3)
    times = [integrated_time(lfilter([1.0], [1.0, -memory], rng.normal(size=20_000))) for _ in range(8)]
    assert np.mean(times) == pytest.approx((1 + memory) / (1 - memory), rel=0.12)


def test_integrated_time_of_nothing() -> None:
    assert integrated_time(np.zeros(50)) == 1.0


def test_rows_of_a_whitening_are_the_samples_that_are_kept(twin_case: Any) -> None:
    """An autoregression of order two needs two samples before each one that counts, also after a gap."""
    measured = np.ones((3, 20))
    measured[0, 8] = np.nan
    measured[2] = np.nan
    floor = noise.Floor(np.ones(3), [[0.5, 0.1], [], []], [1.0, 2.0, 0.0], 0.0, repeated=True)
    kept = noise.kept_samples(floor, measured)
    assert kept[0].tolist() == [*range(2, 8), *range(11, 20)]
    assert [len(k) for k in kept] == [15, 20, 0]
    assert _core.Whitening(floor.ar, floor.sd, measured).rows() == 35


def test_friction_of_an_element_scales_together(twin_case: Any) -> None:
    names = [p.name for p in twin_case.system.info.parameters]
    groups = [{names[k] for k in group} for group in noise.friction_groups(twin_case.system)]
    assert groups == [{"motor_coulomb", "motor_viscous"}, {"joint_coulomb", "joint_viscous"}]

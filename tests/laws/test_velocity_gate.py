"""A dead zone in velocity: the output is held below the threshold and follows above it."""

from __future__ import annotations

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.errors import ParameterError

PERIOD = 1e-3  # s, of the control loop whose steps the gate speaks of


def law(share: float = 1.0) -> _core.Law:
    return _core.sheath.VelocityGate(threshold_velocity=0.1, threshold_slope=500.0, gate_share=share)


def output(one: _core.Law, signal: np.ndarray, velocity: float, step: float = PERIOD, **more: float) -> np.ndarray:
    return np.asarray(one.apply(signal, time=np.arange(signal.size) * step, velocity=velocity, **more))


def test_at_the_threshold_half_of_each_step_passes() -> None:
    np.testing.assert_allclose(output(law(), np.ones(3), 0.1), [0.5, 0.75, 0.875], rtol=1e-14)


def test_it_holds_well_below_the_threshold_and_follows_well_above_it() -> None:
    signal = np.array([2.0, 5.0, -3.0])
    np.testing.assert_allclose(output(law(), signal, 0.5), signal, rtol=1e-14)
    np.testing.assert_allclose(output(law(), signal, 0.0, start=1.0), 1.0, atol=1e-3)


def test_a_log_at_another_rate_means_the_same() -> None:
    """A constant effort leaves (1 - h)^n of the distance after n periods, in however many samples."""
    slow, fast = output(law(), np.ones(5), 0.08, 4 * PERIOD), output(law(), np.ones(17), 0.08)
    np.testing.assert_allclose(slow[1:] - slow[0], fast[4::4] - fast[0], rtol=1e-12)


def test_a_bristle_takes_its_place() -> None:
    np.testing.assert_array_equal(output(law(), np.ones(3), 0.0, bristle_share=1.0), 1.0)
    half, gate = output(law(), np.ones(2), 0.0, bristle_share=0.5), output(law(0.5), np.ones(2), 0.0)
    np.testing.assert_array_equal(half, gate)


@pytest.mark.parametrize("time", [None, [0.0, 1.0], [0.0, 2.0, 1.0]])
def test_without_instants_that_increase_it_refuses(time: object) -> None:
    with pytest.raises(ParameterError, match="time"):
        law().apply([1.0, 1.0, 1.0], time=time, velocity=0.0)

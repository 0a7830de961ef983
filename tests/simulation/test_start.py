"""Where an experiment begins: what was measured, what is stated, and what follows a measured axis as if nothing
stretched."""

import numpy as np
import pandas as pd
import pytest

from tendonlab.data import Experiment
from tendonlab.simulation.catalog import system_info
from tendonlab.simulation.start import Start, start_of

INFO = system_info("two_inertia")
TIME = np.arange(0.0, 2.0, 0.01)
ALONE = np.array([1.0, 0.1])  # the joint moves a tenth as far as the motor


def begun(initial: dict[str, float] | None = None, **signals: np.ndarray) -> Start:
    frame = pd.DataFrame({"motor_torque": 0.0 * TIME, **signals}, index=pd.Index(TIME, name="t"))
    measured = np.array([signals.get(s.name, np.full(len(TIME), np.nan)) for s in INFO.outputs])
    return start_of(Experiment(name="run", data=frame, initial=initial or {}), INFO, measured)


def test_a_measured_axis_begins_where_it_is_and_the_other_one_follows_it() -> None:
    """Its travel is from the least to the largest angle, wherever zero is."""
    found = begun(motor_angle=3.0 + 0.5 * TIME)
    assert (found.follows, found.is_rigid) == ((0, 0), True)
    assert found.motion[0] == pytest.approx((3.0, 0.5, 0.05 * TIME[-1], 0.5))
    position, velocity = found.state(ALONE)
    assert position == pytest.approx([3.0, 0.3])
    assert velocity == pytest.approx([0.5, 0.05])
    names, sd = found.nuisances(ALONE)
    assert names == (("position", 0), ("velocity", 0), ("position", 1), ("velocity", 1))
    assert sd == pytest.approx((0.0995, 0.5, 0.00995, 0.05))  # a tenth of the travel; the speed itself


def test_the_only_measured_axis_may_be_the_second_one() -> None:
    found = begun(joint_angle=0.2 + 0.0 * TIME)
    assert found.follows == (1, 1)
    assert found.state(ALONE)[0] == pytest.approx([2.0, 0.2])
    assert found.nuisances(ALONE) == ((), ())  # at rest


def test_an_axis_that_is_measured_late_may_have_come_from_anywhere() -> None:
    """A parabola through noisy samples, carried on over a second, would lead far from every place that was seen."""
    noisy = 0.3 * np.sin(2.0 * TIME) + 1e-3 * np.random.default_rng(4).normal(size=len(TIME))
    noisy[TIME < 1.0] = np.nan
    found = begun(motor_angle=noisy)
    position, velocity, position_sd, velocity_sd = found.motion[0]
    assert position == pytest.approx(0.3 * np.sin(2.0), abs=5e-3)
    assert position_sd == pytest.approx(np.nanmax(noisy) - np.nanmin(noisy))
    assert velocity_sd >= abs(velocity)
    assert velocity_sd >= position_sd / 1.0


def test_where_both_were_measured_no_shape_is_needed() -> None:
    found = begun(motor_angle=1.0 + TIME, joint_angle=0.3 + 0.2 * TIME)
    assert (found.follows, found.is_rigid) == ((0, 1), False)
    position, velocity = found.state(np.array([[1.0, 0.1], [1.0, 7.0]]))
    assert position == pytest.approx(np.array([[1.0, 0.3], [1.0, 0.3]]))
    assert velocity == pytest.approx(np.array([[1.0, 0.2], [1.0, 0.2]]))


def test_what_is_stated_counts_and_is_no_nuisance() -> None:
    found = begun({"joint_angle": 0.7, "motor_velocity": 0.0}, motor_angle=3.0 + 0.5 * TIME)
    position, velocity = found.state(ALONE)
    assert position == pytest.approx([3.0, 0.7])
    assert velocity == pytest.approx([0.0, 0.05])
    assert found.nuisances(ALONE)[0] == (("position", 0), ("velocity", 1))


def test_where_nothing_was_measured_a_rig_begins_at_rest_or_as_stated() -> None:
    found = begun({"joint_angle": 0.7})
    assert (found.follows, found.is_rigid, found.nuisances(ALONE)) == ((None, None), False, ((), ()))
    assert found.state(ALONE)[0].tolist() == [0.0, 0.7]

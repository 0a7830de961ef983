"""Signals and starts from samples: lines and sines whose position, speed, noise and scales are known."""

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.simulation.signals import motion_at_start, scales_of
from tendonlab.simulation.start import Start

TIME = 3.0 + np.arange(0.0, 4.0, 0.002)


def test_the_motion_at_the_start_of_a_noisy_line() -> None:
    """Ten samples of noise s over 18 ms: the speed is known to s/√Σ(t - mean)², the position to about s/2."""
    noise = 1e-5
    angle = 0.7 + 1.5 * (TIME - 3.0) + noise * np.random.default_rng(0).standard_normal(len(TIME))
    angle[4] = np.nan
    position, velocity = motion_at_start(TIME, angle)
    assert position == pytest.approx(0.7, abs=4 * noise)
    assert velocity == pytest.approx(1.5, abs=4 * noise / 0.018)


@pytest.mark.parametrize("drift", [0.0, 0.005])
def test_what_hardly_moves_at_first_is_at_rest(drift: float) -> None:
    """Below 1 % of the usual speed, which is the travel of 2 rad over 4 s."""
    angle = 0.3 + np.where(TIME > 4.0, 1.0 - np.cos(np.pi * (TIME - 4.0)), 0.0) + 0.8 * drift * (TIME - 3.0)
    position, velocity = motion_at_start(TIME, angle)
    assert (position, velocity) == (pytest.approx(0.3, abs=1e-4), 0.0)
    moving = angle + 0.02 * (TIME - 3.0)
    assert motion_at_start(TIME, moving)[1] == pytest.approx(0.02 + 0.8 * drift, rel=1e-3)


def test_a_motion_that_brakes_or_sets_off_at_once_has_its_first_velocity() -> None:
    """Curved over the first 20 ms: a line would see half of what it loses or gains there."""
    noise = 1e-6 * np.random.default_rng(2).standard_normal(len(TIME))
    t = np.minimum(TIME - 3.0, 0.02)
    position, velocity = motion_at_start(TIME, 0.2 - t + 45.0 * t**2 + noise)
    assert (position, velocity) == (pytest.approx(0.2, abs=5e-6), pytest.approx(-1.0, abs=2e-3))
    position, velocity = motion_at_start(TIME, 0.2 + 45.0 * t**2 + noise)
    assert (position, velocity) == (pytest.approx(0.2, abs=5e-6), 0.0)


def test_few_samples_are_a_start_at_rest() -> None:
    assert motion_at_start(TIME[:6], np.arange(6.0)) == (2.5, 0.0)


def test_a_speed_within_its_uncertainty_is_rest() -> None:
    noise = np.random.default_rng(1).standard_normal(len(TIME))
    assert motion_at_start(TIME, 1.0 + 0.01 * noise)[1] == 0.0


def test_scales_are_a_tenth_of_the_smallest_travel_and_speed() -> None:
    small, large = 0.2 * np.sin(2 * np.pi * TIME), 5.0 * np.sin(np.pi * TIME)
    still, missing = np.full(len(TIME), 0.3), np.full(len(TIME), np.nan)
    position, velocity = scales_of(TIME, np.array([large, small, still, missing]))
    assert position == pytest.approx(0.1 * 0.2 / np.sqrt(2), rel=0.01)
    assert velocity == pytest.approx(0.1 * 0.2 * 2 * np.pi / np.sqrt(2), rel=0.02)
    assert scales_of(TIME, np.array([still, missing])) == (1e-2, 1e-2)


def start(**more: object) -> Start:
    """A measured motor that drives a joint, which was not measured."""
    given = {
        "follows": (0, 0, None),
        "motion": {0: (0.4, 2.0, 0.3, 2.0)},
        "sensor": {0: 1},
        "position": {},
        "velocity": {},
    }
    given |= {"reading": (), "reading_sd": {}}
    return Start(**{**given, **more})  # type: ignore[arg-type]


RIGID = np.array([2.0, 1.0, 5.0])  # the joint moves half as far as the motor


def test_what_was_not_measured_starts_where_a_rigid_transmission_puts_it() -> None:
    position, velocity = start().state(RIGID)
    np.testing.assert_allclose(position, [0.4, 0.2, 0.0])
    np.testing.assert_allclose(velocity, [2.0, 1.0, 0.0])
    many = np.array([RIGID, [4.0, 1.0, 5.0]])
    np.testing.assert_allclose(start().state(many)[0], [[0.4, 0.2, 0.0], [0.4, 0.1, 0.0]])


def test_what_is_stated_counts_and_is_not_unknown() -> None:
    stated = start(position={1: 0.9}, velocity={0: -1.0})
    position, velocity = stated.state(RIGID)
    np.testing.assert_allclose(position, [0.4, 0.9, 0.0])
    np.testing.assert_allclose(velocity, [-1.0, 1.0, 0.0])
    assert dict(zip(*stated.nuisances(RIGID), strict=True)) == pytest.approx(
        {("position", 0): 0.3, ("velocity", 1): 1.0}
    )


def test_a_stated_start_counts_where_nothing_was_measured() -> None:
    position, velocity = start(follows=(None,) * 3, motion={}, position={0: 0.9}, velocity={1: -1.0}).state(RIGID)
    np.testing.assert_allclose(position, [0.9, 0.0, 0.0])
    np.testing.assert_allclose(velocity, [0.0, -1.0, 0.0])


def test_the_start_is_known_as_well_as_the_measured_axis_tells() -> None:
    found = dict(zip(*start().nuisances(RIGID), strict=True))
    assert found == pytest.approx(
        {("position", 0): 0.3, ("velocity", 0): 2.0, ("position", 1): 0.15, ("velocity", 1): 1.0}
    )
    resting = start(motion={0: (0.4, 0.0, 0.3, 0.0)})
    assert [name for name, _ in resting.nuisances(RIGID)[0]] == ["position", "position"]


def test_only_a_start_that_follows_something_else_depends_on_the_shape() -> None:
    assert start().is_rigid
    assert not start(follows=(0, None, None)).is_rigid


@pytest.mark.parametrize("resolution", [0.0, 5e-4])
def test_a_sheath_holds_the_torque_at_which_its_drive_stops_dead(resolution: float) -> None:
    """The gate closes in the sample of the stop, though the velocity is noisy: a curve through the stop would hold it
    open while the torque falls on by 1 N·m a sample. Noise of the velocity alone leaves friction as it is."""
    gate = {"threshold_velocity": 0.01, "threshold_slope": 1e7}
    shape = {"input_radius": 0.05, "output_radius": 0.05, "sheath_length": 1.0, "cable_stiffness": 1e5}
    friction = {"friction_coefficient": 0.055, "static_friction_coefficient": 0.06, "stribeck_velocity": 0.05}
    numbers = {**gate, **shape, **friction, "pretension": 150.0, "wrap_angle": 3.0}
    pair = tl.System("bowden_pair", effects=("sheath:capstan",), parameters=numbers)
    time = 0.002 * np.arange(1000)
    velocity = np.where(time < 1.0, 0.4 * np.cos(time), 0.0)
    torque = 10.0 - 500.0 * np.clip(time - 0.998, 0.0, 0.01)
    noisy = velocity + 2e-3 * np.random.default_rng(1).standard_normal(len(time))
    noisy = np.round(noisy / resolution) * resolution if resolution else noisy
    held = [
        pair.simulate(pd.DataFrame({"input_torque": torque, "input_velocity": v}, index=time))["output_torque"]
        for v in (velocity, noisy)
    ]
    np.testing.assert_allclose(held[1][500:], held[0][500:], atol=0.02)
    np.testing.assert_allclose(held[0][500:], held[0].iloc[500], atol=1e-9)

"""Signals and starts from samples: lines and sines whose position, speed, noise and scales are known."""

import numpy as np
import pytest

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

"""Friction of a cable on a pulley: the capstan relation, its static and its direction-dependent coefficient."""

import numpy as np
import pytest

import tendonlab as tl

WRAP = 1.69


@pytest.mark.parametrize(("velocity", "tension_out"), [(0.1, 38.80398724625684), (-0.1, 64.42636897426458)])
def test_tension_behind_a_pulley(velocity: float, tension_out: float) -> None:
    """T_out = T_in exp(-mu theta_w sgn v) for both directions (S4 eq. 13)."""
    capstan = tl.transmission.Capstan(friction_coefficient=0.15, smallest_level=0.0)
    friction = capstan.force(velocity=velocity, load=50.0, wrap_angle=WRAP)
    assert 50.0 - friction == pytest.approx(tension_out, rel=1e-12)


def test_a_slack_cable_keeps_the_smallest_level() -> None:
    capstan = tl.transmission.Capstan(friction_coefficient=0.15)
    assert capstan.level(velocity=1.0, load=0.0, wrap_angle=WRAP) == 1e-3
    assert capstan.level(velocity=0.0, load=50.0, wrap_angle=WRAP) == 1e-3  # no direction, no capstan


def test_static_friction_at_rest_and_kinetic_at_speed() -> None:
    stribeck = tl.transmission.Stribeck(
        friction_coefficient=0.15, static_friction_coefficient=0.18, stribeck_velocity=5e-5
    )
    assert stribeck.factor(velocity=0.0) == pytest.approx(0.18 / 0.15, rel=1e-15)
    assert stribeck.factor(velocity=5e-5) == pytest.approx(1 + 0.2 / np.e, rel=1e-14)
    assert stribeck.factor(velocity=1e-3) == 1.0


def test_a_coefficient_of_its_own_each_way() -> None:
    """mu (1 + a) forwards and mu (1 - a) backwards: the capstan relation with either."""
    mean = tl.transmission.Capstan(friction_coefficient=0.15, smallest_level=0.0)
    differs = tl.transmission.Asymmetry(friction_coefficient=0.15, coefficient_asymmetry=0.1)
    at = {"velocity": np.array([1.0, -1.0]), "wrap_angle": WRAP}
    answer = mean.level(load=50.0, **at) * differs.factor(**at)
    wanted = 50.0 * np.array([1 - np.exp(-0.165 * WRAP), np.exp(0.135 * WRAP) - 1])
    np.testing.assert_allclose(answer, wanted, rtol=1e-12)

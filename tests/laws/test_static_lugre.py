import numpy as np
import pytest

from tendonlab import _core

falling = _core.friction.StaticLugre(coulomb=0.1, static_friction=0.15, stribeck_velocity=5.0, stribeck_exponent=2.0)
rising = _core.friction.StaticLugre(coulomb=0.107, static_friction=0.0, stribeck_velocity=8.422, stribeck_exponent=2.0)


def test_it_starts_at_the_static_and_ends_at_the_kinetic_level() -> None:
    assert falling.level() == pytest.approx(0.15, rel=1e-15)
    assert falling.level(velocity=[5.0, -5.0]) == pytest.approx([0.1183940] * 2, rel=1e-6)  # 0.1 + 0.05 / e
    assert falling.level(velocity=100.0) == pytest.approx(0.1, rel=1e-12)


def test_static_below_kinetic_friction_is_allowed_and_rises_with_speed() -> None:
    """S0 Tables 6 and 7: shape parameters of an inverted curve."""
    level = rising.level(velocity=np.linspace(0.0, 40.0, 400))
    assert level[0] == 0.0
    assert np.all(np.diff(level[level < 0.107 * (1 - 1e-12)]) > 0)


def test_with_exponent_2_it_is_coulomb_and_stribeck() -> None:
    velocity = np.linspace(-20.0, 20.0, 81)
    terms = _core.friction.Coulomb(coulomb=0.1).force(velocity=velocity)
    terms = terms + _core.friction.Stribeck(static_excess=0.05, stribeck_velocity=5.0).force(velocity=velocity)
    assert falling.force(velocity=velocity) == pytest.approx(terms, rel=1e-13)


def test_near_rest_a_small_exponent_stays_finite() -> None:
    law = _core.friction.StaticLugre(coulomb=0.1, static_friction=0.2, stribeck_velocity=5.0, stribeck_exponent=0.5)
    assert np.all(np.isfinite(law.level(velocity=[0.0, 1e-300, -1e-12])))
    assert law.level() == pytest.approx(0.2, rel=1e-15)

import numpy as np
import pytest

from tendonlab import _core

OFF = {"coulomb": 0.0, "static_friction": 0.0, "viscous": 0.0}
SHAPE = {
    "stribeck_velocity": 20.0,
    "load_exponent": 0.5,
    "peak_exponent": 1.0,
    "stribeck_exponent": 2.0,
    "viscous_exponent": 0.5,
    "transmission_ratio": 2.0,
}


def law(**values: float):
    return _core.friction.LoadAndRatio(**{**OFF, **SHAPE, **values})


def test_only_static_friction_is_left_where_sliding_sets_in() -> None:
    """S0: omega -> 0+ gives F_s, whatever the load, where the exponents are positive."""
    one = law(coulomb=0.01, static_friction=0.04, viscous=1e-3)
    assert one.force(velocity=[1e-12, -1e-12], load=[1.0, 4.0]) == pytest.approx([0.04, -0.04], rel=1e-5)
    assert one.force(velocity=0.0, load=2.0) == 0.0


def test_the_dry_part_grows_as_1_and_relative_load() -> None:
    one = law(coulomb=0.01)
    ratio = one.force(velocity=[3.0, 30.0], load=3.0) / one.force(velocity=[3.0, 30.0], load=1.0)
    assert ratio == pytest.approx([2.0, 2.0], rel=1e-13)


def test_far_beyond_the_peak_the_dry_part_is_a_power_of_speed() -> None:
    assert law(coulomb=0.01).force(velocity=400.0, load=1.0) == pytest.approx(0.02 * 20.0, rel=1e-12)


def test_at_its_velocity_the_peak_has_lost_all_but_1_e() -> None:
    """0.04 / e + (0.01 · 2 · 20) / e + 0.02 sqrt(20), by hand."""
    answer = law(coulomb=0.01, static_friction=0.04).force(velocity=20.0, load=1.0)
    assert answer == pytest.approx(0.0147152 + 0.1471518 + 0.0894427, rel=1e-6)


def test_load_lowers_the_viscous_part_and_the_ratio_weighs_the_second_shaft() -> None:
    """F_v ((N² + 1)/N² w + sqrt(w/L)): 1e-3 (1.25 · 16 + 4) at L = 1, 1e-3 (20 + 2) at L = 4."""
    answer = law(viscous=1e-3).force(velocity=[16.0, 16.0], load=[1.0, 4.0])
    assert answer == pytest.approx([0.024, 0.022], rel=1e-13)


def test_without_a_stated_load_nothing_is_infinite() -> None:
    assert np.all(np.isfinite(law(coulomb=0.01, viscous=1e-3, viscous_exponent=3.0).force(velocity=[0.0, 100.0])))

import numpy as np
import pytest

from tendonlab import _core

law = _core.friction.Stribeck(static_excess=0.4, stribeck_velocity=0.05)


def test_all_of_the_excess_at_rest_a_share_of_1_e_at_its_velocity_none_far_beyond() -> None:
    assert law.level() == 0.4
    assert law.level(velocity=[0.05, -0.05]) == pytest.approx([0.147152, 0.147152], rel=1e-5)  # 0.4 / 2.718282
    assert law.level(velocity=0.5) < 1e-39


def test_the_area_under_it_is_a_gaussian_one() -> None:
    velocity = np.linspace(0.0, 1.0, 100001)
    area = np.trapezoid(law.force(velocity=velocity[1:]), velocity[1:])
    assert area == pytest.approx(0.4 * 0.05 * 0.8862269, rel=1e-3)  # sqrt(pi) / 2; the first interval is left out

import pytest

from tendonlab import _core

law = _core.friction.LoadDependence(load_dependence=0.1)


def test_a_block_on_a_slope_slides_at_the_angle_of_friction() -> None:
    """Normal load W cos a, drive W sin a: they balance at tan a = c, 5.7106 degrees for 0.1."""
    weight, cosine, sine = 50.0, 0.9950372, 0.0995037
    assert law.level(load=weight * cosine) == pytest.approx(weight * sine, rel=1e-6)


def test_pushing_and_pulling_load_it_alike() -> None:
    assert law.force(velocity=[1.0, -1.0], load=[-20.0, 20.0]).tolist() == [2.0, -2.0]

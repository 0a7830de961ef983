import pytest

from tendonlab import _core


def test_a_coasting_mass_stops_after_its_momentum_over_the_coefficient() -> None:
    """m v' = -F_v v stops after m v0 / F_v, whatever the shape of the motion there."""
    law, mass, speed, step, travel = _core.friction.Viscous(viscous=0.5), 2.0, 3.0, 1e-3, 0.0
    while speed > 1e-6:
        middle = speed - 0.5 * step * law.force(velocity=speed) / mass
        speed, travel = speed - step * law.force(velocity=middle) / mass, travel + step * middle
    assert travel == pytest.approx(12.0, rel=1e-6)  # 2 * 3 / 0.5, the rest is below 1e-6 m/s

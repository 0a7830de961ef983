import numpy as np
import pytest

from tendonlab import _core


def test_it_is_viscous_at_rest_and_level_at_speed() -> None:
    """S2 Table II: slope alpha beta = 1.554e-3 N*m*s/rad, limit alpha pi/2 = 0.12205 N*m."""
    law = _core.friction.Arctan(friction=0.0777, friction_slope=0.02)
    assert law.force(velocity=1e-3) == pytest.approx(1.554e-6, rel=1e-9)
    assert law.force(velocity=1e9) == pytest.approx(0.12205, abs=5e-6)
    velocity = np.linspace(-200.0, 200.0, 41)
    assert law.force(velocity=velocity) == pytest.approx(-law.force(velocity=-velocity), rel=1e-15)

import numpy as np
import pytest

from tendonlab import _core

law = _core.friction.Presliding(bristle_stiffness=200.0, bristle_damping=0.5)


def test_steady_sliding_gives_the_dry_level() -> None:
    """The deflection settles at g / sigma_0, and the force at g, with the sign of sliding."""
    for velocity, sign in ((0.3, 1.0), (-0.02, -1.0)):
        z = sign * 0.8 / 200.0
        assert law.rate(velocity=velocity, deflection=z, level=0.8) == pytest.approx(0.0, abs=1e-12)
        assert law.force(velocity=velocity, deflection=z, level=0.8) == pytest.approx(sign * 0.8, rel=1e-12)


def test_small_motion_meets_a_spring() -> None:
    """Far below breakaway, 4 mm, the deflection follows the motion: force = stiffness x displacement."""
    z, step = 0.0, 1e-6
    for _ in range(1000):
        z += step * law.rate(velocity=0.02, deflection=z, level=0.8)
    assert z == pytest.approx(2e-5, rel=3e-3)  # half of displacement over breakaway displacement is lost
    assert law.force(velocity=0.0, deflection=z, level=0.8) == pytest.approx(200.0 * z)


def test_a_share_of_a_half_leaves_half_of_the_jump() -> None:
    half = _core.friction.Presliding(bristle_stiffness=200.0, bristle_damping=0.0, presliding_share=0.5)
    before, after = half.force(velocity=np.array([1e-9, -1e-9]), deflection=0.004, level=0.8)
    assert before - after == pytest.approx(0.8, rel=1e-6)  # of 2 x 0.8

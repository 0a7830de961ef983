"""A sheath that is bent more towards its output, against S3 eqs 8-18 integrated along it on a fine grid."""

import numpy as np
import pytest

from tendonlab import _core

MU, THETA = 0.12, 3.6


def statics(skew: float) -> tuple[float, float]:
    """Gain over the ratio of radii, and friction per torque of the pretension, by the trapezium rule."""
    u = np.linspace(0.0, 1.0, 200_001)
    density = 1.0 + skew * (2.0 * u - 1.0)
    turned = MU * THETA * np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))]) * u[1]
    falling, growing = np.trapezoid(np.exp(-turned), u), np.trapezoid(np.exp(turned), u)
    alpha, beta = np.exp(-MU * THETA), np.exp(MU * THETA)
    gain = (growing * alpha + falling * beta) / (falling + growing)
    return gain, (beta - alpha) * falling / (falling + growing)


@pytest.mark.parametrize("skew", [-1.0, -0.4, 0.3, 1.0])
def test_gain_and_friction_of_the_capstan_behind_it(skew: float) -> None:
    behind = _core.sheath.CurvatureSkew(curvature_skew=skew).motion(velocity=9.0, wrap_angle=THETA, preload=26.0)
    assert behind["curvature_skew"] == skew
    capstan = _core.sheath.Capstan(friction_coefficient=MU, static_friction_coefficient=MU, stribeck_velocity=0.1)
    gain, friction = statics(skew)
    assert capstan.gain(**behind) == pytest.approx(gain, rel=1e-9)
    assert capstan.level(**behind) == pytest.approx(26.0 * friction, rel=1e-9)


def test_it_adds_to_what_the_shape_says_and_moves_the_gain_to_its_side() -> None:
    law = _core.sheath.CurvatureSkew(curvature_skew=0.25)
    assert law.motion(curvature_skew=0.5)["curvature_skew"] == 0.75
    assert statics(0.4)[0] > 1.0 > statics(-0.4)[0]

"""Two pretensioned tendons in sheaths: for an even sheath S3 eq. 18 becomes P (1 - exp(-mu theta))."""

from __future__ import annotations

import numpy as np
import pytest

from tendonlab import _core


def capstan(kinetic: float = 0.1, resting: float = 0.14) -> _core.Law:
    return _core.sheath.Capstan(
        friction_coefficient=kinetic, static_friction_coefficient=resting, stribeck_velocity=0.05
    )


@pytest.mark.parametrize(
    ("velocity", "coefficient"), [(0.0, 0.14), (0.05, 0.1 + 0.04 / np.e), (-0.05, 0.1 + 0.04 / np.e), (9.0, 0.1)]
)
def test_level_of_an_even_sheath(velocity: float, coefficient: float) -> None:
    answer = capstan().level(velocity=velocity, wrap_angle=3.6, preload=26.0)
    assert answer == pytest.approx(26.0 * (1.0 - np.exp(-coefficient * 3.6)), rel=1e-12)


def test_little_friction_is_mu_theta_of_the_pretension() -> None:
    answer = capstan(1e-9, 1e-9).level(velocity=1.0, wrap_angle=2.0, preload=30.0)
    assert answer == pytest.approx(30.0 * 2e-9, rel=1e-8)


def test_an_even_sheath_passes_on_the_ratio_of_radii() -> None:
    assert capstan().gain(velocity=1.0, wrap_angle=3.6, preload=26.0) == 1.0
    assert capstan(0.0, 0.0).gain(velocity=1.0, wrap_angle=3.6, preload=26.0, curvature_skew=0.8) == pytest.approx(1.0)

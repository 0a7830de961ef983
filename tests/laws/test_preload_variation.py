import numpy as np
import pytest

from tendonlab import _core

K, P = 1e5, 80.0
ANGLE = np.linspace(-1.5, 1.5, 31)


def longer(*, stiffness: float = K, variation: float = P) -> np.ndarray:
    """What the law adds to an elongation of 1 mm, m."""
    law = _core.transmission.PreloadVariation(stiffness=stiffness, preload_variation=variation)
    elongation = np.full(len(ANGLE), 1e-3)
    return np.asarray(law.motion(position=elongation, wrap_angle=ANGLE)["position"]) - elongation


def test_it_adds_the_same_tension_at_any_stiffness_and_on_either_side() -> None:
    for stiffness in (K, 3.0 * K):
        added = stiffness * longer(stiffness=stiffness)
        assert added == pytest.approx(added[::-1], abs=1e-9)
        assert added[np.argmin(np.abs(ANGLE))] == pytest.approx(0.0, abs=1e-9)
        assert np.interp(np.pi / 3.0, ANGLE, added) == pytest.approx(0.5 * P, rel=5e-3)  # cos 60° = 1/2


def test_without_stiffness_the_path_is_none() -> None:
    assert longer(stiffness=0.0) == pytest.approx(np.zeros(len(ANGLE)), abs=0.0)

import numpy as np
import pytest

from tendonlab import _core

K = 1e5
ELONGATION = np.linspace(-4e-3, 4e-3, 801)


def tension(elongation: np.ndarray, *, preload: float, toe: float) -> np.ndarray:
    """What a linear cable carries at the elongation that the law hands on."""
    law = _core.transmission.ToeRegion(pretension=preload, stiffness=K, toe_tension=toe)
    return preload + K * np.asarray(law.stretch(position=elongation))


@pytest.mark.parametrize("preload", [0.0, 50.0, 200.0, 300.0])
def test_it_starts_at_the_preload_and_is_linear_above_its_end(preload: float) -> None:
    answer = tension(ELONGATION, preload=preload, toe=200.0)
    assert answer[400] == pytest.approx(preload, abs=1e-6)
    slope = np.gradient(answer, ELONGATION)
    assert slope[answer > 201.0] == pytest.approx(K, rel=1e-9)


def test_below_its_end_stiffness_falls_with_the_root_of_the_tension() -> None:
    """So the force is quadratic, from the natural length on."""
    answer = tension(ELONGATION, preload=50.0, toe=200.0)
    inside = (answer > 2.0) & (answer < 198.0)
    slope = np.gradient(answer, ELONGATION)
    assert slope[inside] == pytest.approx(K * np.sqrt(answer[inside] / 200.0), rel=1e-3)
    natural = ELONGATION[np.flatnonzero(answer >= 0.0)[0]]
    assert natural == pytest.approx(-2.0 * np.sqrt(50.0 * 200.0) / K, abs=2e-5)


def test_without_preload_it_stays_finite() -> None:
    assert np.isfinite(tension(ELONGATION, preload=0.0, toe=200.0)).all()
    assert tension(ELONGATION, preload=0.0, toe=0.0) == pytest.approx(K * ELONGATION, abs=1e-9)

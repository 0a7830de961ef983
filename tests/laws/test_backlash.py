import numpy as np
import pytest

from tendonlab import _core

law = _core.transmission.Backlash(backlash=0.2)


def test_nothing_inside_the_gap_and_unit_slope_beyond() -> None:
    stretch = law.stretch(position=[-0.3, -0.1, -0.05, 0.0, 0.1, 0.4])
    np.testing.assert_allclose(stretch, [-0.2, 0, 0, 0, 0, 0.3], atol=1e-16)


def test_a_spring_behind_it_takes_up_the_whole_gap_from_flank_to_flank() -> None:
    spring = _core.transmission.Compliance(stiffness=50.0, damping=0.0)
    position = np.linspace(-1, 1, 2001)
    force = spring.force(position=law.stretch(position=position))
    assert np.ptp(position[np.abs(force) < 1e-12]) == pytest.approx(0.2)
    assert force[-1] == pytest.approx(45.0)

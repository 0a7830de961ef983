import numpy as np
import pytest

from tendonlab import _core

BY_BISECTOR = {"a1": 0.0, "a2": 0.0, "b11": 0.6, "b12": -0.6, "b21": -0.6, "b22": 0.6, "c1": 0.0, "c2": 0.0}


def test_branches_with_the_signs_of_the_bisector_are_its_friction() -> None:
    """b = (+, -, -, +) 2 mu makes eq. 11 of S2 eq. 10 times the sense."""
    theta = np.linspace(-1.0, 1.0, 21)
    branches, sine = _core.friction.BushingBranches(**BY_BISECTOR), _core.friction.BushingSine(sine_coefficient=0.3)
    for velocity in (0.01, -0.01):
        seen = {"velocity": velocity, "wrap_angle": theta, "load": 150.0}
        assert branches.force(**seen) == pytest.approx(sine.force(**seen), abs=1e-12)


def test_branches_meet_at_their_edges() -> None:
    law = _core.friction.BushingBranches(**{**BY_BISECTOR, "a1": 7.0, "c1": 0.2})
    near = law.force(velocity=1.0, wrap_angle=np.array([0.2 - 1e-9, 0.2, 0.2 + 1e-9]), load=150.0)
    assert near == pytest.approx(7.0, abs=1e-6)


def test_a_straight_cable_does_not_rub_and_half_a_turn_does() -> None:
    capstan = _core.friction.BushingCapstan(capstan_coefficient=0.2)
    assert capstan.level(wrap_angle=0.0, load=100.0) == 0.0
    assert capstan.level(wrap_angle=np.pi, load=100.0) == pytest.approx(87.446, abs=1e-3)  # by hand
    bisector = _core.friction.BushingSine(sine_coefficient=0.2).level(wrap_angle=np.pi, load=100.0)
    assert bisector == pytest.approx(40.0, rel=1e-10)  # the core's own sine is good to 1e-11

"""What a law is given is named with its unit where it is not finite."""

import numpy as np
import pytest

import tendonlab as tl

UNITS = {
    "velocity": "rad/s or m/s",
    "position": "rad or m",
    "load": r"N\*m or N",
    "preload": r"N\*m or N",
    "wrap_angle": "rad",
}


@pytest.mark.parametrize("name", UNITS)
@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_an_argument_that_is_not_finite_is_named_with_its_unit(name: str, wrong: float) -> None:
    law = tl.friction.Coulomb(coulomb=1.0)
    with pytest.raises(tl.ParameterError, match=rf"^{name} = .*: expected a value in \[.*\] {UNITS[name]}$"):
        law.force(**{"velocity": 1.0, name: [0.0, wrong]})


def test_the_largest_numbers_are_finite() -> None:
    assert tl.friction.Coulomb(coulomb=1.0).force(velocity=1.7e308) == 1.0

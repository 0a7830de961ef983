"""The output of a gear runs ahead and behind its input once a turn."""

import numpy as np
import pytest

from tendonlab import _core

SHARES = {"ripple_sine": 0.3, "ripple_cosine": -0.2}
INPUT = np.linspace(-7.0, 7.0, 1401)


def test_the_speed_of_the_output_goes_with_its_own_angle() -> None:
    moved = _core.transmission.Ripple(**SHARES).motion(position=INPUT, velocity=2.0)
    angle = moved["position"]
    assert moved["velocity"] == pytest.approx(2.0 * (1.0 + 0.3 * np.sin(angle) - 0.2 * np.cos(angle)), rel=1e-10)


def test_the_angle_is_the_integral_of_the_speed() -> None:
    moved = _core.transmission.Ripple(**SHARES).motion(position=INPUT, velocity=1.0)
    np.testing.assert_allclose(
        np.gradient(moved["position"], INPUT, edge_order=2)[1:-1], moved["velocity"][1:-1], rtol=2e-5
    )
    assert np.interp(0.0, INPUT, moved["position"]) == pytest.approx(0.0, abs=1e-10)


def test_a_turn_of_the_output_takes_more_than_one_of_the_input() -> None:
    """The integral of 1 / (1 + s sin + c cos) over a turn is 2 pi / sqrt(1 - s^2 - c^2)."""
    turn = 2.0 * np.pi / np.sqrt(1.0 - 0.3**2 - 0.2**2)
    moved = _core.transmission.Ripple(**SHARES).motion(position=turn * np.array([-1.0, 1.0, 2.0]), velocity=1.0)
    assert moved["position"] == pytest.approx(2.0 * np.pi * np.array([-1.0, 1.0, 2.0]), rel=1e-9)


def test_a_small_ripple_is_a_sine_on_top_of_the_angle() -> None:
    """To first order phi = psi + s (1 - cos psi) + c sin psi."""
    s, c = 1e-5, -2e-5
    moved = _core.transmission.Ripple(ripple_sine=s, ripple_cosine=c).motion(position=INPUT, velocity=1.0)
    assert moved["position"] - INPUT == pytest.approx(s * (1.0 - np.cos(INPUT)) + c * np.sin(INPUT), abs=2e-8)

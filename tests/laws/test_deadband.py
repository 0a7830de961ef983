"""A dead zone: by its slopes, by the amplitude of a sine behind it, and by a joint that it keeps at rest."""

import numpy as np
import pytest

from integrate.rig import joint, run
from tendonlab import _core

law = _core.actuation.Deadband(deadband=0.3)


def test_nothing_passes_inside_and_the_rest_loses_half_the_width() -> None:
    np.testing.assert_allclose(
        law.apply([-1.0, -0.3, -0.1, 0.0, 0.3, 0.5]), [-0.7, 0.0, 0.0, 0.0, 0.0, 0.2], atol=1e-15
    )


@pytest.mark.parametrize("amplitude", [0.5, 2.0, 30.0])
def test_gain_of_a_sine_is_the_describing_function_of_a_dead_zone(amplitude: float) -> None:
    """N = 1 - 2/pi (asin(w/A) + w/A sqrt(1 - (w/A)^2))."""
    phase = 2.0 * np.pi * (np.arange(200_000) + 0.5) / 200_000
    gain = 2.0 * np.mean(law.apply(amplitude * np.sin(phase)) * np.sin(phase)) / amplitude
    x = 0.3 / amplitude
    assert gain == pytest.approx(1.0 - 2.0 / np.pi * (np.arcsin(x) + x * np.sqrt(1.0 - x * x)), abs=1e-9)


def test_a_command_inside_moves_nothing_and_a_ramp_moves_late() -> None:
    """From t0 = w/a on J q'' = a t - w: q = a (t - t0)^3 / 6 and dq/dw = -(t - t0)^2 / 2 for J = 1."""
    time = np.linspace(0.0, 1.0, 201)
    free = joint(["actuation:deadband"], actuation_deadband=0.3)
    assert not np.any(run(free, time, 0.29).table)
    answer = run(free, time, 1.5 * time, kind="linear", by=["actuation_deadband"], tolerance=1e-10)
    late = np.maximum(time - 0.2, 0.0)
    np.testing.assert_allclose(answer["joint_angle"], 1.5 * late**3 / 6.0, atol=1e-8)
    # the rate of the derivative jumps inside one step, 1e-6 s long at this tolerance
    np.testing.assert_allclose(answer.gradient["actuation_deadband"][0], -(late**2) / 2.0, atol=1e-6)

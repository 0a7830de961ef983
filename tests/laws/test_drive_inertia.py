import numpy as np

from tendonlab import _core


def test_an_accelerating_drive_passes_on_less_and_a_braking_one_more() -> None:
    """J dv/dt = u - output: 0.5 kg m^2 at 4 rad/s^2 take 2 N m, at -1 rad/s^2 they give 0.5 N m."""
    law = _core.actuation.DriveInertia(inertia=0.5)
    np.testing.assert_allclose(law.apply([3.0, 3.0, 3.0], acceleration=[4.0, 0.0, -1.0]), [1.0, 3.0, 3.5])

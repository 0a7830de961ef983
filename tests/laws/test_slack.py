"""Once the returning tendon is loose, the pulling one carries all of the torque."""

import numpy as np
import pytest

from tendonlab import _core


def test_nothing_changes_up_to_the_torque_that_the_pretension_holds() -> None:
    law = _core.sheath.Slack(slack=1.0)
    assert np.all(law.factor(load=[0.0, 10.0, -26.0, 26.0], preload=26.0) == 1.0)


@pytest.mark.parametrize("torque", [30.0, -52.0, 260.0])
def test_far_beyond_friction_is_that_of_the_loaded_tendon_alone(torque: float) -> None:
    """With a = 1: P (1 - exp(-mu theta)) |tau| / P, the capstan relation of one tendon with the whole torque."""
    capstan = _core.sheath.Capstan(friction_coefficient=0.1, static_friction_coefficient=0.1, stribeck_velocity=0.1)
    level = capstan.level(velocity=1.0, wrap_angle=2.0, preload=26.0)
    friction = level * _core.sheath.Slack(slack=1.0).factor(load=torque, preload=26.0)
    assert friction == pytest.approx(abs(torque) * (1.0 - np.exp(-0.2)), rel=1e-9)


def test_friction_grows_in_proportion_to_the_share() -> None:
    half, whole = (_core.sheath.Slack(slack=a).factor(load=39.0, preload=26.0) for a in (0.5, 1.0))
    assert (half, whole) == pytest.approx((1.25, 1.5), rel=1e-9)

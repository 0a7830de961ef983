"""Of the motion of a drive whose torque rises, a share only stretches the pair of cables."""

import numpy as np
import pytest

from examples import T, with_effect
from integrate.rig import run
from tendonlab import _core


def test_what_slides_is_the_velocity_less_the_rate_of_stretch() -> None:
    law = _core.sheath.Compliance(stretch_share=0.5)
    behind = law.motion(velocity=[0.3, 0.3, -0.2], load_rate=[0.0, 100.0, 100.0], compliance=2e-3)
    np.testing.assert_allclose(behind["velocity"], [0.3, 0.2, -0.3])


def test_a_drive_that_only_stretches_the_cables_slides_through_no_sheath() -> None:
    """Turned by c tau with c = L/(2 EA r^2), the pair lengthens and the sheath does not move  (S3 eq. 7)."""
    system = with_effect("bowden_pair", "cable:compliance").with_parameters({"cable_stretch_share": 1.0})
    value = system.parameters
    c = value["sheath_length"] / (2.0 * value["cable_stiffness"] * value["input_radius"] ** 2)
    torque = 5.0 + 3.0 * T
    ports = run(
        system, T, {"input_torque": torque, "input_velocity": np.full(T.size, 3.0 * c)}, kind="linear", ports=True
    ).ports
    assert np.max(np.abs(ports["sheath"][0])) < 1e-15
    assert ports["cable"][0] == pytest.approx(3.0 * c, rel=1e-9)

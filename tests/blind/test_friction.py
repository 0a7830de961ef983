"""The friction level of the blind twins at points where its terms have known values."""

import numpy as np
import pytest

from tendonlab.blind.friction import Friction


@pytest.mark.parametrize(("form", "left"), [(0, np.exp(-1.0)), (1, 0.5)])
def test_the_static_excess_adds_to_the_level_and_falls_with_speed(form: int, left: float) -> None:
    """All of the excess at rest, the share `left` at the Stribeck velocity, none at high speed."""
    speeds = np.array([0.0, 0.05, -0.05, 1e3])
    stated = {"joint_coulomb": 0.2, "joint_static_excess": 0.1, "joint_stribeck_velocity": 0.05}
    lanes = {name: np.full(speeds.size, value) for name, value in stated.items()}
    friction = Friction(lanes, scale=np.ones((2, speeds.size)), form=np.full(speeds.size, form))
    velocity = np.stack([np.zeros_like(speeds), speeds])
    motor, joint = friction.level(velocity, load=np.zeros_like(velocity), direction=np.sign(velocity))
    np.testing.assert_allclose(joint, 0.2 + 0.1 * np.array([1.0, left, left, 0.0]), atol=1e-9)
    assert np.all(motor == 0.0)

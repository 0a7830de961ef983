"""The sessions and logs of the twin of S1."""

import numpy as np
import pytest

from tendonlab.papers.s1 import twin
from tendonlab.papers.s1.device import example_device


def test_one_motion_at_the_middle_level_is_repeated_and_the_third_is_held_out() -> None:
    found = twin.sessions((2.0, 0.5, 1.0))
    assert len(found) == 3 * 3 + 2
    repeated = [s for s in found if s.repeat]
    assert {(s.level, s.frequency) for s in repeated} == {(1.0, found[0].frequency)}
    assert [s.name[-2:] for s in repeated] == ["-1", "-2", "-3"]
    assert len({s.name for s in found}) == len(found)
    assert {s.split for s in found if s.name.endswith("-c")} == {"test"}
    assert sum(s.split == "test" for s in found) == 3


def test_motors_turn_as_the_derivative_of_the_sinusoids_of_their_joints() -> None:
    """Joint 4 alone drives no more than its own cable: the largest speed is 2·pi·frequency·amplitude."""
    device = example_device()
    (session, *_) = twin.sessions((1.0,))
    logs = twin.record(device, session, np.random.default_rng(0))
    time = logs.index.to_numpy()[:, None]
    turn = 2 * np.pi * np.array(session.frequency)
    amplitude = np.array([0.5, 0.35, 0.4, 0.5])
    angle = amplitude * np.sin(turn * time + session.phase)
    rates = np.gradient(angle, time[:, 0], axis=0)
    motor = rates @ device.radius.T / device.motor_radius
    for k in range(4):
        np.testing.assert_allclose(
            logs[f"motor_velocity_{k + 1}"][1:-1], motor[1:-1, k], atol=0.01 * np.ptp(motor[:, k])
        )
    assert time[-1, 0] == pytest.approx(10.0, abs=0.05)

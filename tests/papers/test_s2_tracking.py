"""The joint under a PID on the voltage of its motor, with and without feed-forward; its replay by `cable_joint`."""

import numpy as np
import pandas as pd
import pytest

from tendonlab.errors import ParameterError
from tendonlab.papers import s2

RIG = s2.constants(viscous_reading="C")
PLAN = s2.reference((0.0, 0.4, 0.0), speed=0.04)


@pytest.fixture(scope="module")
def runs() -> dict[str, pd.DataFrame]:
    ahead = {
        "PID": None,
        "speed": s2.feedforward_voltage(RIG, PLAN, friction=False),
        "friction": s2.feedforward_voltage(RIG, PLAN),
    }
    return {name: s2.track(RIG, PLAN, ahead=voltage) for name, voltage in ahead.items()}


def test_each_part_of_the_feed_forward_takes_nine_tenths_of_the_error(runs: dict[str, pd.DataFrame]) -> None:
    alone, speed, friction = (run["error"].abs().max() for run in runs.values())
    assert speed < 0.1 * alone
    assert friction < 0.1 * speed


def test_the_library_follows_the_same_voltage(runs: dict[str, pd.DataFrame]) -> None:
    """`cable_joint` knows neither the reference nor the controller; half a step of 1 ms at 0.04 rad/s is 2e-5 rad."""
    for run in runs.values():
        found = s2.system(RIG).simulate(run[["voltage"]], tolerance=1e-7)
        assert np.abs(found["joint_angle"] - run["theta"]).max() < 2e-5
        speed = run["motor_velocity"].abs().max()
        assert np.sqrt(np.mean((found["motor_velocity"] - run["motor_velocity"]) ** 2)) < 1e-3 * speed


def test_the_feed_forward_has_one_voltage_per_sample() -> None:
    with pytest.raises(ParameterError, match=r"ahead: \(3,\); expected \(25001,\), one voltage per sample"):
        s2.track(RIG, PLAN, ahead=np.zeros(3))

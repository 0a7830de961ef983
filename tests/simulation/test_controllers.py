"""The controller of a dataset as the simulator closes it, against the same loop in plain numpy."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

import tendonlab as tl
from tendonlab.simulation.records import Controller, Experiment

TIME = np.linspace(0.0, 2.0, 401)
KP, KD, INERTIA, GRAVITY, VISCOUS, GAIN = 30.0, 4.0, 0.8, 2.0, 0.3, 1.5


def reference(t: np.ndarray | float) -> Any:
    return 0.5 * np.sin(3.0 * t)


def push(t: np.ndarray | float) -> Any:
    return 0.7 * np.cos(2.0 * t)


def closed(frame: dict[str, np.ndarray], *, since: float = 0.0, held: bool = False, **of: Any) -> np.ndarray:
    """The joint under this controller, at rest at 0.1 rad in the beginning, with a clock that began `since` before."""
    loop = Controller(**{"kind": "pd", "kp": KP, "kd": KD, "measured": "joint_angle", "reference": "wanted", **of})
    values = {"inertia": INERTIA, "gravity_torque": GRAVITY, "torque_constant": GAIN, "viscous": VISCOUS}
    rig = tl.System(kind="rigid_joint", parameters=values, effects=("joint:viscous",), controller=loop)
    data = pd.DataFrame(frame, index=pd.Index(np.round(since + TIME, 6), name="t"))
    start = {"joint_angle": 0.1, "joint_velocity": 0.0}
    run = Experiment(name="run", data=data, initial=start, holds={"wanted": held})
    found = rig.simulate(run, replay="controller", tolerance=1e-9)
    return found["joint_angle"].to_numpy()


def expected(command: Any, *, rtol: float = 1e-9) -> np.ndarray:
    def rate(t: float, y: np.ndarray) -> list[float]:
        torque = GAIN * command(t, y[0], y[1]) - VISCOUS * y[1] - GRAVITY * np.sin(y[0])
        return [y[1], torque / INERTIA]

    return solve_ivp(rate, (0.0, 2.0), (0.1, 0.0), t_eval=TIME, rtol=rtol, atol=1e-9, max_step=0.01).y[0]


WANTED = {"wanted": reference(TIME)}


def test_the_derivative_is_of_the_error() -> None:
    other = expected(lambda t, q, v: KP * (reference(t) - q) + KD * (1.5 * np.cos(3.0 * t) - v))
    np.testing.assert_allclose(closed(WANTED), other, atol=1e-6)  # the reference is a spline


def test_the_derivative_is_of_the_measurement() -> None:
    other = expected(lambda t, q, v: KP * (reference(t) - q) - KD * v)
    np.testing.assert_allclose(closed(WANTED, derivative_on="measurement"), other, atol=3e-5)  # straight pieces


@pytest.mark.parametrize("on", ["error", "measurement"])
def test_a_cascade_damps_the_measured_velocity_alone(on: str) -> None:
    other = expected(lambda t, q, v: KD * (7.0 * (reference(t) - q) - v))
    np.testing.assert_allclose(closed(WANTED, kind="cascade", kp=7.0, derivative_on=on), other, atol=3e-5)


def test_a_command_is_limited_and_a_disturbance_added_after_the_limit() -> None:
    """The disturbance is held from sample to sample."""

    def command(t: float, q: float, v: float) -> float:
        limited = np.clip(KP * (reference(t) - q) - KD * v, -1.0, 1.0)
        return float(limited + push(TIME[min(int(t / 0.005 + 1e-9), 400)]))

    given = {"derivative_on": "measurement", "limit": 1.0, "disturbance": "push"}
    np.testing.assert_allclose(closed({**WANTED, "push": push(TIME)}, **given), expected(command, rtol=1e-8), atol=1e-4)


@pytest.mark.parametrize("since", [0.0, 1.0, 415.037, 1964.0003])
def test_a_sampled_controller_reads_the_reference_of_its_tick_whenever_its_clock_began(since: float) -> None:
    """Stamps are rounded. A held reference that is read a tick late makes the joint lag by a sample."""
    ticks = {"sample_time": 0.005, "derivative_on": "measurement"}
    straight = closed(WANTED, **ticks)  # at the ticks a reference that goes straight between them has the same values
    np.testing.assert_allclose(closed(WANTED, since=since, held=True, **ticks), straight, atol=1e-7)

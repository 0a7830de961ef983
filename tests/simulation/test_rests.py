"""Rests in a noisy record: found where only noise moves, left alone where something creeps; and what they are for: a
stuck simulator is not shaken loose by the noise of the reading that it is pulled to."""

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.simulation import rests
from tendonlab.simulation.prepare import Replay, prepare
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.rests import settled
from tendonlab.simulation.smoothing import smoothing_spline

NOISE = 1e-3


def moves_and_rests(rate: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, a motion that rests at 0, moves within half a second, and rests for 2 s, and the noisy record."""
    time = np.arange(0.0, 6.0, 1.0 / rate)
    since = np.clip((time % 2.5) / 0.5, 0.0, 1.0)
    motion = np.floor(time / 2.5) + 0.5 - 0.5 * np.cos(np.pi * since)
    return time, motion, motion + NOISE * np.random.default_rng(seed).normal(size=len(time))


@pytest.mark.parametrize("rate", [100, 250, 1000])
def test_rests_become_their_mean_and_motion_stays(rate: float) -> None:
    time, motion, values = moves_and_rests(rate)
    found = settled(time, values, NOISE)
    resting = time % 2.5 > 0.55
    changed = found != values
    assert np.mean(changed[resting]) > 0.9
    assert not changed[~resting & (time % 2.5 < 0.45)].any()
    assert np.abs(found - motion)[changed].max() < 0.5 * NOISE


@pytest.mark.parametrize("speed", [0.003, 0.02, 0.1])
def test_a_creep_that_leaves_the_noise_is_no_rest(speed: float) -> None:
    time = np.arange(0.0, 4.0, 0.004)
    values = speed * time + NOISE * np.random.default_rng(1).normal(size=len(time))
    np.testing.assert_array_equal(settled(time, values, NOISE), values)


def test_a_rest_begins_where_a_slow_stop_ends() -> None:
    """The last 10 noise sd of a stop take 0.3 s, too slow to be seen from one window to the next."""
    time = np.arange(0.0, 3.0, 0.004)
    motion = np.where(time < 1.3, 10.0 * NOISE * ((1.3 - time) / 0.3) ** 2, 0.0)
    values = motion + NOISE * np.random.default_rng(4).normal(size=len(time))
    found = settled(time, values, NOISE)
    assert np.mean(found[time > 1.4] != values[time > 1.4]) > 0.9
    assert np.abs(found - motion)[found != values].max() < 2.5 * NOISE


def test_a_record_without_noise_stays() -> None:
    time = np.arange(0.0, 3.0, 0.01)
    np.testing.assert_array_equal(settled(time, time**2, 0.0), time**2)


def test_a_long_slow_motion_is_searched_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A minute at 1 kHz, of a motion that no window sees: some hundreds of looks, not one for each pair of ends."""
    looks = []
    stays = rests._stays
    monkeypatch.setattr(rests, "_stays", lambda *given: looks.append(1) or stays(*given))
    time = np.arange(0.0, 60.0, 0.001)
    settled(time, 2.0 * NOISE * np.sin(0.3 * time) + NOISE * np.random.default_rng(5).normal(size=len(time)), NOISE)
    assert 0 < len(looks) < 1000


@pytest.mark.parametrize("num", [2, 5, 15, 40])
def test_a_record_too_short_to_rest_stays(num: int) -> None:
    time = np.arange(num) * 0.01
    values = np.random.default_rng(2).normal(size=num) if num < 20 else time**2
    np.testing.assert_array_equal(settled(time, values, NOISE), values)


def test_a_spline_near_the_record_does_not_move_in_a_rest() -> None:
    time, _, values = moves_and_rests(250)
    speed = smoothing_spline(time, values)(time, 1)
    inside = (time % 2.5 > 0.8) & (time % 2.5 < 2.2)
    assert np.abs(speed[inside]).max() < 1e-3 * np.abs(speed).max()


def test_the_true_simulator_stays_where_the_rig_sticks() -> None:
    """A joint that coulomb friction holds under a torque of 0.8 of it: pulled to the noisy reading, it would creep."""
    true = tl.System(
        kind="rigid_joint",
        parameters={"inertia": 0.0113, "gravity_torque": 0.0, "torque_constant": 1.0, "coulomb": 0.05},
        effects=("joint:coulomb",),
    )
    time = np.arange(0.0, 6.0, 0.004)
    pulses = np.where(time % 2.0 < 0.1, 0.4, np.where(time % 2.0 < 0.195, -0.3, 0.04))
    clean = true.simulate(pd.DataFrame({"motor_torque": pulses}, index=time))["joint_angle"].to_numpy()
    read = clean + 3e-4 * np.random.default_rng(3).normal(size=len(time))
    logged = Experiment(name="pulses", data=pd.DataFrame({"motor_torque": pulses, "joint_angle": read}, index=time))
    pulled = prepare(logged, true, Replay("injection", kp=10.0, kd=0.68, output="joint_angle"))
    run = _core.simulate(true.kind, true.values(), true.active(), pulled.core, [], pulled.settings(1e-6))
    crept = [np.ptp(np.asarray(run["outputs"])[0, (time > start) & (time < start + 1.0)]) for start in (0.9, 2.9, 4.9)]
    assert max(crept) < 1e-5

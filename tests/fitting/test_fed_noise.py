"""Noise that a sensor feeds back through its controller shakes the rig; the replay shakes the simulator alike."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.simulation.command import command_of, fed_noise
from tendonlab.simulation.prepare import Replay, prepare
from tendonlab.simulation.records import Controller, Experiment

STEP, FINE, NUM = 2e-3, 20, 1500  # the controller's period, plant steps in one, and periods
KP, KD, NOISE = 8.0, 1.2, 2e-3
INERTIA, COULOMB, VISCOUS = 0.02, 0.4, 0.05
LOOP = Controller("pd", KP, KD, "joint_angle", "wanted", sample_time=STEP)
TIME = STEP * np.arange(NUM)


def rig() -> tl.System:
    values = {"inertia": INERTIA, "gravity_torque": 0.0, "torque_constant": 1.0, "coulomb": COULOMB, "viscous": VISCOUS}
    effects = ("joint:coulomb", "joint:viscous")
    return tl.System(kind="rigid_joint", parameters=values, effects=effects, controller=LOOP)


@pytest.fixture(scope="module")
def logged() -> tuple[Experiment, np.ndarray]:
    """The log of a joint that its noisy sensor shakes, in plain numpy, and the noise."""
    noise = NOISE * np.random.default_rng(3).standard_normal(NUM)
    wanted = 0.3 * np.sin(2.0 * np.pi * 0.5 * TIME)
    angle, speed, read, error_before = 0.0, 0.0, np.empty(NUM), None
    command = np.empty(NUM)
    for k in range(NUM):
        read[k] = angle + noise[k]
        error = wanted[k] - read[k]
        command[k] = KP * error + KD * (error - (error if error_before is None else error_before)) / STEP
        error_before = error
        for _ in range(FINE):
            push = command[k] - VISCOUS * speed
            stops = COULOMB / INERTIA * STEP / FINE
            free = speed + push / INERTIA * STEP / FINE
            speed = np.sign(free) * max(abs(free) - stops, 0.0)
            angle += speed * STEP / FINE
    data = pd.DataFrame(
        {"motor_torque": command, "joint_angle": read, "wanted": wanted}, index=pd.Index(TIME, name="t")
    )
    return Experiment(name="shaken", data=data, initial={"joint_angle": 0.0, "joint_velocity": 0.0}), noise


def misfit(experiment: Experiment, **replay: Any) -> float:
    """Rms of what the true simulator leaves, in noises, after the first tenth of a second."""
    system = rig()
    ready = prepare(experiment, system, Replay("controller", KP, KD, "joint_angle", **replay))
    run = _core.simulate(system.kind, system.values(), system.active(), ready.core, [], ready.settings(1e-6))
    left = (np.asarray(run["outputs"][0]) - ready.measured[0])[50:]
    return float(np.sqrt(np.mean(np.square(left))) / NOISE)


def test_the_true_simulator_leaves_the_noise_alone_once_it_is_shaken_alike(
    logged: tuple[Experiment, np.ndarray],
) -> None:
    experiment, _ = logged
    assert misfit(experiment) > 1.3
    assert misfit(experiment, feeds_noise=True) < 1.05


def test_what_noise_added_is_told_from_the_log(logged: tuple[Experiment, np.ndarray]) -> None:
    experiment, noise = logged
    found = fed_noise(LOOP, experiment, "motor_torque")
    assert found is not None
    ticks, added = found
    np.testing.assert_allclose(ticks, TIME)
    truth = -KP * noise - KD * np.diff(noise, prepend=noise[0]) / STEP
    assert np.std(added - truth) < 0.2 * np.std(truth)


def test_a_stated_disturbance_stays(logged: tuple[Experiment, np.ndarray]) -> None:
    """It is part of the command, and added with what the noise adds."""
    experiment, _ = logged
    without = fed_noise(LOOP, experiment, "motor_torque")
    push = np.where(TIME > 1.0, 0.1, 0.0)
    pushed = experiment.data.assign(push=push, motor_torque=experiment.data["motor_torque"] + push)
    found = fed_noise(replace(LOOP, disturbance="push"), replace(experiment, data=pushed), "motor_torque")
    assert without is not None
    assert found is not None
    np.testing.assert_allclose(found[1], without[1] + push, atol=1e-12)


def test_a_missing_sample_adds_nothing(logged: tuple[Experiment, np.ndarray]) -> None:
    experiment, _ = logged
    data = experiment.data.copy()
    data.iloc[700, data.columns.get_loc("joint_angle")] = np.nan
    found = fed_noise(LOOP, replace(experiment, data=data), "motor_torque")
    assert found is not None
    assert found[1][700] == 0.0
    assert np.isfinite(found[1]).all()


@pytest.mark.parametrize("case", ["no clock", "no command", "other instants", "no noise", "noise of the log alone"])
def test_nothing_is_added_where_the_log_does_not_tell(case: str, logged: tuple[Experiment, np.ndarray]) -> None:
    experiment, _ = logged
    data, loop = experiment.data, LOOP
    if case == "no clock":
        loop = replace(LOOP, sample_time=0.0)
    elif case == "no command":
        data = data.drop(columns="motor_torque")
    elif case == "noise of the log alone":
        data = data.assign(joint_angle=data["joint_angle"] + NOISE * np.random.default_rng(4).standard_normal(NUM))
        data = data.assign(motor_torque=command_of(loop, experiment, data["wanted"].to_numpy()))
    elif case == "other instants":
        data = data.iloc[::2]
    else:
        data = data.assign(joint_angle=data["wanted"])
    assert fed_noise(loop, replace(experiment, data=data), "motor_torque") is None

"""How stiff an injection is: what an unexplained effort may do, and the limits set by motion and samples."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tendonlab as tl
from checking.pendulum import CONSTANT, GRAVITY, Logs
from tendonlab.fitting.case import make_case
from tendonlab.fitting.replay import _frequency_below, choose_replay

RATE = 250
TIME = np.arange(2001) / RATE
INERTIA = 0.019 / CONSTANT  # of the simulator of these logs, per unit of the command


def rig(folder: Path, *, noise: float, effort: float = 1.0, frequency: float = 1.0) -> tl.Dataset:
    """Half a radian at `frequency` under a command of the rms `effort`."""
    angle = 0.5 * np.sin(2 * np.pi * frequency * TIME) + noise * np.random.default_rng(0).standard_normal(len(TIME))
    command = np.sqrt(2.0) * effort * np.cos(2 * np.pi * frequency * TIME)
    return Logs({"a": (TIME, angle, command)}).write(folder)


def omega(dataset: tl.Dataset) -> float:
    """Bandwidth of the injection, rad/s, which is critically damped."""
    found = choose_replay(dataset, dataset.system())
    assert found.kind == "injection"
    assert found.output == "joint_angle"
    assert found.kp is not None
    assert found.kd is not None
    bandwidth = float(np.sqrt(found.kp / INERTIA))
    assert found.kd == pytest.approx(2.0 * INERTIA * bandwidth)
    return bandwidth


def test_a_tenth_of_the_effort_moves_the_sensor_by_ten_times_its_noise(tmp_path: Path) -> None:
    noise, effort = 2e-3, 1.0
    stiffness = omega(rig(tmp_path, noise=noise, effort=effort)) ** 2 * INERTIA
    assert 0.1 * effort / stiffness == pytest.approx(10.0 * noise, rel=0.1)  # the noise is estimated


def test_an_injection_is_no_faster_than_the_samples_resolve(tmp_path: Path) -> None:
    assert omega(rig(tmp_path, noise=1e-5)) == pytest.approx(0.25 * RATE)


def test_the_true_model_does_not_stick_and_slip_where_the_rig_slides_on_falling_friction(tmp_path: Path) -> None:
    """Friction falls by 0.8 N·m·s/rad at this speed, which acts as a negative damper; a loop of 100 samples per second
    must outweigh it. A start that is 10 mrad/s too fast is then forgotten, and the log is met within 1 µrad."""
    time, speed, coulomb, viscous, excess, falloff = np.arange(0.0, 6.0, 0.01), 0.0424, 0.06, 0.04, 0.056, 0.06
    truth = tl.System(
        kind="rigid_joint",
        parameters={
            "inertia": 0.019, "gravity_torque": GRAVITY, "torque_constant": CONSTANT, "coulomb": coulomb,
            "viscous": viscous, "joint_static_excess": excess, "joint_stribeck_velocity": falloff,
        },
        effects=("joint:coulomb", "joint:viscous", "joint:stribeck"),
    )  # fmt: skip
    resistance = coulomb + excess * np.exp(-((speed / falloff) ** 2)) + viscous * speed
    weight = GRAVITY * np.sin(speed * (time + 0.005))  # the command is held for 0.01 s
    dataset = Logs({"a": (time, speed * time, (resistance + weight) / CONSTANT)}).write(tmp_path)
    case = make_case(dataset, truth, tolerance=1e-6)
    error = case.run(0, truth, [0.0, speed + 0.01])["outputs"][0] - speed * time
    assert np.max(np.abs(error[300:])) < 1e-6


@pytest.mark.parametrize("frequency", [1.0, 3.0])
def test_an_injection_has_half_the_bandwidth_of_the_motion_at_least(frequency: float, tmp_path: Path) -> None:
    found = omega(rig(tmp_path, noise=0.02, effort=1e-3, frequency=frequency))
    assert found == pytest.approx(
        0.5 * 2 * np.pi * frequency, abs=0.5 * 2 * np.pi * 2 / 8
    )  # resolved to two bins of 1/8 Hz


def test_without_a_measured_motion_or_command_the_replay_is_free(tmp_path: Path) -> None:
    dataset = rig(tmp_path, noise=1e-3)
    blind = replace(dataset.experiments[0], data=dataset.experiments[0].data.assign(joint_angle=np.nan))
    assert choose_replay(replace(dataset, experiments=(blind,)), dataset.system()).kind == "free"
    signals = {name: spec for name, spec in dataset.signals.items() if name != "motor_torque"}
    assert choose_replay(replace(dataset, signals=signals), dataset.system()).kind == "free"


@pytest.mark.parametrize("missing", [False, True])
def test_most_of_the_power_of_two_sines_lies_below_the_faster_one_only_if_it_is_strong(missing: bool) -> None:
    slow, fast = np.sin(2 * np.pi * 2.0 * TIME), np.sin(2 * np.pi * 9.0 * TIME)
    weak, strong = 5.0 + slow + 0.1 * fast, 5.0 + slow + 0.5 * fast
    for values in (weak, strong) if missing else ():
        values[300:310] = np.nan
    assert _frequency_below(3.0 + TIME, weak) == pytest.approx(2.0, abs=0.26)
    assert _frequency_below(3.0 + TIME, strong) == pytest.approx(9.0, abs=0.26)

"""Simulated rigs: their controller, their noise, their beliefs, and the size of an effect."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.rehearsal.build import simulated_rig
from tendonlab.rehearsal.plan import planned_experiments, rig_without_logs
from tendonlab.rehearsal.sensors import Sensor
from tendonlab.rehearsal.sizes import Gauge, withheld_effects
from tendonlab.simulation.command import command_of
from tendonlab.simulation.records import Controller, Experiment


def test_the_logged_command_replays_the_simulated_motion(pendulum: Path) -> None:
    """Whoever applies the command that a simulated rig logged gets the motion that it logged."""
    rigs = simulated_rig(tl.load(pendulum))
    assert rigs.drive.tracks
    (log, *_) = rigs.clean({"load:offset": {"load_offset": 0.02}}).experiments
    system = rigs.rig.system().with_effects({"load:offset": {"load_offset": 0.02}})
    again = system.simulate(replace(log, initial={"joint_angle": 0.0, "joint_velocity": 0.0}))["joint_angle"]
    error = float((again - log.data["joint_angle"]).std())
    assert error < 0.1 * float((log.data["joint_angle"] - rigs.runs[0].data["joint_angle"]).std())


@pytest.mark.parametrize("sample_time", [0.0, 0.02])
def test_the_command_is_that_of_the_controller(sample_time: float) -> None:
    """A ramp behind a still joint: u = kp·r + kd·rate, clipped, plus the disturbance."""
    import pandas as pd

    time = np.arange(0.0, 1.0, 0.02)
    frame = pd.DataFrame({"r": 2.0 * time, "d": 0.0 * time + 0.1}, index=pd.Index(time, name="t"))
    loop = Controller("pd", 3.0, 0.5, "joint_angle", "r", limit=4.0, sample_time=sample_time, disturbance="d")
    command = command_of(loop, Experiment(name="ramp", data=frame), 0.0 * time)
    expected = np.minimum(6.0 * time + 1.0, 4.0) + 0.1
    assert command[1:] == pytest.approx(expected[1:])  # a sampled controller knows no rate at its first tick
    assert command[0] == pytest.approx(0.1 if sample_time else 1.1)


def test_a_sensor_has_its_noise_memory_and_resolution() -> None:
    random = np.random.default_rng(0)
    white = Sensor("q", 0.01).drawn(20000, random)
    assert white.std() == pytest.approx(0.01, rel=0.03)
    slow = Sensor("q", 0.01, memory=(0.9,)).drawn(20000, random)
    assert slow.std() == pytest.approx(0.01 / np.sqrt(1 - 0.81), rel=0.1)  # stationary sd of an AR(1) process
    rounded = Sensor("q", 0.01, resolution=0.25).rounded(np.linspace(0, 1, 50))
    assert set(np.round(rounded / 0.25, 9) % 1) == {0.0}


def test_parameters_are_drawn_from_the_beliefs(pendulum: Path) -> None:
    rigs = simulated_rig(tl.load(pendulum))
    inertia = next(belief for belief in rigs.beliefs if belief.name == "inertia")
    drawn = np.array([inertia.draw(np.random.default_rng(k)) for k in range(400)])
    assert np.log(drawn / 0.02).std() == pytest.approx(0.05, rel=0.15)
    assert np.abs(np.log(drawn / 0.02)).max() <= 2 * 0.05 + 1e-12


def test_a_missing_sample_stays_missing(pendulum: Path) -> None:
    rig = tl.load(pendulum)
    first = rig.experiments[0]
    holed = first.data.copy()
    holed.iloc[40:50, holed.columns.get_loc("joint_angle")] = np.nan
    rig = replace(rig, experiments=(replace(first, data=holed), *rig.experiments[1:]))
    log = simulated_rig(rig).drawn(np.random.default_rng(1), {}).experiments[0]
    assert np.flatnonzero(log.data["joint_angle"].isna()).tolist() == list(range(40, 50))


def test_the_effects_that_are_withheld_are_those_a_diagnosis_considers(pendulum: Path) -> None:
    rig = tl.load(pendulum)
    names = withheld_effects(rig.system(), rig.outputs)
    assert {"joint:stribeck", "joint:presliding", "actuation:delay", "sensor.joint_angle:bias"} <= set(names)
    assert not {"joint:coulomb", "sensor.joint_velocity:bias"} & set(names)  # in the simulator; not recorded


def test_a_larger_effect_leaves_a_larger_gap(pendulum: Path) -> None:
    gauge = Gauge(simulated_rig(tl.load(pendulum)))
    ladder = gauge.ladder("joint:presliding", 0.5)
    assert ladder.falls  # the softer the bristle, the larger the effect
    assert ladder.amount(2.0) < ladder.amount(1.0)
    values = ladder.values(1.0)
    assert values["joint_presliding_share"] == 1.0
    assert gauge.gap("joint:presliding", values) == pytest.approx(1.0, rel=0.2)
    assert gauge.gap("load:offset", {"load_offset": 0.0}) == pytest.approx(0.0, abs=1e-6)


def test_a_planned_rig_follows_its_controller(planned: Path) -> None:
    plan = planned / "plan.toml"
    plan.write_text(
        'format = "tendonlab-plan/1"\nrate = 100\n'
        + '[[experiments]]\nname = "a"\nshape = "chirp"\namplitude = 0.4\nduration = 3\nfrequencies = [0.2, 0.5]\n'
        + '[[experiments]]\nname = "b"\nshape = "steps"\namplitude = 0.4\noffset = 0.2\nduration = 3\nhold = 0.5\n'
    )
    rig = rig_without_logs(planned)
    rigs = simulated_rig(rig, planned_experiments(plan, rig))
    logs = rigs.drawn(np.random.default_rng(2), {})
    assert [e.name for e in logs.train] == ["a"]
    data = logs["a"].data
    assert set(data.columns) == {"reference_angle", "joint_angle", "motor_torque"}
    assert float((data["joint_angle"] - data["reference_angle"]).std()) < 0.1
    assert logs["b"].data["joint_angle"].iloc[0] == pytest.approx(0.2, abs=0.01)  # it starts where the reference does


@pytest.mark.parametrize(("rate", "hears"), [(100, True), (50, False)])
def test_a_controller_hears_the_noise_of_its_sensor_at_each_tick(planned: Path, rate: int, hears: bool) -> None:
    """The logged command is that of the noisy reading, and the noise shakes the joint; behind a log that is slower than
    the clock neither is known."""
    plan = planned / "plan.toml"
    plan.write_text(
        f'format = "tendonlab-plan/1"\nrate = {rate}\n'
        '[[experiments]]\nname = "a"\nshape = "chirp"\namplitude = 0.4\nduration = 3\nfrequencies = [0.2, 0.5]\n'
    )
    rig = rig_without_logs(planned)
    assert rig.controller is not None
    rig = replace(rig, controller=replace(rig.controller, sample_time=0.01))
    rigs = simulated_rig(rig, planned_experiments(plan, rig))
    loop = rigs.drive.controller
    assert loop is not None
    quiet, noisy = rigs.clean({})["a"], rigs.noisy(np.random.default_rng(2), rigs.system)["a"]
    wanted = command_of(loop, noisy, noisy.data["joint_angle"].to_numpy(dtype=float))
    missed = wanted - noisy.data["motor_torque"]
    heard = noisy.data["motor_torque"] - quiet.data["motor_torque"]
    assert (missed.std() < 1e-3 * heard.std()) == hears


def test_with_repeats_the_noise_is_what_they_do_not_repeat(pendulum: Path) -> None:
    """Simulated repeats of a rig whose sensor is noisier than stated show that noise, and its friction's scatter."""
    rig = tl.load(pendulum)
    noise = simulated_rig(rig).noise
    assert (noise.repeated, noise.scatter) == (False, 0.008)
    assert noise.words == "what the best model leaves of the logs"
    random, first = np.random.default_rng(4), rig.experiments[0]
    system = rig.system()
    repeats = []
    for k in range(4):
        own = system.with_parameters({"coulomb": 0.05 * float(np.exp(0.1 * random.normal()))})
        angle = own.simulate(first)["joint_angle"] + 4e-3 * random.normal(size=len(first.data))
        data = first.data.assign(joint_angle=angle)
        repeats.append(replace(first, name=f"repeat-{k}", repeat="A", data=data))
    noise = simulated_rig(replace(rig, experiments=tuple(repeats))).noise
    assert noise.repeated
    assert noise.words == "what the repeats of the rig do not repeat"
    assert 0.02 < noise.scatter < 0.2  # four runs tell an sd to a factor of two or so
    read = noise.sensors[0].drawn(5000, random)
    assert read.std() == pytest.approx(4e-3, rel=0.15)

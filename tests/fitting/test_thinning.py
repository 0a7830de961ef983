"""Thinning keeps motion and impulses, lowers white noise by what it says, and leaves alone what it would spoil."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.fitting.noise import noise_of
from tendonlab.fitting.thinning import _means, local_parabolas, thinned
from tendonlab.simulation.catalog import system_info
from tendonlab.simulation.reading import white_noise_sd
from tendonlab.simulation.records import Experiment

RNG = np.random.default_rng(5)
TIME = np.arange(4001) / 1000.0
NOISE = 1e-4
MASS = tl.System(
    kind="rigid_joint",
    parameters={"inertia": 0.01, "gravity_torque": 0.0, "torque_constant": 1.0, "coulomb": 0.02},
    effects=("joint:coulomb",),
)


@pytest.fixture(scope="module")
def torque():
    return 0.1 * np.sin(2 * np.pi * 1.3 * TIME) + 0.004 * RNG.normal(size=len(TIME))


@pytest.fixture(scope="module")
def rig(torque, tmp_path_factory):
    """A joint driven by a torque that is held from sample to sample, logged at 1 kHz."""
    held = Experiment(name="run", data=pd.DataFrame({"motor_torque": torque}, index=pd.Index(TIME, name="t")))
    angle = MASS.simulate(held)["joint_angle"].to_numpy() + NOISE * RNG.normal(size=len(TIME))
    folder = tmp_path_factory.mktemp("rig")
    table = pd.DataFrame({"t": TIME, "u": torque, "q": angle})
    table.to_csv(folder / "run.csv", index=False)
    (folder / "dataset.toml").write_text(
        'format = "tendonlab-dataset/1"\nname = "joint"\ntime = { column = "t", unit = "s" }\n'
        '[system]\nkind = "rigid_joint"\n[system.parameters]\ninertia = { value = 0.01, sd = 0.001 }\n'
        "gravity_torque = { value = 0.0, sd = 0 }\ntorque_constant = { value = 1.0, sd = 0 }\n"
        "coulomb = { value = 0.02 }\n"
        '[signals]\nmotor_torque = { column = "u", unit = "N*m" }\njoint_angle = { column = "q", unit = "rad" }\n'
        '[[experiments]]\nname = "run"\nfile = "run.csv"\nsplit = "train"\n'
    )
    return tl.load(folder)


def thin(rig, **changes):
    """The only experiment of the rig, thinned, with columns or fields changed before."""
    (experiment,) = rig.experiments
    columns = {k: v for k, v in changes.items() if k in experiment.data.columns}
    experiment = replace(experiment, data=experiment.data.assign(**columns))
    few = thinned(replace(rig, experiments=(experiment,)))
    return few, few.experiments[0]


def test_parabolas_are_kept_exactly_at_the_ends_and_where_samples_miss():
    values = 0.3 - 2.0 * TIME + 0.7 * TIME**2
    values[[3, 900, 901, 1500]] = np.nan
    found = local_parabolas(TIME, values, 10)
    assert found.values == pytest.approx((0.3 - 2.0 * TIME + 0.7 * TIME**2)[::10], abs=1e-12)
    assert np.abs(found.removed).max() < 1e-12


def test_white_noise_falls_by_the_gain():
    noise = RNG.normal(size=200_001)
    found = local_parabolas(np.arange(200_001) / 1000.0, noise, 10)
    assert found.gain == pytest.approx(np.sqrt(9 / 4 / 21), rel=0.02)  # of a parabola's middle over 21 samples
    assert np.std(found.values) == pytest.approx(found.gain, rel=0.02)


def test_what_is_hardly_measured_is_missing():
    values = np.sin(TIME)
    values[992:1010] = np.nan
    found = local_parabolas(TIME, values, 10).values
    assert np.isnan(found[100])
    assert np.isfinite(np.delete(found, 100)).all()


@pytest.mark.parametrize("factor", [2, 3, 5])
def test_two_samples_make_no_parabola(factor):
    values = np.sin(TIME)
    values[100:104] = np.nan
    values[105:120] = np.nan
    found = local_parabolas(TIME, values, factor).values
    assert np.abs(found - np.sin(TIME[::factor]))[np.isfinite(found)].max() < 1e-6
    assert np.isnan(found).sum() >= 10 // factor


def test_a_log_of_1_khz_becomes_one_of_100_hz_with_the_same_impulses(rig, torque):
    few, after = thin(rig)
    assert len(after.time) == 401
    assert "thinned from 1000 to 100 samples per second" in few.warnings[-1]
    assert few.signals["joint_angle"].noise_sd == pytest.approx(NOISE * np.sqrt(9 / 4 / 21), rel=0.1)
    impulse = np.concatenate([[0.0], np.cumsum(torque[:-1]) * 1e-3])[::10]
    means = after.data["motor_torque"].to_numpy()
    assert np.cumsum(means[:-1]) * 1e-2 == pytest.approx(impulse[1:], abs=1e-12)


def test_the_simulator_moves_alike_before_and_after(rig):
    computed = 0.1 * np.sin(2 * np.pi * 1.3 * TIME)
    before = replace(rig["run"], data=rig["run"].data.assign(motor_torque=computed))
    _, after = thin(rig, motor_torque=computed)
    start = {"joint_angle": 0.0, "joint_velocity": 0.1}
    moved = [MASS.simulate(replace(of, initial=start))["joint_angle"].to_numpy() for of in (before, after)]
    assert np.abs(moved[1] - moved[0][::10]).max() < 0.1 * NOISE


def test_identify_finds_the_same_parameter_from_few_samples(rig):
    few, _ = thin(rig)
    full, found = (tl.identify(of, progress=False).parameters.loc["coulomb"] for of in (rig, few))
    assert abs(found["value"] - full["value"]) < full["sd"]
    assert 0.9 * full["sd"] < found["sd"] < 1.3 * full["sd"]


@pytest.mark.parametrize(
    "change",
    [
        {"joint_angle": lambda of: of["joint_angle"] + 5 * NOISE * np.sin(2 * np.pi * 180.0 * of.index)},
        {"joint_angle": lambda of: of["joint_angle"] + np.where(of.index > 2.0, 0.02, 0.0)},
    ],
    ids=["vibration", "jump"],
)
def test_motion_that_would_be_smoothed_away_is_kept(rig, change):
    (experiment,) = rig.experiments
    values = change["joint_angle"](experiment.data)
    noisy = replace(rig, signals={**rig.signals, "joint_angle": replace(rig.signals["joint_angle"], noise_sd=NOISE)})
    _, after = thin(noisy, joint_angle=values)
    assert len(after.time) == len(TIME)


def test_a_torque_that_shakes_the_joint_is_kept(rig, torque):
    """What is left out of a torque may be noise, not a dither as large as the friction that it frees."""
    _, after = thin(rig, motor_torque=torque + 0.05 * np.sign(np.sin(2 * np.pi * 200.0 * TIME)))
    assert len(after.time) == len(TIME)


@pytest.mark.parametrize(("step", "samples"), [(0.02, 401), (2.0, 2001), (20.0, 4001)])
def test_a_step_of_the_torque_that_would_move_the_joint_early_or_late_is_kept(rig, torque, step, samples):
    """Smoothed over 10 ms, a step of 2 N·m moves 0.01 kg·m² by 1.7 mrad, one of 0.02 N·m by less than
    the noise."""
    stepped = 0.1 * np.sin(2 * np.pi * 1.3 * TIME) + step * (TIME > 2.0035)
    assert len(thin(rig, motor_torque=stepped)[1].time) == samples


def servo(folder, target, **inputs):
    """Logs of a servo that drives a pendulum, from the library's own simulator."""
    values = {"inertia": 0.02, "torque_constant": 1.4, "resistance": 2.0, "proportional_gain": 35.0, "coulomb": 0.1}
    values |= {"voltage_limit": 7.4, "gravity_torque": 0.5, "armature": 0.0, "angle_offset": 0.0}
    lines = ["format = 'tendonlab-dataset/1'", "name = 'servo'", "[system]", "kind = 'servo_pendulum'"]
    lines += ["[system.parameters]", *(f"{name} = {{ value = {value} }}" for name, value in values.items())]
    lines += [*(f"[signals.{name}]" for name in ("target_angle", *inputs)), "[signals.joint_angle]"]
    lines += [f"noise_sd = {NOISE}", "[[experiments]]", "name = 'a'", "file = 'a.csv'", "split = 'train'"]
    (folder / "dataset.toml").write_text("\n".join(lines), encoding="utf-8")
    given = pd.DataFrame({"target_angle": target, **inputs}, index=pd.Index(TIME, name="t"))
    angle = (
        tl.System(kind="servo_pendulum", parameters=values, effects=("joint:coulomb",))
        .simulate(given)["joint_angle"]
        .to_numpy()
    )
    given.assign(joint_angle=angle + NOISE * RNG.normal(size=len(TIME))).to_csv(folder / "a.csv")
    return tl.load(folder)


@pytest.mark.parametrize(("step", "samples"), [(0.0, 401), (0.3, 4001)])
def test_a_step_of_a_servos_target_is_kept(tmp_path, step, samples):
    """Smoothed, the drive would pull to it early, and less hard than a drive at its limit does."""
    target = 0.3 * np.sin(2 * np.pi * 0.5 * TIME) + step * (TIME > 2.0035)
    assert len(thinned(servo(tmp_path, target))["a"].time) == samples


@pytest.mark.parametrize(("released", "samples"), [(2.0, 401), (2.003, 4001)])
def test_a_release_stays_when_it_was(tmp_path, released, samples):
    """A switch that is smoothed releases a load early; one between samples that are kept, early or late."""
    rig = servo(tmp_path, 0.3 * np.sin(TIME), torque_enable=np.where(released > TIME + 1e-9, 1.0, 0.0))
    few = thinned(rig)
    assert len(few["a"].time) == samples
    falls, thin_falls = (of.system().simulate(of["a"])["joint_angle"] for of in (rig, few))
    assert np.abs(thin_falls - falls.loc[thin_falls.index]).loc[1.5:].max() < 0.3 * NOISE


@pytest.mark.parametrize(("jump", "samples"), [(3.0, 401), (30.0, 4001)])
def test_an_output_that_jumps_is_kept(rig, jump, samples):
    jumped = rig.experiments[0].data["joint_angle"] + jump * NOISE * (TIME > 2.0035)
    assert len(thin(rig, joint_angle=jumped)[1].time) == samples


def test_an_input_that_goes_straight_between_samples_has_other_means(rig):
    """As the log says, so the means are made: a ramp that is held lags half a sample behind one that goes straight."""
    (experiment,) = rig.experiments
    straight = replace(experiment, holds={"motor_torque": False})
    held, ramp = (
        thinned(replace(rig, experiments=(replace(of, data=of.data.assign(motor_torque=TIME)),)))["run"].data
        for of in (experiment, straight)
    )
    assert ramp["motor_torque"].iloc[:-1].to_numpy() == pytest.approx(TIME[:-1:10] + 0.005, abs=1e-12)
    assert (ramp - held)["motor_torque"].iloc[:-1].to_numpy() == pytest.approx(0.0005, abs=1e-12)


def test_a_log_with_a_gap_or_of_100_hz_stays_as_it_is(rig):
    (experiment,) = rig.experiments
    gap = replace(experiment, data=experiment.data.drop(experiment.data.index[1000:1020]))
    slow = replace(experiment, data=experiment.data.iloc[::10])
    for given in (gap, slow):
        dataset = replace(rig, experiments=(given,))
        assert thinned(dataset) is dataset


def test_noise_is_measured_in_the_log_unless_stated(rig):
    angle = rig["run"].data["joint_angle"].to_numpy()
    assert white_noise_sd(angle) == pytest.approx(NOISE, rel=0.1)


@pytest.mark.parametrize("stated", [None, NOISE])
def test_rounding_falls_with_the_noise(rig, stated):
    """An encoder whose rounding is all its noise keeps a stated noise: differences of few samples hold motion."""
    step = 1e-3
    encoder = replace(rig.signals["joint_angle"], noise_sd=stated, resolution=step)
    angle = step * np.round(rig["run"].data["joint_angle"] / step)
    few, after = thin(replace(rig, signals={**rig.signals, "joint_angle": encoder}), joint_angle=angle)
    gain = few.signals["joint_angle"].resolution / step
    assert 0.2 < gain < 0.6
    there = noise_of(few.signals["joint_angle"], [after.data["joint_angle"].to_numpy()])
    assert there == pytest.approx(gain * np.hypot(step / np.sqrt(12.0), stated or 0.0), rel=1e-9)


def test_a_sensor_that_is_read_at_few_stamps_is_not_lost(rig):
    """At 100 Hz too few samples for a parabola in any window: nothing would be left of the sensor."""
    (experiment,) = rig.experiments
    sparse = experiment.data["joint_angle"].where(np.arange(len(experiment.data)) % 3 == 0)
    assert np.isnan(local_parabolas(TIME, sparse.to_numpy(), 10).values).all()
    _, few = thin(rig, joint_angle=sparse)
    assert few.data["joint_angle"].count() > 400


def test_a_drive_that_rests_under_a_reading_that_flickers_rests_after_thinning():
    """Means of a flickering reading would move the bristles that the drive bends to and fro."""
    step = 4.8e-5
    angle = np.interp(TIME, [0.0, 1.0, 2.0, 4.0], [0.0, 0.0, 0.3, 0.3])
    read = step * np.round((angle + 0.3 * step * np.random.default_rng(2).normal(size=len(TIME))) / step)
    run = Experiment(name="run", data=pd.DataFrame({"driver_angle": read}, index=pd.Index(TIME, name="t")))
    driver, held = system_info("ccsrm").inputs[0], TIME[:-1:10] > 2.1
    means = _means(run, driver, 10)[:-1]
    assert np.mean(np.abs(np.diff(means[held])) < 1e-9) > 0.95  # rests end where noise hides their end
    assert means[held][0] == pytest.approx(0.3, abs=step)
    moving = (TIME[:-1:10] > 1.1) & (TIME[:-1:10] < 1.9)
    assert means[moving] == pytest.approx(np.interp(TIME[:-1:10] + 0.005, TIME, angle)[moving], abs=step)

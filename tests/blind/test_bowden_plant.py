"""The bench of two cables in sheaths against limits that need no second simulator."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from driving import rigs

import tendonlab as tl
from tendonlab.blind.description import Run, Scene
from tendonlab.blind.lanes import lanes_of, scene_of
from tendonlab.blind.plant import simulate
from tendonlab.blind.rig import Rig, draw_rig, full_truth, largest_amplitude
from tendonlab.blind.strength import tune
from tendonlab.blind.systems import BOWDEN_PAIR
from tendonlab.blind.systems.bowden_pair import TYPICAL, friction_level
from tendonlab.blind.write import record, write_dataset

PERIOD, HOLD = 0.005, 15.0  # s; N*m that the pretension of TYPICAL holds
BENT = TYPICAL["friction_coefficient"] * TYPICAL["wrap_angle"]
SMOOTH = {"sheath_viscous": 0.0}


def drive(torque: np.ndarray | float, velocity: np.ndarray | float, *, form: int = 0, **parameters: float) -> Run:
    """One lane from rest: ten samples without motion under the first torque, then what is given."""
    count = max(np.size(torque), np.size(velocity), 200)
    rows = [np.broadcast_to(np.asarray(signal, float), (count,)) for signal in (torque, velocity)]
    torque, velocity = (
        np.concatenate([np.full(10, row[0] * keep), row]) for row, keep in zip(rows, (1, 0), strict=True)
    )
    others = {"input_velocity": velocity[:, None]}
    scene = Scene(reference=torque[:, None], sample_time=PERIOD, num_settle=10, others=others)
    return simulate(rigs(BOWDEN_PAIR, TYPICAL | parameters, form=form), scene, step=PERIOD)


def last(torque: float, velocity: float, *, form: int = 0, **parameters: float) -> float:
    return float(drive(torque, velocity, form=form, **parameters).outputs[0, -1, 0])


def test_cables_without_friction_pass_all_torque():
    time = PERIOD * np.arange(400)
    torque, velocity = 12.0 * np.sin(3.0 * time), 0.5 * np.sin(1.7 * time)
    parameters = {"friction_coefficient": 0.0, "static_friction_coefficient": 0.0, "threshold_velocity": 1e-9}
    run = drive(torque, velocity, output_radius=0.04, threshold_slope=1e12, **parameters, **SMOOTH)
    slides = np.abs(velocity) > 0
    np.testing.assert_allclose(run.outputs[0, slides, 0], 0.8 * torque[slides], atol=1e-12)


@pytest.mark.parametrize("pretension", [150.0, 60.0])
def test_height_of_the_loop_is_that_of_the_capstan(pretension: float):
    """Sliding there and back the output differs by 2 P (1 - exp(-mu theta)), P = 2 r T_s  (S3 eq. 18)."""
    there, back = (last(4.0, sense, pretension=pretension, **SMOOTH) for sense in (0.6, -0.6))
    assert there + back == pytest.approx(8.0, rel=1e-9)
    assert back - there == pytest.approx(2.0 * HOLD * pretension / 150.0 * -np.expm1(-BENT), rel=2e-4)  # ten elements


@pytest.mark.parametrize(("torque", "passed"), [(40.0, np.exp(-BENT)), (-40.0, np.exp(BENT))])
def test_a_single_taut_cable_is_a_capstan(torque: float, passed: float):
    """Beyond what the pretension holds the other cable is loose: the ratio of tensions is exp(-+ mu theta)."""
    assert last(torque, 0.6, form=1, sheath_slack=1.0, **SMOOTH) == pytest.approx(torque * passed, rel=2e-4)


def test_slack_begins_at_the_torque_that_the_pretension_holds():
    level = HOLD * -np.expm1(-BENT)
    for torque, friction in ((14.0, level), (30.0, 2.0 * level)):
        assert torque - last(torque, 0.6, sheath_slack=1.0, **SMOOTH) == pytest.approx(friction, rel=2e-4)


@pytest.mark.parametrize(("skew", "gain"), [(1.0, 1.006767), (-1.0, 0.993279)])
@pytest.mark.parametrize("form", [0, 1])
def test_uneven_bends_change_the_gain(skew: float, gain: float, form: int):
    """As S3's eq. 18 gives it for linear curvature, and the other form for the same first moment."""
    parameters = {"wrap_angle": 3.6, "friction_coefficient": 0.056, "sheath_curvature_skew": skew, **SMOOTH}
    low, high = (last(torque, 0.6, form=form, **parameters) for torque in (0.0, 10.0))
    assert (high - low) / 10.0 - 1.0 == pytest.approx(gain - 1.0, rel=[0.01, 0.06][form])


def test_the_output_is_held_while_the_drive_rests():
    torque = np.concatenate([np.full(100, 5.0), np.linspace(5.0, -5.0, 200)])
    velocity = np.concatenate([np.full(100, 0.6), np.zeros(200)])
    run = drive(torque, velocity)
    np.testing.assert_allclose(run.outputs[0, 100:, 0], run.outputs[0, 99, 0], rtol=1e-5)  # h = exp(-20) a ms


@pytest.mark.parametrize("form", [0, 1])
def test_the_gate_is_half_open_at_its_threshold(form: int):
    """Over a millisecond half of the way is left, at other periods the like power of it."""
    velocity = np.full(200, TYPICAL["threshold_velocity"])
    run = drive(5.0, velocity, form=form, **SMOOTH)
    slid = 5.0 - friction_level(TYPICAL)
    assert (run.outputs[0, 0, 0] - slid) / (5.0 - slid) == pytest.approx(0.5**5, rel=5e-3)  # of ten elements


@pytest.mark.parametrize("form", [0, 1])
def test_bristles_bend_before_they_slip(form: int):
    """Far less than the breakaway turn: a spring. Far more: the level of the sheath."""
    level = friction_level(TYPICAL)
    run = drive(5.0, 0.1, form=form, sheath_bristle_stiffness=100.0, **SMOOTH)
    friction, turned = 5.0 - run.outputs[0, :, 0], run.state[0, :, 0]
    slope = [100.0, 100.0 * np.mean(1.0 / np.linspace(0.2, 1.8, 8))][form]
    assert friction[0] == pytest.approx(slope * turned[0], rel=0.01)
    assert friction[-1] == pytest.approx(level, rel=0.1)
    assert np.all(friction <= level * (1.0 + 1e-4))


def test_compliance_takes_the_motion_that_stretches_the_cables():
    torque = 5.0 + 20.0 * PERIOD * np.arange(200)
    run = drive(torque, 0.6, cable_compliance=1.0)
    compliance = TYPICAL["sheath_length"] / (2.0 * TYPICAL["cable_stiffness"] * TYPICAL["input_radius"] ** 2)
    slid = (run.state[0, -1, 0] - run.state[0, 100, 0]) / (99 * PERIOD)
    assert slid == pytest.approx(0.6 - 20.0 * compliance, rel=1e-9)


def test_drive_and_sensor():
    """Gain and offset of the torque, inertia of the drive, bias and delay of the reading."""
    time = PERIOD * np.arange(200)
    plain, given = drive(5.0, 0.6 + time), {"actuation_gain_error": 0.1, "actuation_offset": 0.3}
    changed = drive(5.0, 0.6 + time, actuation_drive_inertia=0.2, **given, **{"sensor.output_torque_bias": 0.7})
    np.testing.assert_allclose((changed.outputs - plain.outputs)[0, 5:-1, 0], 0.5 + 0.3 - 0.2 + 0.7, rtol=1e-6)
    late = drive(5.0 + time, 0.6, **{"sensor.output_torque_delay": 0.013}).outputs[0, 20:, 0]
    np.testing.assert_allclose(late, drive(5.0 + time, 0.6).outputs[0, 20:, 0] - 0.013, rtol=1e-9)


def drawn(effect: str, *, kind: str = "effect", seed: int = 4, form: int = 0) -> Rig:
    draw = np.random.default_rng(seed)
    rig = draw_rig(draw, effect=effect, kind=kind, system=BOWDEN_PAIR, excitation="rich", has_repeats=False)
    return replace(rig, form=form)


@pytest.mark.parametrize("effect", BOWDEN_PAIR.effects)
def test_every_effect_changes_the_logs_and_every_form_differs(effect: str):
    rig = drawn(effect)
    others = [replace(rig, form=form) for form in range(len(rig.forms))]
    cases = [(rig, 0.0), *((other, 0.5 * largest_amplitude(rig)) for other in others)]
    rows, truths = [case for case, _ in cases], [full_truth(case, amplitude) for case, amplitude in cases]
    quiet = [False] * len(rows)
    run = simulate(lanes_of(rows, truths, is_noisy=quiet), scene_of(rows, is_noisy=quiet), step=0.002, stride=5)
    found = np.split(run.outputs[0], len(rows), axis=1)
    for i, one in enumerate(found):
        assert all(np.sqrt(np.mean((one - other) ** 2)) > 0.01 for other in found[:i])
    scene = scene_of(rows[-1:], is_noisy=[False])
    alone = simulate(lanes_of(rows[-1:], truths[-1:], is_noisy=[False]), scene, stride=5)
    np.testing.assert_array_equal(alone.outputs[0], found[-1])  # whoever else is simulated


def test_constants_of_drive_and_sensor_are_twins():
    """Cables of equal pulleys pass a constant on as it is."""
    rig = drawn("actuation:offset")
    truths = [rig.truth | {name: 0.3} for name in ("actuation_offset", "sensor.output_torque_bias")]
    scene = scene_of([rig, rig], is_noisy=[False, False])
    run = simulate(lanes_of([rig, rig], truths, is_noisy=[False, False]), scene, step=0.002)
    one, other = np.split(run.outputs[0], 2, axis=1)
    np.testing.assert_allclose(one, other, atol=1e-9)
    assert BOWDEN_PAIR.twins("actuation:offset", rig.outputs) == ("sensor.output_torque:bias",)
    assert BOWDEN_PAIR.twins("sheath:coulomb", rig.outputs) == ()


@pytest.mark.parametrize("excitation", ["rich", "poor"])
def test_a_rig_that_lacks_nothing_is_explained_to_its_noise(excitation: str, tmp_path: Path):
    draw = np.random.default_rng(6)
    rig = draw_rig(draw, effect="", kind="none", system=BOWDEN_PAIR, excitation=excitation)
    (strength,), folder = tune([rig]), tmp_path / "rig"
    (run,) = record([rig], [strength])
    write_dataset(rig, run, folder, name="rig", description="")
    dataset = tl.load(folder)
    assert dataset.kind == "bowden_pair"
    errors = [
        experiment.data["output_torque"].to_numpy() - dataset.system().simulate(experiment)["output_torque"].to_numpy()
        for experiment in dataset.experiments
    ]
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(strength.floor[0], rel=0.1)


def test_the_bench_lacks_what_the_library_knows_and_the_logs_can_show():
    """A loss of pretension hides in the friction coefficient, a play in torque needs a load that gives way."""
    known = {effect.name for effect in tl.system_info("bowden_pair").effects}
    nominal = {"sheath:velocity_gate", "sheath:capstan"}
    hidden = {"sheath:pretension_loss", "sheath:distributed_presliding"}
    assert set(BOWDEN_PAIR.effects) == known - nominal - hidden


def test_runs_differ_by_pretension_and_bends():
    rig = drawn("")
    assert {tuple(experiment.add) for experiment in rig.experiments} >= {(), ("pretension",), ("wrap_angle",)}
    assert [experiment.split for experiment in rig.experiments].count("test") == 3
    assert all(experiment.others["input_velocity"][0] == 0.0 for experiment in rig.experiments)

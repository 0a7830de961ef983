"""The joint on two cables against limits that need no second simulator, and against the library."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from driving import rigs

import tendonlab as tl
from tendonlab.blind.description import Run, Scene
from tendonlab.blind.lanes import lanes_of, scene_of
from tendonlab.blind.plant import simulate
from tendonlab.blind.rig import Rig, draw_rig, full_truth, largest_amplitude
from tendonlab.blind.strength import tune
from tendonlab.blind.systems import CABLE_JOINT
from tendonlab.blind.systems.cable_joint import TYPICAL
from tendonlab.blind.write import record, write_dataset

PERIOD, SETTLE = 0.01, 50  # s, samples
RADIUS, STIFFNESS, PRELOAD = 0.065, 272e3, 200.0
DAMPED = TYPICAL["cable_damping"] / STIFFNESS  # s
SMOOTH = {name: 0.0 for name in TYPICAL if name.startswith("bushing")}
FREE = SMOOTH | {"gravity": 0.0, "joint_viscous": 0.0}
ANGLE, VELOCITY, ONE, TWO = range(4)
USUAL = np.array([1.2e-5, 1.8e-3, 1.5, 1.5])  # noise of the outputs


def wind(nut: np.ndarray, *, form: int = 0, **parameters: float) -> Run:
    """One lane from rest whose nuts go as given, m/s."""
    reference = np.concatenate([np.zeros(SETTLE), nut])[:, None]
    scene = Scene(reference=reference, sample_time=PERIOD, num_settle=SETTLE)
    return simulate(rigs(CABLE_JOINT, TYPICAL | parameters, form=form), scene, step=2.5e-3)


def there(angle: float, *, seconds: float = 2.0, rest: float = 1.0) -> np.ndarray:
    """Nuts that carry the joint to an angle at an even speed, and rest."""
    count = round(seconds / PERIOD)
    nut = np.full(count + 1, RADIUS * np.sin(angle) / seconds)
    nut[[0, -1]] = 0.0
    nut[1:-1] *= count / (count - 1)  # straight lines between samples: half of the first and of the last are missing
    return np.concatenate([nut, np.zeros(round(rest / PERIOD))])


def last(nut: np.ndarray, **parameters: float) -> np.ndarray:
    return wind(nut, **parameters).outputs[:, -1, 0]


def test_cables_hold_the_weight_at_rest():
    """F_1 - F_2 = -tau_g / r = 22.70 N where the base is level (S2, check B7)."""
    read = last(np.zeros(20), mounting_angle=0.0, gravity=9.80665, **SMOOTH)
    assert read[ONE] - read[TWO] == pytest.approx(22.70, abs=5e-3)
    assert read[ONE] + read[TWO] == pytest.approx(2.0 * PRELOAD)
    np.testing.assert_allclose(read[: VELOCITY + 1], 0.0, atol=1e-12)


def test_without_loads_the_joint_follows_the_nuts():
    read = wind(there(0.5), **FREE).outputs[:, :, 0]
    nut = PERIOD * np.cumsum(there(0.5))
    np.testing.assert_allclose(RADIUS * np.sin(read[ANGLE, 300]), nut[-1], rtol=1e-4)


def test_what_a_load_stretches_comes_at_the_rate_of_the_cables():
    """After the nuts stop the joint goes on towards its equilibrium as exp(-K t/c)."""
    read = wind(there(0.5, rest=1.5), **SMOOTH).outputs[VELOCITY, 205:, 0]
    assert read[40] / read[0] == pytest.approx(np.exp(-40 * PERIOD / DAMPED), rel=0.02)


@pytest.mark.parametrize(("angle", "friction"), [(-0.8, (21.9, -69.4)), (0.1, (30.0, -31.6)), (0.4, (42.1, -36.7))])
def test_height_of_the_loops_is_that_of_the_branches(angle: float, friction: tuple[float, float]):
    """Half the difference of forces forwards and backwards, as S2's Table II gives it."""
    way = there(angle, rest=0.0)
    run = wind(np.concatenate([way, -way]), gravity=0.0)
    before, after = run.outputs[ONE:, [len(way) - 3, len(way) + 2], 0].T
    np.testing.assert_allclose(
        np.sign(angle) * 0.5 * (before - after), friction, atol=0.7
    )  # angles are a little short of it


@pytest.mark.parametrize("side", [1, 2])
@pytest.mark.parametrize(
    ("law", "level"),
    [
        ("coulomb", 0.5),
        ("viscous", 0.5 * RADIUS * np.cos(0.4) * 0.2),
        ("sine_coefficient", 2.0 * 0.5 * PRELOAD * np.sin(0.2)),
        ("capstan_coefficient", PRELOAD * np.expm1(0.5 * 0.4)),
    ],
)
def test_bushings_resist_the_run_of_their_cable(side: int, law: str, level: float):
    way = np.full(230, RADIUS * np.cos(0.4) * 0.2)  # at 0.4 rad after a little more than 2 s
    plain, rubbed = (wind(way, **SMOOTH | added) for added in ({}, {f"bushing_{side}_{law}": 0.5}))
    k = np.argmin(np.abs(plain.outputs[ANGLE, :, 0] - 0.4))
    found = (rubbed.outputs - plain.outputs)[ONE:, k, 0]
    speed = plain.outputs[VELOCITY, k, 0] / 0.2 if law == "viscous" else 1.0
    np.testing.assert_allclose(found, np.eye(2)[side - 1] * (3 - 2 * side) * level * speed, rtol=0.01, atol=1e-9)


def test_friction_that_holds_jumps_when_the_nuts_start():
    """S2 fig. 12: without stiction the forces jump as the nuts stop, with it at the next start."""
    moves = np.concatenate([there(0.3), -there(0.3)])
    loose, held = (wind(moves, stiction_hold=share).outputs[ONE, :, 0] for share in (0.0, 1.0))
    jumps = [int(np.argmax(np.abs(np.diff(force)) > 30.0)) for force in (loose[150:], held[150:])]
    assert (jumps[0] + 150) == pytest.approx(200, abs=2)
    assert (jumps[1] + 150) == pytest.approx(301, abs=2)
    fading = wind(moves, form=1, stiction_hold=1.0).outputs[ONE, 290, 0]
    assert loose[290] < fading < held[290]


def test_paths_that_grow_add_to_both_cables_and_brake_the_joint():
    """Without a load: (F_1 - F_2) r cos(theta) = (F_1 + F_2) P/K sin(theta)."""
    read = last(there(0.5, rest=2.0), **FREE, cable_preload_variation=60.0)
    turned = read[ANGLE]
    assert 0.5 * (read[ONE] + read[TWO]) == pytest.approx(PRELOAD + 60.0 * (1.0 - np.cos(turned)), rel=1e-5)
    brake = (read[ONE] + read[TWO]) * 60.0 / STIFFNESS * np.sin(turned)
    assert (read[ONE] - read[TWO]) * RADIUS * np.cos(turned) == pytest.approx(brake, rel=1e-3)


@pytest.mark.parametrize(("form", "share"), [(0, np.sqrt(PRELOAD / 600.0)), (1, -np.expm1(-PRELOAD / 200.0))])
def test_fibres_are_soft_below_their_toe(form: int, share: float):
    """A small load turns the joint by load / (2 K' r^2), K' = K sqrt(T/F_s) or K (1 - exp(-3 T/F_s))."""
    run = wind(np.zeros(100), form=form, **FREE, cable_toe_tension=600.0, load_offset=0.01)
    assert run.outputs[ANGLE, -1, 0] == pytest.approx(0.01 / (2.0 * STIFFNESS * share * RADIUS**2), rel=1e-3)


@pytest.mark.parametrize("form", [0, 1])
def test_a_gear_that_ripples_passes_on_as_many_turns(form: int):
    """A turn of the screw takes p/w / sqrt(1 - a^2) at the documented form; its velocity goes with the angle."""
    speed = 0.01
    nut = np.concatenate([[0.0], np.full(400, speed)])
    run = wind(nut, form=form, **FREE, gear_ripple_sine=0.2, gear_ripple_cosine=0.1)
    travel = RADIUS * np.sin(run.outputs[ANGLE, :, 0])
    took = np.diff(np.interp([0.005, 0.010, 0.015], travel, run.time))
    if form == 0:
        np.testing.assert_allclose(took, 0.005 / speed / np.sqrt(1.0 - 0.05), rtol=1e-3)
    turned, velocity = 2.0 * np.pi * travel / 0.005, np.gradient(travel, PERIOD)
    wave = 0.2 * (np.sin(turned) + 0.35 * form * np.sin(2 * turned))
    wave += 0.1 * (np.cos(turned) + 0.35 * form * np.cos(2 * turned))
    np.testing.assert_allclose(velocity[5:-5], speed * (1.0 + wave)[5:-5], rtol=0.01)


def drawn(effect: str, *, kind: str = "effect", excitation: str = "rich", num_samples: int | None = None) -> Rig:
    rig = draw_rig(
        np.random.default_rng(4),
        effect=effect,
        kind=kind,
        system=CABLE_JOINT,
        excitation=excitation,
        num_samples=num_samples,
        has_repeats=False,
    )
    return replace(rig, form=0, outputs=CABLE_JOINT.output_names)


def clean(rows: list[Rig], truths: list[dict[str, float]], *, step: float = 2.5e-3) -> Run:
    quiet = [False] * len(rows)
    return simulate(lanes_of(rows, truths, is_noisy=quiet), scene_of(rows, is_noisy=quiet), step=step)


@pytest.mark.parametrize("effect", CABLE_JOINT.effects)
def test_every_effect_changes_the_logs_and_every_form_differs(effect: str):
    rig = drawn(effect)
    rig = replace(rig, experiments=rig.experiments[:4])
    others = [replace(rig, form=form) for form in range(len(rig.forms))]
    cases = [(rig, 0.0), *((other, 0.5 * largest_amplitude(rig)) for other in others)]
    rows, truths = [case for case, _ in cases], [full_truth(case, amplitude) for case, amplitude in cases]
    found = np.split(clean(rows, truths).outputs, len(rows), axis=2)
    for i, one in enumerate(found):
        spread = [np.sqrt(np.mean((one - other) ** 2, axis=(1, 2))) / USUAL for other in found[:i]]
        assert all(np.max(ratio) > 0.05 for ratio in spread)
    np.testing.assert_array_equal(clean(rows[-1:], truths[-1:]).outputs, found[-1])  # whoever else is simulated


def test_fine_and_coarse_steps_agree():
    rig = drawn("", kind="none")
    rig = replace(rig, experiments=rig.experiments[:1])
    coarse, fine = (clean([rig], [rig.truth], step=step).outputs for step in (2.5e-3, 1e-3))
    assert np.all(np.sqrt(np.mean((coarse - fine) ** 2, axis=(1, 2))) < 0.1 * USUAL)


@pytest.mark.parametrize("effect", ["", *CABLE_JOINT.effects])
def test_the_library_runs_alike_without_noise(effect: str):
    """The documented form of every effect, but for instants at which friction at rest turns its sense."""
    rig = drawn(effect, kind="effect" if effect else "none")
    truth, runs = full_truth(rig, 1.0), rig.experiments[:2]
    run = clean([replace(rig, experiments=runs)], [truth])
    contained = [name for name in CABLE_JOINT.nominal_effects if name != effect] + [effect] * bool(effect)
    dry = effect in ("joint:coulomb", "joint:load_dependence")  # a joint that sticks: forces are compared in motion
    for lane, experiment in enumerate(runs):
        values = {name: value + experiment.add.get(name, 0.0) for name, value in truth.items()}
        system = tl.System(kind="cable_joint", parameters=values, effects=contained)
        read = dict(zip(CABLE_JOINT.output_names, run.outputs[:, :, lane], strict=True))  # which tell how it begins
        log = pd.DataFrame({"actuator_velocity": experiment.reference, **read}, index=pd.Index(run.time, name="t"))
        other = system.simulate(log)
        for i, name in enumerate(CABLE_JOINT.output_names):
            left = np.abs(run.outputs[i, :, lane] - np.asarray(other[name])) / USUAL[i]
            left = left[np.abs(run.outputs[VELOCITY, :, lane]) > 1e-6] if dry else left
            assert np.quantile(left, 0.95) < (0.5 if effect == "gear:ripple" else 0.2)


@pytest.mark.parametrize("excitation", ["rich", "poor"])
def test_a_rig_that_lacks_nothing_is_explained_to_its_noise(excitation: str, tmp_path: Path):
    rig = drawn("", kind="none", excitation=excitation, num_samples=300)
    (strength,), folder = tune([rig]), tmp_path / "rig"
    (run,) = record([rig], [strength], step=1e-3)
    write_dataset(rig, run, folder, name="rig", description="")
    dataset = tl.load(folder)
    assert dataset.kind == "cable_joint"
    for name, floor in zip(CABLE_JOINT.output_names, strength.floor, strict=True):
        errors = [e.data[name].to_numpy() - dataset.system().simulate(e)[name].to_numpy() for e in dataset.experiments]
        assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(floor, rel=0.1)


def test_the_joint_lacks_what_the_library_knows_and_nuts_that_are_driven_can_show():
    """Motor and gear idle, bushings have their branches, and a joint without dry friction has little to refine."""
    known = {effect.name for effect in tl.system_info("cable_joint").effects}
    idle = {name for name in known if name.startswith(("motor:", "actuation:", "sensor.motor_velocity:"))}
    nominal = {"gear:arctan", "bushing_1:bushing_branches", "bushing_2:bushing_branches"}
    structural = {"winding:winding", "cable:taut_compliance"}
    hidden = {"joint:presliding", "joint:stribeck", "joint:asymmetry"}
    assert set(CABLE_JOINT.effects) == known - idle - nominal - structural - hidden


def test_runs_differ_by_preload_and_payload_and_begin_at_rest():
    rig = drawn("")
    assert {tuple(experiment.add) for experiment in rig.experiments} >= {(), ("pretension",), ("link_2_mass",)}
    assert [experiment.split for experiment in rig.experiments].count("test") == 3
    assert all(experiment.reference[0] == 0.0 for experiment in rig.experiments)

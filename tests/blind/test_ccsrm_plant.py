"""The coupled joints of the generator against limits that need no second simulator, and against the library."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import driving
import numpy as np
import pytest
from driving import rigs

import tendonlab as tl
from tendonlab.blind.description import Lanes
from tendonlab.blind.lanes import lanes_of, scene_of
from tendonlab.blind.plant import simulate
from tendonlab.blind.rig import Rig, draw_rig, full_truth, largest_amplitude
from tendonlab.blind.strength import tune
from tendonlab.blind.systems import CCSRM
from tendonlab.blind.write import record, write_dataset

K, T_P, R, WRAP, J, MU = 5e4, 50.0, 0.012, 1.69, 0.01, 0.16
OWN = {
    "cable_stiffness": K,
    "pretension": T_P,
    "pulley_radius": R,
    "initial_wrap_angle": WRAP,
    "joint_inertia": J,
}
BRISTLES = {"contact_bristle_stiffness": 1e6, "contact_bristle_damping": 1e3}
CONTACTS = {"contact_kinetic": MU, "cable_viscous": 1e3, **BRISTLES}  # damped, so that it soon slides steadily
JOINT, T12, T21, T22 = range(4)


def lanes(num_lanes: int = 1, *, form: int = 0, effect: str = "", **parameters: float | np.ndarray) -> Lanes:
    return replace(
        rigs(CCSRM, OWN | parameters, num_lanes=num_lanes, form=form), effect=(effect,) * num_lanes if effect else ()
    )


held = partial(driving.push, step=1e-4)  # the driver rests at an angle


def at(position: float, velocity: float = 0.0) -> np.ndarray:
    return np.array([[position], [velocity]])


def turns(run_time: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Instants at which the speed changes sign, between samples."""
    i = np.flatnonzero(speed[:-1] * speed[1:] < 0)
    return run_time[i] + (run_time[i + 1] - run_time[i]) * speed[i] / (speed[i] - speed[i + 1])


@pytest.mark.parametrize("compliance", [0.0, 0.25 / K])
def test_without_friction_joint_1_swings_on_the_sections_in_series(compliance: float) -> None:
    """Each cable: its middle section, and where they stretch its two ends; omega^2 = 2 k r^2 / J."""
    run = held(lanes(ends_compliance=compliance), 0.1, seconds=0.8, initial=at(0.08))
    found = np.diff(turns(run.time, run.state[1, :, 0])).mean()
    series = 1.0 / (1.0 / K + 2.0 * compliance)
    assert np.pi / found == pytest.approx(np.sqrt(2.0 * series * R**2 / J), rel=1e-4)  # (omega h)^2/24 ~ 1e-6
    assert np.ptp(run.state[0, -200:, 0]) == pytest.approx(0.04, rel=1e-2)


@pytest.mark.parametrize("eccentric", [0.0, 0.04])
def test_energy_is_conserved_without_friction(eccentric: float) -> None:
    """Of an eccentric pulley as well: its lever is the slope of the cable that it winds."""
    rig = lanes(eccentric=eccentric, eccentric_phase=0.7)
    run = held(rig, 0.0, seconds=2.0, initial=at(0.05))
    q, v = run.state[:, :, 0]
    longer = -R * (q + eccentric * (np.sin(q + 0.7) - np.sin(0.7)))
    energy = 0.5 * J * v**2 + K * longer**2
    assert np.ptp(energy) < 2e-3 * energy[0]  # omega h = 4e-3, and bounded


@pytest.mark.parametrize(
    "friction",
    [
        {"joint_viscous": 0.03},
        {"joint_coulomb": 0.05},
        {"contact_viscous": 400.0},
        {"cable_viscous": 300.0},
        {"contact_viscous": 400.0, "ends_compliance": 0.2 / K},
    ],
)
@pytest.mark.parametrize("form", [0, 1])
def test_friction_only_takes_energy(friction: dict[str, float], form: int) -> None:
    effect = next(iter(friction)).replace("_", ":", 1)
    run = held(lanes(form=form, effect=effect, **friction), 0.0, seconds=0.3, initial=at(0.05))
    q, v = run.state[:, :, 0]
    energy = 0.5 * J * v**2 + K * (R * q) ** 2
    if "ends_compliance" in friction or ("cable_viscous" in friction and form):  # they store some that is not seen
        energy = np.array([part.max() for part in np.array_split(0.5 * J * v**2, 3)])
    assert np.all(np.diff(energy) < 1e-3 * energy[0])
    assert energy[-1] < 0.8 * energy[0]


@pytest.mark.parametrize("ends", [0.0, 0.2 / K])
def test_swings_on_dry_contacts_die_out(ends: float) -> None:
    """Bristles give back less than they took: each turn is nearer to the rest, where the bristles hold it."""
    run = held(lanes(contact_kinetic=MU, **BRISTLES, ends_compliance=ends), 0.0, seconds=0.7, initial=at(0.06))
    q, v = run.state[:, :, 0]
    i = np.flatnonzero(v[:-1] * v[1:] < 0)
    swing = np.abs(np.diff(q[i]))
    assert len(swing) > 3
    assert np.all(swing[2:] < swing[:-2])  # there and back
    assert swing[-1] < 0.3 * swing[0]


def ramp(rig: Lanes, *, speed: float, seconds: float = 3.0, **scene: np.ndarray) -> driving.Run:
    time = np.arange(round(seconds / 0.002)) * 0.002
    angle = speed * np.where(time < 0.5, time**2, time - 0.25)[:, None]
    return simulate(rig, driving.Scene(reference=np.repeat(angle, rig.size, axis=1), **scene), step=5e-4)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_cable_slides_by_the_capstan_ratio(sign: float) -> None:
    """T21/T22 is exp(-mu wrap sign v) at the wrap angle of the moment, and joint 1 lags by T_p tanh(mu wrap)/(k r)."""
    run = ramp(lanes(**CONTACTS), speed=0.05 * sign)
    angle = run.state[0, -200:, 0]
    ratio = run.outputs[T21, -200:, 0] / run.outputs[T22, -200:, 0]
    np.testing.assert_allclose(ratio, np.exp(-MU * (WRAP - angle) * sign), rtol=4e-4)  # bristles lag by 18 ms
    lag = run.command[-200:, 0] - angle
    np.testing.assert_allclose(lag, sign * T_P * np.tanh(MU * WRAP) / (K * R), rtol=2e-3)
    np.testing.assert_allclose(run.outputs[T12] + run.outputs[T22], 2 * T_P, rtol=1e-12)


@pytest.mark.parametrize("form", [0, 1])
def test_coefficients_that_differ_by_direction(form: int) -> None:
    rig = lanes(**CONTACTS, contact_asymmetry=0.1, form=form, effect="contact:asymmetry")
    found = []
    for sign in (1.0, -1.0):
        run = ramp(rig, speed=0.05 * sign, seconds=2.0)
        wrap = WRAP - run.state[0, -1, 0]
        found.append(-sign * np.log(run.outputs[T21, -1, 0] / run.outputs[T22, -1, 0]) / wrap)
    share = 0.1 * (1.0 + form * 0.3 * 0.0006 / 0.0106)
    np.testing.assert_allclose(found, [MU * (1 + share), MU * (1 - share)], rtol=1e-3)


def test_every_contact_of_elastic_ends_slides_by_the_capstan_ratio() -> None:
    rig = lanes(contact_kinetic=MU, contact_viscous=1.0, joint_viscous=0.3, **BRISTLES, ends_compliance=0.2 / K)
    run = ramp(rig, speed=0.1, seconds=1.2)
    ratio = run.outputs[T21, -100:, 0] / run.outputs[T22, -100:, 0]
    np.testing.assert_allclose(ratio, np.exp(-MU * (WRAP - run.state[0, -100:, 0])), rtol=1e-3)


def test_ends_that_hardly_stretch_are_like_rigid_ones() -> None:
    """Of both forms: a ten-thousandth of the middle section's compliance."""
    own = {"contact_kinetic": MU, **BRISTLES}
    rigid = ramp(lanes(**own, contact_viscous=400.0), speed=0.3, seconds=0.7)
    for form in (0, 1):
        rig = lanes(**own, contact_viscous=400.0, ends_compliance=1e-4 / K, form=form, effect="ends:compliance")
        soft = ramp(rig, speed=0.3, seconds=0.7)
        assert np.abs(soft.outputs[0] - rigid.outputs[0]).max() < 5e-5
        assert np.abs(soft.outputs[1:] - rigid.outputs[1:]).max() < 0.15  # one step later at the reversal of 10 N


def test_sticking_joint_is_exact_below_the_level() -> None:
    run = held(
        lanes(2, joint_coulomb=0.05), np.array([0.0499, 0.0501]) / (2 * K * R**2), seconds=0.3, initial=np.zeros((2, 2))
    )
    assert np.all(run.state[0, :, 0] == 0.0)
    assert run.state[0, -1, 1] > 0.0


def test_sensors_are_late_and_biased() -> None:
    late = {f"sensor.{name}_delay": 0.0053 for name in CCSRM.output_names}
    bias = {"sensor.tension_22_bias": 1.5, "sensor.joint_angle_bias": -0.01}
    own = {**CONTACTS, "contact_viscous": 400.0}
    true, read = (ramp(lanes(**own, **more), speed=0.3, seconds=1.0) for more in ({}, late | bias))
    then = true.time - 0.0053
    for i, size in enumerate((1e-5, 0.1, 0.1, 0.1)):  # the tension bends within a sample
        shifted = np.interp(then, true.time, true.outputs[i, :, 0])[10:]
        more = bias.get(f"sensor.{CCSRM.output_names[i]}_bias", 0.0)
        np.testing.assert_allclose(read.outputs[i, 10:, 0], shifted + more, atol=size)


def case(effect: str, *, kind: str = "effect", num_samples: int = 300) -> Rig:
    return draw_rig(
        np.random.default_rng(5), effect=effect, kind=kind, system=CCSRM, excitation="rich", num_samples=num_samples
    )


@pytest.mark.parametrize("effect", CCSRM.effects)
def test_every_effect_changes_the_logs_in_all_its_forms(effect: str) -> None:
    rig = replace(case(effect), num_settle=20)
    rig = replace(rig, experiments=rig.experiments[:2])
    logs = []
    for form in range(len(rig.forms)):
        one = replace(rig, form=form)
        truths = [full_truth(one, share * largest_amplitude(one)) for share in (0.0, 0.25, 0.5)]
        run = simulate(
            lanes_of([one] * 3, truths, is_noisy=[False] * 3), scene_of([one] * 3, is_noisy=[False]), step=1e-3
        )
        none, little, much = np.split(run.outputs / CCSRM.column("coloured")[:, None, None], 3, axis=2)
        assert np.std(much - none) > 0.3
        assert np.std(little - none) > 0.0
        logs.append(much)
    for other in logs[1:]:
        assert np.std(other - logs[0]) > 1e-3


def test_the_effects_are_those_of_the_library() -> None:
    known = {effect.name for effect in tl.system_info("ccsrm").effects}
    assert {*CCSRM.effects, *CCSRM.nominal_effects} <= known


def test_the_library_explains_a_rig_that_lacks_nothing_to_the_floor(tmp_path: Path) -> None:
    rig = case("", kind="none", num_samples=480)
    rig = replace(rig, experiments=rig.experiments[:4], outputs=CCSRM.output_names)
    (strength,) = tune([rig])
    (run,) = record([rig], [strength])
    write_dataset(rig, run, tmp_path / "rig", name="rig", description="test")
    dataset = tl.load(tmp_path / "rig")
    nominal = dataset.system()
    left = []
    for experiment in dataset.experiments:
        told = nominal.simulate(experiment)
        left.append([np.mean((experiment.data[name] - told[name]) ** 2) for name in CCSRM.output_names])
    assert np.all(np.sqrt(np.mean(left, axis=0)) < 1.3 * strength.floor)

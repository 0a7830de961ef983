"""Causes that the library lacks, each by what sets it apart."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import numpy as np
import pytest

from tendonlab.blind import unknown
from tendonlab.blind.description import Lanes, Run, Scene
from tendonlab.blind.lanes import lanes_of, scene_of
from tendonlab.blind.planning import plan
from tendonlab.blind.plant import simulate
from tendonlab.blind.rig import draw_rig, full_truth, largest_amplitude, nominal_effects
from tendonlab.blind.strength import tune
from tendonlab.blind.systems import RIGID_JOINT, SYSTEMS, TWO_INERTIA
from tendonlab.blind.write import sealed_toml

INERTIA = 0.05


def push(torque: np.ndarray, *, angle: float | np.ndarray = 0.0, speed: float = 0.0, **stated: float) -> Run:
    """A rigid joint under torques over time, (samples, lanes), from a position and a speed."""
    count = torque.shape[1]
    values = {"joint_inertia": INERTIA, **stated}
    rig = Lanes(
        system=RIGID_JOINT,
        parameters={name: np.full(count, value) for name, value in values.items()},
        scale=np.ones((1, count)),
        form=np.zeros(count, dtype=int),
    )
    start = np.stack([np.broadcast_to(angle, count), np.full(count, speed)]).astype(float)
    return simulate(rig, Scene(reference=torque, initial=start), step=2e-4)


def test_a_bump_holds_where_it_is_and_nowhere_else() -> None:
    """0.15 N*m of dry friction, and half as much again at 0.2 rad: 0.2 N*m moves the joint but there."""
    stated = {"joint_coulomb": 0.15, "bump": 0.5, "bump_angle": 0.2, "bump_width": 0.1}
    run = push(np.full((20, 3), 0.2), angle=np.array([-0.2, 0.2, 0.6]), **stated)
    assert (run.state[1, -1] > 0).tolist() == [True, False, True]


def test_a_stop_returns_the_energy_that_it_took() -> None:
    """Free flight into the stop and back: the speed is reversed after half a period, pi sqrt(J/k)."""
    run = push(np.zeros((200, 1)), speed=1.0, stop_stiffness=20.0, stop_angle=0.1)
    speed = run.state[1, :, 0]
    assert speed[45] == 1.0
    assert speed[-1] == pytest.approx(-1.0, abs=1e-3)
    assert run.time[np.argmax(speed < 0)] == pytest.approx(0.1 + 0.5 * np.pi * np.sqrt(INERTIA / 20.0), abs=0.003)


def test_friction_is_stronger_the_longer_the_joint_rested() -> None:
    """0.15 N*m, up to twice as much; 0.25 N*m moves the joint after 20 ms of rest, and not after 600 ms."""
    torque = np.zeros((400, 2))
    torque[10:, 0], torque[300:, 1] = 0.25, 0.25
    run = push(torque, joint_coulomb=0.15, dwell=1.0, dwell_time=0.1, dwell_distance=0.002)
    assert (run.state[1, -1] > 0).tolist() == [True, False]


def test_a_motor_fades_under_load() -> None:
    """At the usual torque the heat is 1 - exp(-t/time): the speed falls short by share (t - time (1 - exp))."""
    run = push(np.full((500, 1), 0.5), fade=0.4, fade_time=0.5, fade_torque=0.5)
    t = run.time[-1]
    lost = 0.4 * (t - 0.5 * (1.0 - np.exp(-t / 0.5)))
    assert INERTIA * run.state[1, -1, 0] == pytest.approx(0.5 * (t - lost), rel=2e-3)  # held over 2 ms


def test_a_cable_creeps_to_a_softer_one() -> None:
    """Under a constant stretch it grows longer by share (1 - exp(-t/time)) of the stretch."""
    length = np.zeros(1)
    for _ in range(1000):
        length = unknown.creep(length, np.ones(1), share=np.array([0.3]), time=np.array([0.5]), step=1e-3)
    assert length[0] == pytest.approx(0.3 * (1.0 - np.exp(-2.0)))


def test_cold_friction_warms_up_over_the_session() -> None:
    rig = draw_rig(np.random.default_rng(1), effect="unknown:warming", kind="unknown", num_samples=20)
    truth = full_truth(rig, 0.5)
    scale = lanes_of([rig], [truth], is_noisy=[False]).scale
    assert scale[0] == pytest.approx(scale[1])
    assert scale[0, 0] == 1.5
    assert np.all(np.diff(scale[0]) < 0)
    starts = np.array([experiment.start for experiment in rig.experiments])
    np.testing.assert_allclose(scale[0], 1.0 + 0.5 * np.exp(-starts / truth["warming_time"]))


CASES = [(kind, cause) for kind, system in SYSTEMS.items() for cause in unknown.named(system.causes)]


@pytest.mark.parametrize(("system", "cause"), CASES)
def test_a_cause_changes_the_motion_and_grows_with_its_amplitude(system: str, cause: str) -> None:
    rig = draw_rig(
        np.random.default_rng(2),
        effect=cause,
        kind="unknown",
        system=SYSTEMS[system],
        excitation="rich",
        num_samples=400,
    )
    rig = replace(rig, num_settle=20, experiments=rig.experiments[:2])
    truths = [full_truth(rig, share * largest_amplitude(rig)) for share in (0.0, 0.1, 1.0)]
    rigs, quiet, step = [rig] * 3, [False] * 3, rig.sample_time / max(1, round(rig.sample_time / 5e-4))
    run = simulate(lanes_of(rigs, truths, is_noisy=quiet), scene_of(rigs, is_noisy=quiet), step=step)
    none, little, much = np.split(run.outputs, 3, axis=2)
    assert 0.0 < np.std(little - none) < np.std(much - none)
    assert nominal_effects(rig) == SYSTEMS[system].nominal_effects


def test_the_truth_names_the_cause_but_no_effect() -> None:
    rig = draw_rig(np.random.default_rng(2), effect="unknown:bump", kind="unknown", num_samples=20)
    (strength,) = tune([replace(rig, num_settle=5, experiments=rig.experiments[:3])])
    sealed = tomllib.loads(sealed_toml(rig, strength))
    assert (sealed["effects"], sealed["verdict"], sealed["accept"]) == ([], "unknown_effect", [])
    assert sealed["draw"]["cause"] == "bump"
    assert sealed["truth"]["bump"] == pytest.approx(strength.amplitude, rel=1e-6)


def test_unknown_causes_are_a_share_and_take_turns() -> None:
    cases = plan(3, 40, system="two_inertia", unknown_share=0.3)
    chosen = [case.effect for case in cases if case.kind == "unknown"]
    assert len(chosen) == 12
    assert {chosen.count(cause) for cause in unknown.named(TWO_INERTIA.causes)} == {2}
    assert [case.kind for case in cases].count("effect") == round(0.7 * 28)
    assert {case.kind for case in plan(3, 5, unknown_share=1.0)} == {"unknown"}
    assert not any("creep" in cause for cause in unknown.named(RIGID_JOINT.causes))
    with pytest.raises(ValueError, match=r"unknown_share = 1\.5"):
        plan(3, 5, unknown_share=1.5)


def test_no_cause_is_an_effect_of_the_library() -> None:
    effects = {effect.partition(":")[2] for system in (TWO_INERTIA, RIGID_JOINT) for effect in system.effects}
    assert effects.isdisjoint(unknown.LARGEST)

"""The error falls in proportion to the tolerance, over decades; what is off changes nothing, bit for bit."""

import numpy as np
import pandas as pd
import pytest

from integrate.rig import FRICTION, NOMINAL, controller, joint, pair, relative, run
from tendonlab import _core
from tendonlab.simulation.prepare import Replay, prepare
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.signals import smooth

T = np.linspace(0.0, 2.0, 401)
COMMAND = 0.06 * np.sin(2 * np.pi * T) + 0.03 * np.sin(2 * np.pi * 2.3 * T + 1.0)
BRISTLE = {
    "coulomb": 1.0, "viscous": 0.4, "joint_static_excess": 0.5, "joint_stribeck_velocity": 1e-3,
    "joint_bristle_stiffness": 1e5, "joint_bristle_damping": 300.0,
}  # fmt: skip
LUGRE = ("joint:coulomb", "joint:viscous", "joint:stribeck", "joint:presliding")
CASES = {
    "smooth": (pair(("motor:viscous", "joint:viscous"), motor_viscous=2e-4, joint_viscous=0.02), 0.5 * COMMAND, None),
    "stick and slip": (pair(NOMINAL, **FRICTION), COMMAND, None),
    "backlash": (pair((*NOMINAL, "cable:backlash"), **FRICTION, cable_backlash=0.01), COMMAND, None),
    "stribeck": (
        pair((*NOMINAL, "joint:stribeck"), **FRICTION, joint_static_excess=0.05, joint_stribeck_velocity=0.05),
        COMMAND, None,
    ),
    "bristle": (joint(LUGRE, **BRISTLE), 2.0 * np.sin(2 * np.pi * T), None),
    "loop": (pair(NOMINAL, **FRICTION), COMMAND, controller(smooth(T, 3.0 * np.sin(5.0 * T)), limit=0.08)),
    "late loop": (
        pair((*NOMINAL, "actuation:delay", "sensor.motor_angle:delay"), **FRICTION, actuation_delay=0.004,
             sensor__motor_angle_delay=0.003), COMMAND, controller(smooth(T, 3.0 * np.sin(5.0 * T))),
    ),
}  # fmt: skip
TOLERANCES = np.array([1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9])


@pytest.mark.parametrize("case", CASES)
def test_error_falls_in_proportion_to_the_tolerance(case):
    system, command, loop = CASES[case]
    best = run(system, T, command, loop=loop, tolerance=1e-13).table
    errors = []
    for tolerance in TOLERANCES:
        found = run(system, T, command, loop=loop, tolerance=tolerance).table
        errors.append(max(relative(a, b) for a, b in zip(found, best, strict=True)))
    if case == "late loop":  # the delay bounds each step: looser tolerances do not make it longer
        assert np.all(np.array(errors) < 10.0 * TOLERANCES), errors
        assert errors[-1] < 0.01 * errors[0], errors
        return
    slope = np.polyfit(np.log10(TOLERANCES), np.log10(errors), 1)[0]
    assert 0.8 < slope < 1.3, errors
    # the error of a run is the errors of its steps added up: not more than a hundred or so of them at the worst spots
    assert np.all(np.array(errors) < 300.0 * TOLERANCES), errors


def test_a_decade_of_tolerance_costs_its_fifth_root_in_steps():
    """Order five, under an input without knots."""
    system, _, _ = CASES["smooth"]
    attempts = np.array([run(system, T, 0.05, tolerance=t).attempts for t in TOLERANCES])
    assert -np.polyfit(np.log10(TOLERANCES), np.log10(attempts), 1)[0] < 0.2
    # from 1e-5 on, where steps are short enough to tell the order
    assert np.all(attempts[2:] < 10**0.2 * 1.05 * attempts[1:-1])


def test_inputs_straight_between_samples_need_about_a_step_a_sample():
    """Their slope jumps at every sample. Steps that pass one fail: after that, steps end there."""
    command = COMMAND + 0.01 * np.random.default_rng(0).standard_normal(len(T))
    for case in ("smooth", "stick and slip"):
        system = CASES[case][0]
        best = run(system, T, command, kind="linear", tolerance=1e-12)
        done = run(system, T, command, kind="linear", tolerance=1e-6)
        assert done.attempts < 1.5 * len(T) + 20 * done.events
        assert max(relative(a, b) for a, b in zip(done.table, best.table, strict=True)) < 3e-5


def test_few_attempts_are_rejected():
    for system, command, loop in CASES.values():
        done = run(system, T, command, loop=loop, tolerance=1e-6)
        assert done.rejected < 0.3 * done.attempts + 20


def test_few_attempts_are_rejected_before_a_breakaway():
    """The steps that the error allows grow shorter one by one: the stepper foresees the next."""
    for tolerance in (1e-4, 1e-5, 1e-6):
        done = run(CASES["bristle"][0], T, 1.2 * T, tolerance=tolerance)
        assert done.rejected < 0.15 * done.attempts


def test_few_attempts_are_rejected_where_a_stiff_damper_settles():
    """At each corner of the command the error hardly falls with the step, until the step resolves how the cable
    settles."""
    system = pair(("motor:viscous", "joint:viscous"), motor_viscous=2e-4, joint_viscous=0.02, cable_damping=50.0)
    corners = np.linspace(0.0, 2.0, 201)
    command = 0.005 * np.cumsum(np.random.default_rng(0).standard_normal(len(corners)))
    done = run(system, corners, command, kind="linear", tolerance=1e-6)
    assert done.rejected < 0.4 * done.attempts


def test_a_reversal_costs_the_force_of_a_stiff_bristle_no_accuracy():
    """At any tolerance: whether a step passes the reversal by much or by little is chance. (Above 1e-4 the force inside
    the long step before the reversal may be off by 30 tolerances.)"""
    samples = np.linspace(0.0, 1.0, 1001)
    tolerances = 10.0 ** -np.arange(4.0, 7.0, 0.25)

    def force(tolerance):
        done = run(CASES["bristle"][0], samples, 2.0 * np.sin(2 * np.pi * samples), tolerance=tolerance, ports=True)
        return done.ports["joint"][3]

    best = force(1e-12)
    errors = np.array([relative(force(tolerance), best) for tolerance in tolerances])
    assert np.all(errors < 3.0 * tolerances), errors / tolerances


def test_few_attempts_are_rejected_where_noise_bends_a_smooth_input():
    """The curvature of parabolas with given means jumps at every sample: steps end there rather than fail beyond."""
    time = np.linspace(0.0, 10.0, 1001)
    noisy = 0.5 * np.sin(np.pi * time) + 0.2 * np.random.default_rng(0).standard_normal(len(time))
    data = pd.DataFrame({"motor_torque": noisy, "joint_angle": 0.0}, index=pd.Index(time, name="t"))
    system = joint(("joint:viscous",), viscous=0.02)
    ready = prepare(Experiment(name="noisy", data=data, averaged=True), system, Replay("free"))
    settings = _core.Settings(tolerance=1e-4, position_scale=1e-2, velocity_scale=1e-2)
    done = _core.simulate(system.kind, system.values(), system.active(), ready.core, [], settings)
    assert done["rejected"] < 0.15 * done["attempts"]
    assert done["attempts"] < 1.5 * len(time)


AMPLITUDES = {
    "joint:stribeck": {"joint_static_excess": 0.0, "joint_stribeck_velocity": 0.1},
    "joint:asymmetry": {"joint_level_asymmetry": 0.0, "joint_viscous_asymmetry": 0.0},
    "motor:load_dependence": {"motor_load_dependence": 0.0},
    "contact:load_dependence": {"contact_load_dependence": 0.0},
    "cable:backlash": {"cable_backlash": 0.0},
    "actuation:delay": {"actuation_delay": 0.0},
    "actuation:gain_error": {"actuation_gain_error": 0.0},
    "actuation:offset": {"actuation_offset": 0.0},
    "sensor.joint_angle:bias": {"sensor.joint_angle_bias": 0.0},
    "sensor.joint_angle:delay": {"sensor.joint_angle_delay": 0.0},
    "joint:presliding": {"joint_presliding_share": 0.0, "joint_bristle_stiffness": 50.0, "joint_bristle_damping": 0.1},
}


@pytest.mark.parametrize("effect", AMPLITUDES)
def test_off_means_off_bit_for_bit(effect):
    """An effect with zero amplitude gives the bits of the system without it."""
    plain = pair(NOMINAL, **FRICTION)
    off = plain.with_effects({effect: AMPLITUDES[effect]})
    assert effect in off.effects
    assert np.array_equal(run(off, T, COMMAND, tolerance=1e-6).table, run(plain, T, COMMAND, tolerance=1e-6).table)


@pytest.mark.parametrize("effect", sorted(set(AMPLITUDES) - {"cable:backlash", "joint:presliding"}))
def test_law_that_runs_at_zero_amplitude_gives_the_same_bits(effect):
    """The same where the law is evaluated, as it is for its derivative at zero."""
    plain = pair(NOMINAL, **FRICTION)
    off = plain.with_effects({effect: AMPLITUDES[effect]})
    kept = run(off, T, COMMAND, tolerance=1e-6, keep_zero=True).table
    assert np.array_equal(kept, run(plain, T, COMMAND, tolerance=1e-6).table)


@pytest.mark.parametrize("effect", ["cable:backlash", "joint:presliding"])
def test_law_with_modes_or_memory_at_zero_amplitude_gives_the_same_motion(effect):
    """A gap of zero still has two flanks to land on, an idle bristle has a state: other steps, same motion."""
    plain = pair(NOMINAL, **FRICTION)
    off = plain.with_effects({effect: AMPLITUDES[effect]})
    kept = run(off, T, COMMAND, tolerance=1e-9, keep_zero=True).table
    for a, b in zip(kept, run(plain, T, COMMAND, tolerance=1e-9).table, strict=True):
        assert relative(a, b) < 1e-6


@pytest.mark.parametrize("gap", [0.0, 1e-14, 1e-12, 1e-10])
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_gap_that_is_crossed_at_once_costs_a_few_steps(gap, tolerance):
    """Flank to flank in less time than doubles resolve: a few attempts for each crossing, and the same motion."""
    plain = run(pair(NOMINAL, **FRICTION), T, COMMAND, tolerance=tolerance)
    loose = pair((*NOMINAL, "cable:backlash"), **FRICTION, cable_backlash=gap)
    found = run(loose, T, COMMAND, tolerance=tolerance, keep_zero=True)
    assert found.events > plain.events
    assert found.attempts < plain.attempts + 25 * (found.events - plain.events)
    for a, b in zip(found.table, plain.table, strict=True):
        assert relative(a, b) < 20.0 * tolerance + 100.0 * gap


@pytest.mark.parametrize("tolerance", [1e-5, 1e-6, 1e-7])
def test_derivatives_do_not_change_the_run(tolerance):
    """Differentiating is carried along: the same steps, but for the rounding of their estimated errors, which moves
    values by a fraction of what a step may err."""
    system = CASES["stick and slip"][0]
    plain = run(system, T, COMMAND, tolerance=tolerance)
    carried = run(system, T, COMMAND, tolerance=tolerance, by=["motor_inertia", "joint_coulomb"])
    assert abs(carried.attempts - plain.attempts) <= 0.01 * plain.attempts
    for a, b in zip(carried.table, plain.table, strict=True):
        assert relative(a, b) < 0.2 * tolerance


def test_same_run_same_bits():
    system, command, loop = CASES["late loop"]
    first, second = (run(system, T, command, loop=loop, tolerance=1e-6).table for _ in range(2))
    assert np.array_equal(first, second)


def test_samples_do_not_change_the_steps():
    """Outputs come from the dense output: asking for fewer gives the same numbers."""
    system = CASES["stick and slip"][0]
    every = run(system, T, 0.08, kind="linear", tolerance=1e-6)
    tenth = run(system, T[::10], 0.08, kind="linear", tolerance=1e-6)
    np.testing.assert_allclose(every.table[:, ::10], tenth.table, rtol=1e-13, atol=1e-15)

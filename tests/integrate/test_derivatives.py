"""Exact derivatives by parameters and initial state against differences of the same run at a far tighter tolerance."""

import numpy as np
import pytest

from integrate.rig import FRICTION, NOMINAL, controller, differences, joint, pair, relative, run
from tendonlab.simulation.signals import hold, linear, smooth

T = np.linspace(0.0, 2.0, 401)
COMMAND = 0.06 * np.sin(2 * np.pi * T) + 0.03 * np.sin(2 * np.pi * 2.3 * T + 1.0)
TIGHT = 1e-12  # of the differenced runs


def check(system, by, command=COMMAND, *, step=1e-4, tolerance=1e-10, bound=1e-5, least=1, time=T, **options):
    """Each derivative, as relative rms of each output that it moves. `step`: relative to the parameter, or absolute
    where that is 0. The stepper is run at 1e-10, so that its own error stays well below `bound`.

    A difference is worth as much as its step: a short one shows the error of the two runs, a long one the curvature,
    or an event that only one of the two meets. Where the stated step misses the bound, half and twice of it decide: a
    wrong derivative differs from all three."""
    exact = run(system, time, command, by=by, tolerance=tolerance, **options)
    assert exact.events >= least
    worst = {}
    for name in by:
        value = abs(system.parameters.get(name, 0.0)) or 1.0
        for share in (1.0, 0.5, 2.0):
            size = share * step * value
            # an output that a parameter does not move shows the noise of the differences: the runs' error over the step
            noise = 10 * TIGHT / size * np.sqrt(np.mean(exact.table**2, axis=1))
            found = differences(system, name, time, command, step=size, tolerance=TIGHT, **options)
            error = largest_error(exact.gradient[name], found, noise)
            worst[name] = min(error, worst.get(name, np.inf))
            if worst[name] <= bound:
                break
    assert {name: error for name, error in worst.items() if not error <= bound} == {}


def largest_error(gradient, found, noise):
    """The worst relative rms error of the outputs that stand out of the noise; infinite where none does."""
    moved = [(g, d) for g, d, n in zip(gradient, found, noise, strict=True) if np.max(abs(d)) > n or np.max(abs(g)) > n]
    return max((relative(g, d) for g, d in moved), default=np.inf)


def test_release_slide_and_stop_of_a_block():
    """Two releases and two stops; the push never equals the level at a turning point."""
    t = np.linspace(0.0, 2.0, 401)
    system = joint(("joint:coulomb", "joint:viscous"), coulomb=1.0, viscous=0.3)
    check(system, ["inertia", "torque_constant", "coulomb", "viscous"], 1.7 * np.sin(2 * np.pi * t), time=t, least=4)


def test_stribeck_asymmetry_and_load_of_a_block():
    t = np.linspace(0.0, 2.0, 401)
    effects = ("joint:coulomb", "joint:viscous", "joint:stribeck", "joint:asymmetry", "joint:load_dependence")
    system = joint(effects, coulomb=0.6, viscous=0.3, gravity_torque=0.5, joint_static_excess=0.3,
                   joint_load_dependence=0.1, joint_stribeck_velocity=0.05, joint_level_asymmetry=0.15,
                   joint_viscous_asymmetry=0.05)  # fmt: skip
    check(system, list(system.parameters), 1.7 * np.sin(2 * np.pi * t), time=t, step=2e-5, least=4)


def test_reversals_of_a_sliding_block():
    """The push exceeds the level at each reversal: it never sticks."""
    t = np.linspace(0.0, 2.0, 401)
    system = joint(("joint:coulomb",), coulomb=0.2)
    check(
        system,
        ["inertia", "coulomb", "position0", "velocity0"],
        2.0 * np.cos(2 * np.pi * t),
        time=t,
        step=1e-6,
        velocity=[0.123],
        least=3,
    )


def test_presliding_through_reversals():
    t = np.linspace(0.0, 1.0, 401)
    effects = ("joint:coulomb", "joint:viscous", "joint:stribeck", "joint:presliding")
    system = joint(effects, coulomb=1.0, viscous=0.4, joint_static_excess=0.5, joint_stribeck_velocity=0.05,
                   joint_bristle_stiffness=2e3, joint_bristle_damping=40.0, joint_presliding_share=1.0)  # fmt: skip
    by = [n for n in system.parameters if n not in ("gravity_torque", "joint_presliding_share")]
    check(system, by, 2.0 * np.sin(2 * np.pi * t), time=t, step=2e-5, least=1)


def test_stiff_bristle_that_slides_under_a_held_command():
    """Between two samples the bristle settles many times over: explicit steps of that length damp nothing, which the
    values, in balance, do not show."""
    effects = ("joint:coulomb", "joint:viscous", "joint:presliding")
    system = joint(effects, coulomb=1.0, viscous=0.4, joint_bristle_stiffness=2e3, joint_bristle_damping=1.0,
                   joint_presliding_share=1.0)  # fmt: skip
    command = 1.8 + 0.01 * np.sin(2 * np.pi * T)
    by = ["inertia", "coulomb", "viscous"]
    check(system, by, command, kind="hold", velocity=[2.0], tolerance=1e-4, bound=1e-4, least=0)
    assert run(system, T, command, kind="hold", velocity=[2.0], tolerance=1e-4).attempts < 1.1 * len(T)


def test_samples_between_the_ends_of_explicit_steps():
    """Five samples a piece of the command: their derivatives are told inside of a step."""
    system = joint(("joint:viscous",), viscous=0.4, gravity_torque=0.5)
    command = np.repeat(COMMAND[::5], 5)[: len(T)]
    by = ["inertia", "viscous", "gravity_torque", "velocity0"]
    check(system, by, command, kind="hold", velocity=[0.3], tolerance=1e-4, bound=1e-6, least=0)
    assert run(system, T, command, kind="hold", velocity=[0.3], tolerance=1e-4).attempts < 0.5 * len(T)


def test_events_within_explicit_steps():
    """A held command turns and stops a pair: one step a sample, and one more an event."""
    system, time = pair(NOMINAL, **FRICTION), np.linspace(0.0, 0.5, 1001)
    command = 0.06 * np.sin(4 * np.pi * time) + 0.03 * np.sin(9.2 * np.pi * time + 1.0)
    check(system, list(FRICTION), command, kind="hold", time=time, tolerance=1e-4, bound=1e-6, least=3)
    assert run(system, time, command, kind="hold", tolerance=1e-4).attempts < 1.02 * len(time)


def test_late_sensors_beside_explicit_steps():
    system = joint(("joint:viscous", "sensor.joint_angle:delay"), viscous=0.4, sensor__joint_angle_delay=0.0032)
    check(system, ["inertia", "viscous"], kind="hold", velocity=[0.3], tolerance=1e-4, bound=1e-6, least=0)


def test_partial_bristle_beside_dry_friction():
    """Half of the dry friction stays dry: it sticks, with a loaded bristle beside it."""
    t = np.linspace(0.0, 1.5, 401)
    effects = ("joint:coulomb", "joint:viscous", "joint:presliding")
    system = joint(effects, coulomb=1.0, viscous=0.4, joint_bristle_stiffness=500.0, joint_bristle_damping=5.0,
                   joint_presliding_share=0.5)  # fmt: skip
    by = ["inertia", "coulomb", "joint_bristle_stiffness", "joint_bristle_damping", "joint_presliding_share"]
    check(system, by, 2.0 * np.sin(2 * np.pi * t), time=t, step=2e-5, least=2)


def test_stick_and_slip_of_a_pair():
    system = pair(NOMINAL, **FRICTION)
    check(system, [n for n in system.parameters if n != "gravity_torque"], least=6)


def test_gravity_and_initial_state_of_a_pair():
    system = pair(NOMINAL, **FRICTION).with_parameters({"gravity_torque": 1.1})
    start = {"position": [1.0, 0.12], "velocity": [2.0, 0.3]}
    check(system, ["gravity_torque", "joint_inertia", "position0", "position1"], **start, step=1e-5, least=4)
    check(system, ["velocity0", "velocity1"], **start, step=1e-4, least=4)


def test_backlash_edges():
    system = pair((*NOMINAL, "cable:backlash"), **FRICTION, cable_backlash=0.01)
    by = [
        "cable_backlash",
        "cable_stiffness",
        "cable_damping",
        "gear_ratio",
        "motor_inertia",
        "joint_coulomb",
        "motor_coulomb",
    ]
    check(system, by, step=1e-5, least=10)


def test_gap_of_zero_has_a_derivative():
    """Both flanks are passed at once, each with its own jump. The motor leaves the middle of the gap from rest: the
    motion goes with D b + E b^(3/2), and the differences are those that E drops out of."""
    system = pair((*NOMINAL, "cable:backlash"), **FRICTION, cable_backlash=0.0)
    exact = run(system, T, COMMAND, by=["cable_backlash"], tolerance=1e-10, keep_zero=True).gradient["cable_backlash"]
    step = 3e-8
    base, one, four = (
        run(system.with_parameters({"cable_backlash": k * step}), T, COMMAND, tolerance=TIGHT, keep_zero=True).table
        for k in (0, 1, 4)
    )
    found = (8.0 * (one - base) - (four - base)) / (4.0 * step)
    errors = [relative(a, b) for a, b in zip(exact, found, strict=True)]
    assert max(errors) < 1e-4  # what is left of the differences is of first order in the step


MANY = (*NOMINAL, "joint:presliding", "joint:stribeck", "joint:asymmetry", "actuation:gain_error", "actuation:offset")
VALUES: dict[str, float] = dict(
    **FRICTION, gravity_torque=1.1, joint_bristle_stiffness=50.0, joint_bristle_damping=0.3, joint_presliding_share=1.0,
    joint_static_excess=0.03, joint_stribeck_velocity=0.1, joint_level_asymmetry=0.2, joint_viscous_asymmetry=0.01,
    actuation_gain_error=0.05, actuation_offset=0.001,
)  # fmt: skip


def test_many_effects_at_once():
    system = pair(MANY, **VALUES)
    by = [n for n in system.parameters if n != "joint_presliding_share"]
    assert len(by) > 16  # more than one pass of the widest derivative type
    check(system, by, step=2e-4, least=6)


def test_friction_by_a_load_that_changes_sign():
    """The stepper does not land on the kink of |load|: a step across it keeps an error of first order in its
    derivative, hence the tolerance of 1e-12 (at 1e-9 it is 3e-5)."""
    effects = (*MANY, "motor:load_dependence", "contact:load_dependence")
    system = pair(effects, **VALUES, motor_load_dependence=0.03, contact_load_dependence=0.05)
    check(system, ["motor_load_dependence", "contact_load_dependence"], step=1e-4, tolerance=1e-12, least=6)
    check(system, ["cable_stiffness", "joint_inertia", "joint_coulomb"], step=1e-5, tolerance=1e-12, least=6)


def held(command, every=20):
    """Held over 0.1 s."""
    return np.repeat(command[::every], every)[: len(command)]


def test_held_command_with_delay():
    """The jumps of the command move with the delay; the joint sticks and slips between them."""
    system = pair((*NOMINAL, "actuation:delay", "actuation:gain_error", "actuation:offset"), **FRICTION,
                  actuation_delay=0.0047, actuation_gain_error=0.1, actuation_offset=0.002)  # fmt: skip
    by = ["actuation_delay", "actuation_gain_error", "actuation_offset", "motor_inertia", "joint_coulomb"]
    check(system, by, held(COMMAND), kind="hold", step=2e-5, least=6)


def test_held_known_torque_does_not_move_with_the_delay_of_the_command():
    system = pair((*NOMINAL, "actuation:delay"), **FRICTION, actuation_delay=0.0047)
    check(
        system, ["actuation_delay", "motor_inertia"], COMMAND, known=held(0.3 * np.sin(5.0 * T)), kind="hold", step=2e-5
    )


def test_smooth_command_with_delay():
    system = pair((*NOMINAL, "actuation:delay"), **FRICTION, actuation_delay=0.0047)
    check(system, ["actuation_delay", "motor_coulomb"], step=1e-3, least=6)


def test_sensors():
    system = pair((*NOMINAL, "sensor.motor_angle:delay", "sensor.joint_angle:bias", "sensor.joint_angle:delay"),
                  **FRICTION, sensor__motor_angle_delay=0.003, sensor__joint_angle_bias=0.01,
                  sensor__joint_angle_delay=0.0121)  # fmt: skip
    by = ["sensor.motor_angle_delay", "sensor.joint_angle_bias", "sensor.joint_angle_delay", "motor_coulomb"]
    check(system, by, 0.2 * COMMAND + 0.06 * np.sin(20.0 * T), step=1e-3)


REFERENCE = smooth(T, 3.0 * np.sin(2 * np.pi * 0.8 * T))
LATE = {"actuation_delay": 0.0047, "actuation_gain_error": 0.1, "actuation_offset": 0.002}


def late(**more):
    """A pair whose loop is late at both ends."""
    return pair(
        (*NOMINAL, "actuation:delay", "actuation:gain_error", "actuation:offset", "sensor.motor_angle:delay",
         "sensor.motor_angle:bias"), **{**FRICTION, **LATE, **more}, sensor__motor_angle_delay=0.003,
        sensor__motor_angle_bias=0.01)  # fmt: skip


BY_LATE = [*LATE, "sensor.motor_angle_delay", "sensor.motor_angle_bias", "motor_inertia", "joint_coulomb"]


def test_loop_in_continuous_time():
    by = ["motor_inertia", "motor_coulomb", "joint_viscous", "cable_stiffness", "gear_ratio"]
    check(pair(NOMINAL, **FRICTION), by, loop=controller(REFERENCE))


def test_saturating_loop():
    check(pair(NOMINAL, **FRICTION), ["motor_inertia", "motor_coulomb", "joint_coulomb", "joint_inertia"],
          loop=controller(REFERENCE, limit=0.08), least=6)  # fmt: skip


def test_late_loop_in_continuous_time():
    check(late(), [n for n in BY_LATE if not n.endswith("bias")], loop=controller(REFERENCE), step=2e-5)
    # the bias is 0.01 of angles of 3: over so small a step the error of the runs would be all that differs
    check(late(), ["sensor.motor_angle_bias"], loop=controller(REFERENCE), step=1e-3)


def test_sampled_loop():
    check(pair(NOMINAL, **FRICTION), ["motor_inertia", "motor_coulomb", "joint_viscous", "cable_stiffness"],
          loop=controller(REFERENCE, sample_time=0.004), step=2e-5)  # fmt: skip


def test_late_sampled_loop():
    check(late(), BY_LATE, loop=controller(REFERENCE, sample_time=0.004), step=2e-5)


def test_injection_by_sensor_errors():
    """Replay with a spring to the logged motor angle: its sensor's errors act through the pull."""
    measured = smooth(T, 2.0 * np.sin(2 * np.pi * 0.8 * T))
    system = pair((*NOMINAL, "sensor.motor_angle:delay", "sensor.motor_angle:bias"), **FRICTION,
                  sensor__motor_angle_delay=0.003, sensor__motor_angle_bias=0.01)  # fmt: skip
    by = ["sensor.motor_angle_delay", "sensor.motor_angle_bias", "motor_inertia"]
    check(system, by, loop=controller(measured, kind="injection"), step=1e-4)


@pytest.mark.parametrize("kind", ["hold", "linear", "smooth"])
@pytest.mark.parametrize("loop", ["open", "continuous", "sampled", "held"])
def test_derivatives_where_a_delay_is_still_zero(kind, loop):
    """A delay that is off has a derivative too: against one-sided differences of second order."""
    system = pair((*NOMINAL, "actuation:delay", "sensor.motor_angle:delay"), **FRICTION, actuation_delay=0.0,
                  sensor__motor_angle_delay=0.0)  # fmt: skip
    reference = (hold if loop == "held" else smooth if loop == "continuous" else linear)(
        T, 3.0 * np.sin(2 * np.pi * 0.8 * T)
    )
    closed = controller(reference, sample_time=0.004 if loop == "sampled" else 0.0)
    options = {"kind": kind, "loop": None if loop == "open" else closed, "keep_zero": True}
    by = ["actuation_delay", "sensor.motor_angle_delay"]
    exact = run(system, T, held(COMMAND), by=by, tolerance=1e-10, **options)
    for name in by:
        step = 2e-6
        base, one, two = (
            run(system.with_parameters({name: k * step}), T, held(COMMAND), tolerance=TIGHT, **options).table
            for k in (0, 1, 2)
        )
        found = (-3.0 * base + 4.0 * one - two) / (2.0 * step)
        moved = [i for i, d in enumerate(found) if np.max(abs(d)) > 1e-5]  # below is the noise of 1e-12 over the step
        errors = [relative(exact.gradient[name][i], found[i]) for i in moved]
        assert len(moved) == 3 or (loop == "open" and name.startswith("sensor"))
        # differences of second order in 2e-6 s; inside a step the late loop knows its acceleration to first order only
        assert max(errors) < 1e-3, name

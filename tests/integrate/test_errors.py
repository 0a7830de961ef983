"""What cannot be simulated is refused with its name, its value and what was expected; nothing runs on for ever."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from integrate.rig import FRICTION, NOMINAL, joint, pair, run
from tendonlab import _core
from tendonlab.errors import NumericalError, ParameterError

T = np.linspace(0.0, 1.0, 101)
SYSTEM = joint(("joint:coulomb", "joint:viscous"), coulomb=1.0, viscous=0.1)


def experiment(**changes):
    inputs = [_core.Signal(), _core.Signal()]
    usual = {"time": T.tolist(), "inputs": inputs, "loop": _core.Loop(), "position": [0.0], "velocity": [0.0]}
    return _core.Experiment(**{"kind": "rigid_joint", **usual, **changes})


def simulate(of, *, kind="rigid_joint", values=None, active=None, seeds=(), **options):
    return _core.simulate(
        kind, values or SYSTEM.values(), active or SYSTEM.active(), of, list(seeds), _core.Settings(**options)
    )


def test_unknown_system():
    with pytest.raises(ParameterError, match=r"three_inertia.*rigid_joint.*two_inertia"):
        _core.SystemInfo("three_inertia")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"time": [0.0]}, "1 samples: expected at least 2"),
        ({"time": [0.0, 0.2, 0.1]}, r"time\[2\] = 0.1 s: expected more than 0.2 s"),
        ({"time": [0.0, 0.0]}, r"time\[1\] = 0 s: expected more than 0 s"),
        ({"time": [0.0, float("nan")]}, r"time\[1\] = nan s: expected more than 0 s"),
        ({"inputs": [_core.Signal()]}, "1 inputs: rigid_joint expects 2"),
        ({"position": [0.0, 0.0]}, "rigid_joint expects 1 positions"),
        ({"velocity": []}, "rigid_joint expects 1 positions and as many velocities"),
    ],
)
def test_experiment_that_does_not_fit(changes, message):
    with pytest.raises(ParameterError, match=message):
        experiment(**changes)


def test_sizes_of_values_and_flags():
    count = len(SYSTEM.values())
    with pytest.raises(ParameterError, match=f"{count - 1} values: rigid_joint has {count} parameters"):
        simulate(experiment(), values=SYSTEM.values()[:-1])
    with pytest.raises(ParameterError, match="1 flags: rigid_joint has"):
        simulate(experiment(), active=[True])


@pytest.mark.parametrize(("value", "shown"), [(-1.0, "-1"), (float("nan"), "nan"), (float("inf"), "inf")])
def test_value_out_of_bounds(value, shown):
    values = SYSTEM.values()
    values[[p.name for p in SYSTEM.info.parameters].index("coulomb")] = value
    with pytest.raises(ParameterError, match=rf"coulomb = {shown}: expected a value in \[0, inf\]"):
        simulate(experiment(), values=values)


def test_experiment_of_another_system():
    other = pair(NOMINAL, **FRICTION)
    with pytest.raises(ParameterError, match="1 positions: two_inertia expects 2 and 2"):
        simulate(experiment(), kind="two_inertia", values=other.values(), active=other.active())


@pytest.mark.parametrize(
    ("seed", "message"),
    [
        (("parameter", 999), f"parameter 999: rigid_joint has {len(SYSTEM.info.parameters)}"),
        (("position", 1), "initial state 1: rigid_joint has 1"),
    ],
)
def test_derivative_by_what_is_not_there(seed, message):
    with pytest.raises(ParameterError, match=message):
        simulate(experiment(), seeds=[seed])


def test_loop_on_what_is_not_there():
    gains = {"proportional": 1.0, "derivative": 0.0, "reference_weight": 1.0, "limit": np.inf, "sample_time": 0.0}
    closed = {"kind": "controller", **gains, "reference": _core.Signal(), "disturbance": _core.Signal()}
    with pytest.raises(ParameterError, match="axis 1: rigid_joint has 1"):
        simulate(experiment(loop=_core.Loop(axis=1, output=0, **closed)))
    with pytest.raises(ParameterError, match="output 2: rigid_joint has 2"):
        simulate(experiment(loop=_core.Loop(axis=0, output=2, **closed)))
    with pytest.raises(ParameterError, match='"closed": expected open, injection or controller'):
        _core.Loop(**{**closed, "kind": "closed"}, axis=0, output=0)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, 1.0, float("nan")])
def test_tolerance_out_of_bounds(tolerance):
    with pytest.raises(ParameterError, match=r"tolerance = .*expected a value in"):
        _core.Settings(tolerance=tolerance)


def test_signal_of_the_wrong_shape():
    with pytest.raises(ParameterError, match=r"3 knots: expected coefficients of shape \(3, 4\)"):
        _core.Signal(np.arange(3.0), np.zeros((3, 2)), False)


def test_too_many_attempts_names_the_time():
    with pytest.raises(
        NumericalError, match=r"stopped at t = 0\.\d+ s after 20 step attempts; expected to reach t = 1 s"
    ):
        run(SYSTEM, T, 2.0 * np.sin(50.0 * T), max_attempts=20)


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_command_that_is_not_finite_names_the_time(value):
    command = np.where(T < 0.495, 1.5, value)
    with pytest.raises(NumericalError, match=r"stopped at t = 0\.(49|5)\d* s"):
        run(SYSTEM, T, command, kind="hold", max_attempts=5000)


def test_initial_state_that_is_not_finite():
    with pytest.raises(NumericalError, match="stopped at t = 0 s"):
        run(SYSTEM, T, 1.5, velocity=[float("nan")], max_attempts=5000)


def magnitude(low, high):
    """Log-uniform over the decades in between."""
    return st.floats(low, high).map(lambda e: 10.0**e)


DRAWN = {
    "motor_inertia": magnitude(-6, 0), "joint_inertia": magnitude(-5, 1), "gear_ratio": magnitude(-1, 2.5),
    "torque_constant": magnitude(-3, 1),
    "cable_stiffness": magnitude(-1, 5), "cable_damping": magnitude(-4, 1), "gravity_torque": st.floats(-5.0, 5.0),
    "motor_coulomb": magnitude(-5, 0), "motor_viscous": magnitude(-6, 0), "joint_coulomb": magnitude(-5, 1),
    "joint_viscous": magnitude(-5, 1), "joint_static_excess": magnitude(-4, 0),
    "joint_stribeck_velocity": magnitude(-4, 0),
    "joint_bristle_stiffness": magnitude(-1, 5), "joint_bristle_damping": magnitude(-4, 2),
    "joint_presliding_share": st.floats(0.0, 1.0), "joint_level_asymmetry": st.floats(-0.999, 0.999),
    "joint_viscous_asymmetry": st.just(0.0), "motor_load_dependence": st.floats(0.0, 1.0),
    "contact_load_dependence": st.floats(0.0, 1.0), "cable_backlash": magnitude(-5, 0),
    "actuation_delay": st.floats(0.0, 0.05), "actuation_gain_error": st.floats(-0.9, 2.0),
    "actuation_offset": st.floats(-0.1, 0.1), "sensor.joint_angle_delay": st.floats(0.0, 0.05),
    "sensor.joint_angle_bias": st.floats(-1.0, 1.0),
}  # fmt: skip
OPTIONAL = (
    *NOMINAL, "joint:stribeck", "joint:asymmetry", "motor:load_dependence", "contact:load_dependence",
    "cable:backlash", "actuation:delay", "actuation:gain_error", "actuation:offset", "sensor.joint_angle:delay",
    "sensor.joint_angle:bias",
)  # fmt: skip


@st.composite
def systems(draw):
    effects = set(draw(st.sets(st.sampled_from(OPTIONAL))))
    if "joint:coulomb" in effects and draw(st.booleans()):
        effects.add("joint:presliding")
    info = pair().info
    own = [name for effect in effects for name in info.effect(effect).parameters]
    names = [*pair().parameters, *own]
    return pair(sorted(effects), **{name: draw(DRAWN[name]) for name in names})


@settings(max_examples=120, deadline=None, derandomize=True)
@given(
    system=systems(),
    amplitude=magnitude(-3, 1),
    kind=st.sampled_from(["hold", "linear", "smooth"]),
    start=st.floats(-1.0, 1.0),
)
def test_admissible_parameters_give_finite_outputs_or_say_when_they_fail(system, amplitude, kind, start):
    t = np.linspace(0.0, 0.5, 51)
    try:
        done = run(
            system,
            t,
            amplitude * np.sin(20.0 * t),
            kind=kind,
            position=[0.0, start],
            tolerance=1e-5,
            max_attempts=20_000,
        )
    except NumericalError as error:
        told = str(error)
    else:
        told = ""
        assert np.all(np.isfinite(done.table))
    assert not told or "stopped at t = " in told

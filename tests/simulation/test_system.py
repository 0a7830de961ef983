"""A simulator and what it gives: what is refused and with which words, and the forms in which it is shown."""

import copy
import pickle
from dataclasses import FrozenInstanceError, replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import tendonlab as tl
from tendonlab.cli.demo import bundled
from tendonlab.data import Controller, Experiment
from tendonlab.simulation.system import require_system

VALUES = {"inertia": 0.02, "gravity_torque": 0.5, "torque_constant": 1.0, "coulomb": 0.05, "viscous": 0.03}
SIM = tl.System(kind="rigid_joint", parameters=VALUES, effects=("joint:coulomb", "joint:viscous"))
TIME = np.arange(0.0, 0.5, 0.01)
PUSHED = pd.DataFrame({"motor_torque": 0.4 * np.sin(6.0 * TIME)}, index=pd.Index(TIME, name="t"))


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"kind": "rigid_join"}, "system kind = 'rigid_join': did you mean 'rigid_joint'"),
        ({"axis": "round"}, "axis = 'round': expected one of rotary, linear"),
        ({"effects": ("joint:stribek",)}, "'joint:stribek' is no effect of rigid_joint; did you mean 'joint:stribeck'"),
        (
            {"effects": ("joint:viscous", "joint:presliding")},
            "joint:presliding shapes dry friction, and none is there: add one of joint:coulomb",
        ),
        (
            {"effects": ("joint:coulomb",)},
            "viscous = 0.03: parameter of joint:viscous, which this rigid_joint lacks; expected that effect",
        ),
        ({"parameters": {**VALUES, "inertia": -1.0}}, r"inertia = -1.0: expected a value in \[1e-12, inf\) kg\*m\^2"),
        ({"parameters": {**VALUES, "inertia": np.nan}}, "inertia = nan: expected a value in"),
        (
            {"parameters": {k: v for k, v in VALUES.items() if k != "coulomb"}},
            r"coulomb: missing; .* \(kinetic friction",
        ),
    ],
)
def test_a_simulator_that_cannot_be_is_refused(changes: dict[str, object], told: str) -> None:
    given = {"kind": SIM.kind, "parameters": VALUES, "effects": SIM.effects} | changes
    with pytest.raises(tl.ParameterError, match=told):
        tl.System(**given)


@pytest.mark.parametrize(
    ("given", "error", "told"),
    [
        (PUSHED.reset_index(), tl.DatasetError, "column 't' is not the index: expected a frame indexed by time"),
        (PUSHED.replace(PUSHED.iloc[3, 0], np.nan), tl.DatasetError, "motor_torque = nan at t = 0.03 s"),
        (PUSHED.iloc[:1], tl.ParameterError, "experiment with 1 samples: expected at least 2"),
    ],
    ids=["time as a column", "a gap", "one sample"],
)
def test_what_cannot_be_simulated_is_refused(given: Any, error: type[Exception], told: str) -> None:
    with pytest.raises(error, match=told):
        SIM.simulate(given)


def test_a_replay_that_a_simulator_alone_cannot_do_is_refused() -> None:
    with pytest.raises(tl.ParameterError, match="replay = 'injection': expected one of auto, controller, free"):
        SIM.simulate(PUSHED, replay="injection")


def test_a_reference_with_a_gap_is_refused() -> None:
    closed = replace(SIM, controller=Controller("pd", 3.0, 0.1, "joint_angle", "reference_angle"))
    frame = PUSHED.assign(reference_angle=0.1 * np.sin(6.0 * TIME))
    frame.iloc[7, 1] = np.nan
    with pytest.raises(tl.DatasetError, match="given: reference_angle = nan at t = 0"):
        closed.simulate(frame)


def test_a_payload_adds_to_what_an_experiment_states() -> None:
    """As in fits: the condition fixes the parameter, and the payload comes on top."""
    run = Experiment(name="run", data=PUSHED, conditions={"inertia": 0.03, "temperature": 31.0}, add={"inertia": 0.01})
    assert SIM.under(run).parameters["inertia"] == pytest.approx(0.04)
    loaded = replace(run, conditions={})
    assert SIM.under(loaded).parameters["inertia"] == pytest.approx(0.03)


@pytest.mark.parametrize(
    ("kind", "given"),
    [
        ("rigid_joint", {"inertia": 0.02, "gravity_torque": 0.5}),
        (
            "two_inertia",
            {"motor_inertia": 1e-4, "joint_inertia": 0.02, "gear_ratio": 10.0, "gravity_torque": 0.5}
            | {"cable_stiffness": 50.0, "cable_damping": 0.05},
        ),
    ],
)
def test_a_torque_constant_makes_a_current_a_torque(kind: str, given: dict[str, float]) -> None:
    """Without one the command is a torque. A sixteenth is exact in binary: all bits agree."""
    by_torque = tl.System(kind, parameters=given).simulate(PUSHED)
    by_current = tl.System(kind, parameters=given | {"torque_constant": 1 / 16}).simulate(16.0 * PUSHED)
    pd.testing.assert_frame_equal(by_torque.outputs, by_current.outputs, check_exact=True)


def test_changes_leave_the_original_as_it_was() -> None:
    stribeck = {"static_excess": 0.1, "joint_stribeck_velocity": 0.05}  # own and full names
    changed = SIM.with_parameters({"inertia": 0.03}).with_effects({"joint:stribeck": stribeck})
    assert changed.parameters["inertia"] == 0.03
    assert changed.parameters["joint_static_excess"] == 0.1
    assert changed.effects == (*SIM.effects, "joint:stribeck")
    assert (SIM.parameters, SIM.effects) == (VALUES, ("joint:coulomb", "joint:viscous"))
    with pytest.raises(tl.ParameterError, match="no parameter of joint:stribeck; did you mean 'static_excess'"):
        SIM.with_effects({"joint:stribeck": {"excess": 0.1}})


def test_an_effect_without_amplitude_changes_no_bit() -> None:
    added = SIM.with_effects({"joint:stribeck": {"static_excess": 0.0, "stribeck_velocity": 0.05}})
    pd.testing.assert_frame_equal(added.simulate(PUSHED).outputs, SIM.simulate(PUSHED).outputs, check_exact=True)


def test_units_follow_the_axis() -> None:
    linear = tl.System(kind="rigid_joint", parameters=VALUES, effects=SIM.effects, axis="linear")
    assert [system.unit("viscous") for system in (SIM, linear)] == ["N*m*s/rad", "N*s/m"]


def test_a_trajectory_gives_its_outputs_and_draws_them() -> None:
    run = SIM.simulate(PUSHED)
    assert repr(run) == "Trajectory(joint_angle, joint_velocity; 50 samples, 0 to 0.49 s)"
    np.testing.assert_array_equal(run["joint_velocity"], run.outputs["joint_velocity"])
    assert run.to_dict()["t"] == TIME.tolist()
    ax = run.plot(Figure().subplots(), signal="joint_velocity")
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time (s)", "joint_velocity (rad/s)")
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), run["joint_velocity"])
    for ask in (lambda: run["joint_angel"], lambda: run.plot(Figure().subplots(), signal="joint_angel")):
        with pytest.raises(tl.ParameterError, match="'joint_angel' is no output; did you mean 'joint_angle'"):
            ask()
    with pytest.raises(tl.ParameterError, match="expected one name; `outputs` is the frame of all"):
        run[["joint_angle"]]  # type: ignore[index]


def test_forms_for_a_notebook_are_short_and_escaped() -> None:
    assert repr(SIM) == "System(rigid_joint, rotary, effects: joint:coulomb, joint:viscous)"
    assert "<td>viscous</td><td>0.03</td><td>N*m*s/rad</td>" in SIM._repr_html_()
    assert SIM.to_dict()["parameters"] == VALUES


RUN = Experiment(name="run", data=PUSHED, conditions={"gravity_torque": 0.4})


@pytest.mark.parametrize(
    "value", [SIM, SIM.simulate(PUSHED, ports=True), RUN], ids=["system", "trajectory", "experiment"]
)
def test_values_pickle_and_copy_to_their_equals(value: Any) -> None:
    for other in (pickle.loads(pickle.dumps(value)), copy.copy(value), copy.deepcopy(value)):
        assert other == value
        assert other is not value
    assert value != "something else"


def test_values_differ_where_one_sample_does() -> None:
    run, other = SIM.simulate(PUSHED), SIM.simulate(PUSHED)
    assert run == other
    other.outputs.iloc[3, 0] += 1e-12
    assert run != other
    assert replace(RUN, data=PUSHED * 2.0) != RUN
    with pytest.raises(TypeError, match="unhashable"):
        hash(RUN)


def test_a_system_cannot_be_changed() -> None:
    with pytest.raises(TypeError, match="does not support item assignment"):
        SIM.parameters["coulomb"] = 1.0  # type: ignore[index]
    with pytest.raises(FrozenInstanceError):
        SIM.axis = "linear"  # type: ignore[misc]
    assert hash(SIM) == hash(SIM.with_parameters({"coulomb": 0.05}))
    assert len({SIM, SIM.with_parameters({"coulomb": 0.06})}) == 2


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: tl.System("two_inertia"), "motor_inertia: missing"),
        (lambda: tl.System(7), "kind = 7: expected the name of a system"),  # type: ignore[arg-type]
        (lambda: replace(SIM, effects=None), r"effects = None: expected a list such as \['joint:stribeck'\]"),
        (lambda: replace(SIM, effects="joint:coulomb"), r"expected a list such as \['joint:coulomb'\]"),
        (lambda: replace(SIM, parameters=[1.0]), r"parameters = \[1.0\]: expected a mapping"),
        (lambda: replace(SIM, controller="pd"), "controller = 'pd': expected a Controller or None"),
        (lambda: SIM.with_parameters({"coulomb": np.inf}), "coulomb = inf: expected a value in"),
        (lambda: SIM.with_parameters({"coulomb": True}), "coulomb = True: expected a value in"),
        (lambda: SIM.with_parameters({"coulomb": "0.1"}), "coulomb = '0.1': expected a value in"),
        (lambda: SIM.simulate(PUSHED, tolerance="x"), r"tolerance = 'x': expected a value in \[1e-14, 0.1\]$"),
        (lambda: SIM.simulate("run-1"), "experiment is of type str: expected an experiment of a dataset"),
        (lambda: require_system(RUN), "expected a System, such as dataset.system()"),
    ],
)  # fmt: skip
def test_a_wrong_type_is_a_parameter_error(make: Any, message: str) -> None:
    with pytest.raises(tl.ParameterError, match=message):
        make()


def test_a_stiffness_that_no_step_resolves_ends_with_a_message(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tendonlab.simulation.prepare.MAX_ATTEMPTS", 1000)
    rig = tl.load(bundled())
    stiff = rig.system().with_parameters({"cable_stiffness": 1e15})
    record = replace(rig.experiments[0], data=rig.experiments[0].data.iloc[:10])
    with pytest.raises(tl.NumericalError, match=r"after 11000 step attempts; expected to reach t = .* far too stiff"):
        stiff.simulate(record)

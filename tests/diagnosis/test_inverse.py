"""Inverse dynamics: each friction amplitude of an axis is a column of its regression."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.data import Dataset, Experiment, NominalParameter, SignalSpec
from tendonlab.diagnosis.answer.inverse import CUTOFF, amplitudes, effort_column, inverse_dynamics, low_passed
from tendonlab.fitting.case import Case, make_case

VELOCITY = np.array([-1.0, 0.5, 2.0])


@pytest.fixture
def axis() -> tl.System:
    nominal = tl.System(
        kind="rigid_joint",
        parameters={"inertia": 1.0, "viscous": 0.1, "gravity_torque": 0.0, "torque_constant": 1.0},
        effects=("joint:viscous",),
    )
    return nominal.with_effects(
        {
            "joint:coulomb": {"coulomb": 3.0},
            "joint:asymmetry": {"level_asymmetry": 0.1, "viscous_asymmetry": 0.02},
            "sensor.joint_angle:delay": {"delay": 0.01},
        }
    )


def test_direction_dependence_enters_by_its_law_of_friction(axis: tl.System) -> None:
    """Laws of other groups are called asymmetry too; they must not take its place."""
    assert np.allclose(effort_column(axis, "viscous", VELOCITY), VELOCITY)
    assert np.allclose(effort_column(axis, "coulomb", VELOCITY), np.sign(VELOCITY))
    assert np.allclose(effort_column(axis, "joint_viscous_asymmetry", VELOCITY), abs(VELOCITY))


def test_what_does_not_push_the_axis_is_noeffort_column(axis: tl.System) -> None:
    assert amplitudes(axis) == ["viscous", "coulomb", "joint_viscous_asymmetry"]


TRUE = {"inertia": 0.5, "viscous": 0.4, "coulomb": 0.3, "gravity_torque": 0.0, "torque_constant": 2.0}
TIME = np.arange(0.0, 3.0, 0.002)


def logged(name: str, frequency: float) -> Experiment:
    """A run of an axis with dry friction, of which the simulator knows nothing; the command is a voltage."""
    rig = tl.System(kind="rigid_joint", parameters=TRUE, effects=("joint:coulomb", "joint:viscous"))
    command = pd.DataFrame({"motor_torque": np.sin(2 * np.pi * frequency * TIME)}, index=pd.Index(TIME, name="t"))
    data = command.assign(joint_angle=rig.simulate(command, tolerance=1e-8)["joint_angle"])
    return Experiment(name=name, data=data, initial={"joint_angle": 0.0, "joint_velocity": 0.0})


@pytest.fixture(scope="module")
def case() -> Case:
    nominal = {name: NominalParameter(value) for name, value in TRUE.items() if name != "coulomb"}
    signals = {
        "motor_torque": SignalSpec("motor_torque", "u", "N*m", "input", True),
        "joint_angle": SignalSpec("joint_angle", "q", "rad", "output", False, noise_sd=1e-4),
    }
    dataset = Dataset(
        name="axis", description="", kind="rigid_joint", axis="rotary", nominal_effects=("joint:viscous",),
        parameters=nominal, controller=None, signals=signals, path=Path(),
        experiments=(logged("slow", 0.7), logged("fast", 1.1)),
    )  # fmt: skip
    return make_case(dataset)


def test_a_regression_gives_the_parameters_of_the_axis_in_units_of_effort(case: Case) -> None:
    """The row of each model names what was added to the nominal one. The filter smears each jump of dry friction over a
    sixtieth of a second, which takes 3 % from the level."""
    with_friction = case.system.with_effects({"joint:coulomb": {"coulomb": 0.1}})
    table = inverse_dynamics(case, [case.system, with_friction], judged=[1])
    assert table is not None
    frame = table.frame
    assert list(frame.index) == ["nominal structure", "nominal structure + joint:coulomb"]
    found = frame.loc["nominal structure + joint:coulomb"]
    for name in ("inertia", "viscous", "coulomb"):
        assert found[name] == pytest.approx(TRUE[name], rel=0.05), name
    assert np.isnan(frame.loc["nominal structure", "coulomb"])
    for error in ("fitted rms", "held-out rms"):
        assert found[error] < 0.3 * frame.loc["nominal structure", error]
    assert "rms in N·m" in table.note


def test_uneven_stamps_change_no_parameter(case: Case) -> None:
    """A filter that took the samples for even ones would see a motion that is faster where stamps are missing."""
    kept = np.sort(np.random.default_rng(4).permutation(len(TIME))[: 4 * len(TIME) // 5])
    fewer = tuple(replace(e, data=e.data.iloc[kept]) for e in case.experiments)
    prepared = tuple(replace(r, measured=r.measured[:, kept]) for r in case.prepared)
    uneven = replace(case, experiments=fewer, prepared=prepared)
    with_friction = case.system.with_effects({"joint:coulomb": {"coulomb": 0.1}})
    tables = [inverse_dynamics(of, [with_friction], judged=[1]) for of in (case, uneven)]
    even, odd = (table.frame.iloc[0] for table in tables if table is not None)
    for name in ("inertia", "viscous", "coulomb", "held-out rms"):
        assert odd[name] == pytest.approx(even[name], rel=0.03), name


def test_an_axis_whose_drive_was_not_logged_has_no_table(case: Case) -> None:
    """Nuts that move as prescribed have none; diagnoses of such logs ended."""
    bare = tuple(replace(e, data=e.data.drop(columns="motor_torque")) for e in case.experiments)
    assert inverse_dynamics(replace(case, experiments=bare), [case.system], judged=[1]) is None


def test_gravity_known_efforts_and_payloads_are_part_of_the_balance() -> None:
    true = TRUE | {"gravity_torque": 1.5}
    rig = tl.System(kind="rigid_joint", parameters=true, effects=("joint:coulomb", "joint:viscous"))

    def run(name: str, frequency: float, payload: float) -> Experiment:
        inputs = {"motor_torque": np.sin(2 * np.pi * frequency * TIME), "known_torque": 0.5 * np.cos(3.0 * TIME)}
        frame = pd.DataFrame(inputs, index=pd.Index(TIME, name="t"))
        loaded = rig.with_parameters({"gravity_torque": 1.5 + payload})
        data = frame.assign(joint_angle=loaded.simulate(frame, tolerance=1e-8)["joint_angle"])
        return Experiment(name=name, data=data, add={"gravity_torque": payload}, initial={"joint_angle": 0.0})

    signals = {
        "motor_torque": SignalSpec("motor_torque", "u", "N*m", "input", True),
        "known_torque": SignalSpec("known_torque", "k", "N*m", "input", True),
        "joint_angle": SignalSpec("joint_angle", "q", "rad", "output", False, noise_sd=1e-4),
    }
    dataset = Dataset(
        name="axis", description="", kind="rigid_joint", axis="rotary", nominal_effects=rig.effects, controller=None,
        parameters={name: NominalParameter(value) for name, value in true.items()}, signals=signals, path=Path(),
        experiments=(run("bare", 0.7, 0.0), run("loaded", 1.1, 0.6)),
    )  # fmt: skip
    case = make_case(dataset)
    table = inverse_dynamics(case, [case.system], judged=[1])
    assert table is not None
    found = table.frame.iloc[0]
    for name in ("inertia", "gravity_torque", "viscous", "coulomb"):
        assert found[name] == pytest.approx(true[name], rel=0.05), name
    assert found["held-out rms"] < 0.1 * np.sqrt(0.5) * true["torque_constant"]


@pytest.mark.parametrize("share", [0.1, 0.5, 1.0, 2.0])
def test_the_filter_has_the_gain_of_butterworth_and_no_phase(share: float) -> None:
    time = np.arange(0.0, 2.0, 1e-3)
    wave = np.sin(2 * np.pi * share * CUTOFF * time + 0.4)
    smooth = low_passed(wave + 0.3 * time, 1e-3)  # what drifts stays
    kept = slice(150, -150)
    np.testing.assert_allclose(smooth[kept], (wave / (1 + share**8) + 0.3 * time)[kept], atol=3e-3)

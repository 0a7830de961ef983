"""What the verbs refuse of what a user may give them, by name and with what was expected."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl

VALUES = {"inertia": 0.5, "gravity_torque": 1.0, "torque_constant": 1.0, "coulomb": 0.1, "viscous": 0.2}
EFFECTS = ("joint:coulomb", "joint:viscous")
TIME = np.arange(0.0, 0.5, 0.01)
JOINT = tl.System(kind="rigid_joint", parameters=VALUES, effects=EFFECTS)
RUN = pd.DataFrame({"motor_torque": np.sin(9.0 * TIME)}, index=TIME)


def test_what_is_right_stays_right() -> None:
    """Integers, single precision, nullable columns and read-only arrays are numbers."""
    told = JOINT.simulate(RUN.round())["joint_angle"]
    for kind in ("int64", "float32", "Float64"):
        np.testing.assert_allclose(JOINT.simulate(RUN.round().astype(kind))["joint_angle"], told, atol=1e-9)
    assert JOINT.with_parameters({"inertia": np.float32(0.5)}).parameters["inertia"] == 0.5


@pytest.mark.parametrize(
    ("frame", "told"),
    [
        (RUN.astype(str), "given: motor_torque is of type .*; expected real numbers"),
        (RUN + 0j, "given: motor_torque is of type complex128; expected real numbers"),
        (RUN.assign(joint_angle="x"), "given: joint_angle is of type .*; expected real numbers"),
        (pd.concat([RUN, RUN], axis=1), "given: 2 columns are named motor_torque; expected one"),
        (RUN.set_axis(pd.to_datetime(TIME, unit="s")), r"given: the index is of type datetime64.*; expected time in s"),
        (RUN.set_axis(TIME.astype(str)), "given: the index is of type .*; expected time in s, as numbers"),
        (RUN.set_axis(TIME[::-1]), r"given: time\[1\] = 0.48 s after 0.49 s; expected it to increase"),
        (RUN.set_axis(np.where(np.arange(50) == 3, np.nan, TIME)), r"given: time\[3\] = nan s after 0.02 s"),
    ],
)
def test_a_frame_holds_numbers_by_time(frame: pd.DataFrame, told: str) -> None:
    with pytest.raises(tl.DatasetError, match=told):
        JOINT.simulate(frame)


def given(value: Any) -> Any:
    return value


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: JOINT.simulate(given("run-1")), "experiment is of type str: expected an experiment of a dataset"),
        (lambda: JOINT.simulate(given({"motor_torque": [1.0]})), "experiment is of type dict"),
        (lambda: tl.sweep(JOINT, {"coulomb": [0.1]}, experiment=given("run-1")), "experiment is of type str"),
        (lambda: tl.sweep(JOINT, {"coulomb": given(["a"])}, experiment=RUN), "coulomb = ['a']: expected a list"),
        (lambda: JOINT.with_parameters({"coulomb": given("0.1")}), "coulomb = '0.1': expected a value in [0, inf)"),
        (lambda: JOINT.with_parameters({"coulomb": given(None)}), "coulomb = None: expected a value in"),
        (lambda: JOINT.with_parameters({"coulomb": given(np.ones(2))}), "coulomb = array([1., 1.]): expected a value"),
        (lambda: JOINT.with_effects(given(["joint:stribeck"])), "effects = ['joint:stribeck']: expected {effect: {"),
        (lambda: JOINT.with_effects(given({"joint:stribeck": 0.1})), "expected {effect: {parameter: value}}"),
        (
            lambda: tl.System(kind="rigid_joint", parameters=VALUES, effects=given("joint:coulomb")),
            "effects = 'joint:coulomb': expected a list such as ['joint:coulomb']",
        ),
        (lambda: tl.identify(given("folder")), "dataset = 'folder': expected a Dataset, which tendonlab.load makes"),
        (lambda: tl.diagnose(given("folder")), "dataset = 'folder': expected a Dataset"),
        (lambda: tl.system_info(given(None)), "system kind = None: expected one of rigid_joint"),
    ],
)
def test_what_is_given_is_named(call: Callable[[], Any], told: str) -> None:
    with pytest.raises(tl.ParameterError, match=re.escape(told)):
        call()

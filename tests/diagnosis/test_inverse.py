"""Inverse dynamics: each friction amplitude of an axis is a column of its regression."""

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.diagnosis.answer.inverse import amplitudes, effort_column

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

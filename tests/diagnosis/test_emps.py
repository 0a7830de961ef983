"""A measured machine axis: friction that its simulator lacks is named in the right order, and nothing else."""

from typing import Any

import numpy as np
import pytest

pytestmark = pytest.mark.slow


def test_coulomb_friction_is_named_first_and_then_its_dependence_on_direction(emps: Any) -> None:
    _, found = emps
    assert found.selected == ("joint:coulomb", "joint:asymmetry")
    assert found.verdict == "effect"
    assert found.effects[0].name == "joint:coulomb"
    for name in ("joint:stribeck", "actuation:delay", "sensor.joint_angle:delay", "cable:backlash"):
        assert name not in found.selected


def test_held_out_error_falls_effect_by_effect(emps: Any) -> None:
    _, found = emps
    errors = [step["rms"]["joint_angle"] for step in found.details["steps"]]
    assert [step["effects"] for step in found.details["steps"]] == [
        [],
        ["joint:coulomb"],
        ["joint:coulomb", "joint:asymmetry"],
    ]
    assert errors[0] > 6e-6
    assert errors[1] <= 3.0e-6
    assert errors[2] <= 2.8e-6
    assert found.gap["joint_angle"]["with_effect"] == pytest.approx(errors[2])


def test_inverse_dynamics_beside_it_gives_the_published_values(emps: Any) -> None:
    """Janot, Gautier, Brunot 2019: 95.11 kg, 203.5 N s/m, 20.39 N, an offset of 3.16 N."""
    _, found = emps
    table = found.table.frame
    row = table.loc["nominal structure + joint:coulomb"]
    assert row["inertia"] == pytest.approx(95.11, rel=2e-3)
    assert row["viscous"] == pytest.approx(203.5, rel=2e-2)
    assert row["coulomb"] == pytest.approx(20.39, rel=2e-2)
    assert abs(row["actuation_offset"]) * 35.1507 == pytest.approx(3.16, rel=2e-2)
    assert np.all(np.diff(table["held-out rms"]) < 0)


def test_what_one_record_without_repeats_cannot_say_is_said(emps: Any) -> None:
    _, found = emps
    assert any("No repeated runs" in warning for warning in found.warnings)
    assert not found.calibrated

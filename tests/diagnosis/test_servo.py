"""A measured servo: friction in proportion to the load is named, and what else is missing stays unknown."""

from pathlib import Path
from typing import Any

import pytest

import tendonlab as tl

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def found(measured_servo: Path) -> Any:
    return tl.diagnose(tl.load(measured_servo), progress=False)


def test_load_dependent_friction_is_named_and_something_else_is_missing(found: Any) -> None:
    """As its authors found (Duclusaud, Passault, Padois, Ly, ICRA 2025)."""
    assert found.verdict == "unknown_effect"
    assert found.selected == ("joint:load_dependence",)
    assert any("weighed by parts of 1 s" in warning for warning in found.warnings)
    assert not found.calibrated  # no blind series was weighed so


def test_the_held_out_gain_is_predicted_far_better_with_it(found: Any) -> None:
    errors = found.gap["joint_angle"]
    assert errors["refitted"] > 0.09
    assert errors["with_effect"] < 0.065

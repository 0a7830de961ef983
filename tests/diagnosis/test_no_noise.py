"""What tuning leaves where nothing repeats: noise, or something that is missing."""

from dataclasses import replace
from typing import Any

import pytest

from tendonlab.diagnosis.answer.verdict import Levels, decide
from tendonlab.diagnosis.discrepancy import (
    BEYOND_SCATTER,
    BEYOND_SENSORS,
    FAR_SCATTERED,
    FAR_TRAINED,
    FOLLOWED,
    RINGS,
    Patterns,
)


@pytest.mark.parametrize(
    "signs",
    [
        {"trained": 1.5 * FAR_TRAINED},
        {"patterns": Patterns(2.0 * FOLLOWED)},
        {"patterns": Patterns(0.0, 2.0 * RINGS)},
        {"scattered": 1.5 * FAR_SCATTERED},
        {"tuned": 1.5 * BEYOND_SENSORS, "trained": 1.5 * BEYOND_SCATTER},
    ],
)
def test_what_friction_does_not_scatter_or_what_follows_the_motion_is_no_noise(signs: dict[str, Any]) -> None:
    near = Levels(nominal=1e4, tuned=1.0, refitted=2.0, explained=None, left=2.0, repeated=False)
    assert decide((), (), near).verdict == "parameters_only"
    found = decide((), (), replace(near, **signs))
    assert found.verdict == "unknown_effect"
    assert found.probability["parameters_only"] < 0.05


@pytest.mark.parametrize("signs", [{"tuned": 4.0 * BEYOND_SENSORS}, {"trained": 1.5 * BEYOND_SCATTER}])
def test_what_sensors_or_friction_that_differs_may_leave_is_noise(signs: dict[str, float]) -> None:
    near = Levels(nominal=1e4, tuned=1.0, refitted=2.0, explained=None, left=2.0, repeated=False)
    assert decide((), (), replace(near, **signs)).verdict == "parameters_only"

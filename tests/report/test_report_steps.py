"""The table of errors effect by effect, and the proposals, as blocks of the report."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from tendonlab.report.diagnosis import Diagnosis
from tendonlab.report.sections.computation import _plainly, _steps
from tendonlab.report.sections.extent import _overlay_caption, _stages_explained
from tendonlab.report.sections.next_steps import next_steps


def test_errors_are_listed_step_by_step_in_one_unit() -> None:
    details = {
        "steps": [
            {"effects": [], "rms": {"joint_angle": 0.022, "motor_torque": 0.5}},
            {"effects": ["joint:stribeck"], "rms": {"joint_angle": 0.0013, "motor_torque": 0.25}},
        ]
    }
    diagnosis: Any = SimpleNamespace(
        details=details, units={"joint_angle": "rad", "motor_torque": "N*m"}, system="two_inertia"
    )
    (table,) = _steps(diagnosis)
    shown: Any = table
    assert list(shown.columns) == ["Effects added", "Joint angle (mrad)", "Motor torque (mN·m)"]
    assert [[cell.text for cell in row] for row in shown.rows] == [
        ["None (refitted)", "22", "500"],
        ["Stribeck friction at the joint", "1.3", "250"],
    ]
    assert shown.right == frozenset({1, 2})
    diagnosis.details = {}
    assert _steps(diagnosis) == []


def test_settings_are_said_plainly() -> None:
    assert (
        _plainly({"over": "experiments", "sizes": [1, 2.5], "none": []}) == "over experiments; sizes 1, 2.5; none none"
    )
    assert [_plainly(value) for value in (True, False, None)][:2] == ["yes", "no"]


def test_proposals_name_what_they_separate_and_by_how_much(with_effect: Diagnosis) -> None:
    blocks: list[Any] = next_steps(with_effect)
    points = next(block for block in blocks if hasattr(block, "items"))
    ((what, purpose),) = points.items
    assert what == "Slow joint reversals at 0.01–0.2 rad/s"
    assert "Stribeck friction at the joint" in purpose
    assert "35" in purpose
    assert points.style == "numbered"
    assert any("in nats" in getattr(block, "text", "") for block in blocks)
    (entry,) = with_effect.next_experiments
    follows = {"description": "a sweep", "separates": ["joint_velocity", "time"], "expected_gain": 12.0}
    covers = {"description": "reversals", "separates": [], "expected_gain": 4.0, "reference": "next-2.csv"}
    turns = {"description": "reversals", "separates": ["joint_history", "time"], "expected_gain": 3.0}
    told = replace(with_effect, next_experiments=({**follows, "reference": "next-1.csv"}, covers, turns))
    rows: Any = next(block for block in next_steps(told) if hasattr(block, "items"))
    assert [purpose for _, purpose in rows.items] == [
        "separates errors that follow the joint velocity from errors that follow time; expected evidence 12 nats; "
        "reference in next-1.csv",
        "expected information 4 nats; reference in next-2.csv",
        "separates errors that follow the way of the joint since its last reversal from errors that follow time; "
        "expected evidence 3 nats",
    ]
    without = replace(with_effect, next_experiments=({**entry, "expected_gain": None},))
    assert not any("in nats" in getattr(block, "text", "") for block in next_steps(without))
    texts = {}
    for verdict in ("effect", "unknown_effect"):
        nothing: Any = SimpleNamespace(next_experiments=(), verdict=verdict)
        (only,) = next_steps(nothing)
        told: Any = only
        texts[verdict] = told.text
    assert texts["effect"].endswith("is proposed: no other cause competes with what was named.")
    assert texts["unknown_effect"] == "No further measurement is proposed."


@pytest.mark.parametrize(("outputs", "said"), [(2, False), (4, False), (5, True)])
def test_a_caption_says_that_outputs_are_left_out_where_more_than_four_were_measured(
    with_effect: Diagnosis, outputs: int, said: bool
) -> None:
    (run,) = with_effect.overlays
    rows = {f"angle_{k}": run.measured["joint_angle"] for k in range(outputs)}
    stages = dict.fromkeys(("measured", "nominal", "refitted", "with_effect"), rows)
    caption = _overlay_caption(replace(run, floor=dict.fromkeys(rows, 1e-3), **stages))  # type: ignore[arg-type]
    assert ("The 4 outputs that carry most of the gap are drawn" in caption) == said


def test_the_stages_say_which_effect_was_added_or_that_none_was(with_effect: Diagnosis) -> None:
    assert _stages_explained(with_effect).endswith("With effect: Stribeck friction at the joint added.")
    assert _stages_explained(replace(with_effect, selected=())).endswith("No effect was added.")

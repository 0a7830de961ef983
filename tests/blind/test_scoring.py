"""Scores of blind cases on stated truths and reports: what is right, what is an alarm, and how shares are counted."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tendonlab.blind.runner import REPORT, VERDICTS
from tendonlab.blind.scoring import Score, compared, score

TRUTH = {"effects": ["joint:stribeck"], "accept": ["motor:stribeck"], "verdict": "effect"}


def report(*ranked: str, verdict: str = "effect", selected: tuple[str, ...] = (), **more: Any) -> dict[str, Any]:
    """Effects by falling probability, listed the other way round."""
    effects = []
    for k, name in enumerate(ranked):
        element, _, effect = name.partition(":")
        effects.append({"element": element, "effect": effect, "probability": 0.8 / 2**k})
    return {"verdict": verdict, "selected": list(selected), "effects": effects[::-1], **more}


@pytest.mark.parametrize(
    ("given", "hits"),
    [
        (report("joint:stribeck", "b:c", selected=("joint:stribeck",)), (True, True, True, True, True, True)),
        (report("motor:stribeck", selected=("motor:stribeck",)), (True, True, True, True, True, True)),  # accepted
        (report("joint:stribeck"), (False, True, True, True, True, True)),  # ranked first, and yet not selected
        (
            report("joint:stribeck", verdict="parameters_only", selected=("joint:stribeck",)),
            (False, True, True, True, True, False),
        ),
        (
            report("joint:stribeck", verdict="unknown_effect", selected=("joint:stribeck",)),
            (True, True, True, True, True, False),
        ),
        (report("cable:stribeck", "a:b", "joint:stribeck"), (False, False, True, True, False, True)),
        (report("joint:viscous", "a:b", "c:d", "joint:stribeck"), (False, False, False, False, True, True)),
        (report(verdict="failed"), (False, False, False, False, False, False)),
    ],
)
def test_an_effect_is_right_in_six_ways(given: dict[str, Any], hits: tuple[bool, ...]) -> None:
    found = compared(TRUTH, given)
    names = ("top1", "ranked_first", "top3", "class_hit", "element_hit", "verdict_hit")
    assert tuple(found[name] for name in names) == hits
    assert "false_alarm" not in found
    assert found["failed"] == (given["verdict"] == "failed")


@pytest.mark.parametrize(
    ("given", "alarm"),
    [
        (report("a:b", verdict="no_gap"), False),
        (report("a:b", verdict="parameters_only"), False),
        (report("a:b", verdict="no_gap", selected=("a:b",)), True),
        (report("a:b", verdict="effect"), True),
        (report("a:b", verdict="unknown_effect"), True),
        (report(verdict="failed"), True),
        (report(verdict="data_fault"), False),
    ],
)
def test_where_nothing_is_missing_an_effect_is_a_false_alarm(given: dict[str, Any], alarm: bool) -> None:
    assert compared({"effects": [], "verdict": "no_gap"}, given)["false_alarm"] == alarm


def test_first_probability_shrinkage_and_seconds_are_those_of_the_report() -> None:
    shrunk = {"shrinkage": {"from_refitted": {"value": 0.9}}, "seconds": 12.0}
    found = compared(TRUTH, report("x:y", "z:w", selected=("x:y", "z:w"), **shrunk))
    assert (found["first"], found["probability"], found["selected"]) == ("x:y", 0.8, "x:y,z:w")
    assert (found["shrinkage"], found["seconds"]) == (0.9, 12.0)
    assert np.isnan(compared(TRUTH, report("x:y"))["shrinkage"])  # type: ignore[call-overload]
    assert compared(TRUTH, report(verdict="failed"))["shrinkage"] == 0.0


def test_the_probability_of_the_truth_is_that_of_the_effect_and_its_twin() -> None:
    assert compared(TRUTH, report("joint:stribeck", "a:b", "motor:stribeck"))["true_probability"] == 0.8 + 0.2
    assert compared(TRUTH, report("a:b"))["true_probability"] == 0.0
    assert compared(TRUTH, report(verdict="failed"))["true_probability"] == 0.0


@pytest.mark.parametrize(
    ("draw", "selected", "covered"),
    [
        ({"is_documented_form": True}, ("joint:stribeck",), 0.5),
        ({"is_documented_form": False}, ("joint:stribeck",), np.nan),  # another form has no such parameter
        ({"is_documented_form": True}, (), np.nan),
    ],
)
def test_intervals_of_a_selected_true_effect_cover_or_not(
    draw: dict[str, Any], selected: tuple[str, ...], covered: float
) -> None:
    """One parameter inside its interval, by its full name, one outside, and one that nothing bounds."""
    given = report("joint:stribeck", selected=selected)
    given["effects"][0]["parameters"] = {
        "static_excess": {"value": 0.1, "ci95": [0.08, 0.12]},
        "stribeck_velocity": {"value": 0.02, "ci95": [0.01, 0.03]},
        "shape": {"value": 2.0, "ci95": None},
    }
    values = {"joint_static_excess": 0.11, "static_excess": 9.0, "stribeck_velocity": 0.04, "shape": 2.0}
    found = compared({**TRUTH, "draw": draw, "truth": values}, given)["covered"]
    np.testing.assert_equal(found, covered)


CASES: dict[str, tuple[dict[str, Any], dict[str, Any] | None]] = {
    "a": ({**TRUTH, "draw": {"gap_noise": 1.0}}, report("joint:stribeck", selected=("joint:stribeck",), seconds=10.0)),
    "b": ({**TRUTH, "draw": {"gap_noise": 1.9, "repeats": False}}, report("x:y", selected=("x:y",), seconds=20.0)),
    "c": ({"effects": [], "verdict": "no_gap"}, report("x:y", selected=("x:y",), seconds=30.0)),
    "d": ({"effects": [], "verdict": "no_gap"}, report("x:y", verdict="no_gap", seconds=40.0)),
    "e": ({"effects": [], "verdict": "parameters_only"}, report("x:y", verdict="parameters_only", seconds=50.0)),
    "f": ({"effects": ["load:offset"], "verdict": "effect", "draw": {"gap_noise": 4.0}}, None),
}


@pytest.fixture
def scored(tmp_path: Path) -> Score:
    sealed, reports = tmp_path / "sealed", tmp_path / "reports"
    sealed.mkdir()
    told = {}
    for name, (truth, given) in CASES.items():
        draw = truth.get("draw", {})
        lines = ['format = "tendonlab-sealed/1"', f"effects = {json.dumps(truth['effects'])}"]
        lines += [f"accept = {json.dumps(truth.get('accept', []))}", f'verdict = "{truth["verdict"]}"', "[draw]"]
        lines += [f"{key} = {json.dumps(value)}" for key, value in draw.items()]
        (sealed / f"{name}.toml").write_text("\n".join(lines), encoding="utf-8")
        if given is not None:
            (reports / name).mkdir(parents=True)
            text = json.dumps(given)
            (reports / name / REPORT).write_text(text, encoding="utf-8")
            told[name] = {"verdict": given["verdict"], "sha256": hashlib.sha256(text.encode()).hexdigest()}
    (reports / VERDICTS).write_text(json.dumps({"reports": told}), encoding="utf-8")
    return score(sealed, reports)


def test_shares_count_every_truth_and_alarms_of_their_own_truth(scored: Score) -> None:
    summary = scored.summary
    assert (summary["cases"], summary["single effects"], summary["failed"]) == (6.0, 3.0, 1.0)
    assert (summary["top1"], summary["verdict right"]) == (pytest.approx(1 / 3), pytest.approx(4 / 6))
    assert (summary["false alarms on no_gap"], summary["false alarms on parameters_only"]) == (0.5, 0.0)
    assert summary["seconds per case"] == pytest.approx(30.0)
    assert scored.parts["without repeats"]["cases"] == 1.0
    assert scored.parts["with repeats"]["single effects"] == 2.0


def test_tables_are_by_verdict_strength_and_effect(scored: Score) -> None:
    assert scored.verdicts.loc["no_gap"].to_dict() == {"effect": 1, "failed": 0, "no_gap": 1, "parameters_only": 0}
    assert scored.strengths["cases"].to_dict() == {"[1.0, 2.0)": 2, "[4.0, inf)": 1}
    assert scored.strengths["top1"].to_dict() == {"[1.0, 2.0)": 0.5, "[4.0, inf)": 0.0}
    assert scored.effects["cases"].to_dict() == {"joint:stribeck": 2, "load:offset": 1}
    assert "by gap/noise" in str(scored)
    assert len(json.loads(json.dumps(scored.to_dict(), allow_nan=False))["cases"]) == 6


def test_a_share_of_no_cases_is_printed_as_a_dash(scored: Score) -> None:
    """No truth is an unknown effect, and only cases with repeats are false alarms."""
    lines = str(scored).splitlines()
    assert "unknown recall               – (n = 0)" in lines
    assert any(line.startswith("false alarms on no_gap") and line.endswith(" –") for line in lines)
    assert "nan" not in str(scored).lower()

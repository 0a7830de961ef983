"""S3's own gap, withheld on its twin, must be ranked first: slack, lost pretension, presliding."""

from __future__ import annotations

import pytest

import tendonlab as tl
from tendonlab.errors import ParameterError
from tendonlab.papers.s3 import withheld


@pytest.fixture(scope="module")
def found() -> dict[str, tl.Diagnosis]:
    """Each case once."""
    return {
        name: tl.diagnose(withheld(name).dataset(), progress=False)
        for name in ("slack", "pretension_loss", "presliding")
    }


@pytest.mark.parametrize("case", ["slack", "pretension_loss", "presliding"])
def test_what_is_withheld_is_ranked_first_and_established(case: str, found: dict[str, tl.Diagnosis]) -> None:
    why, wanted = found[case], withheld(case).effect
    assert why.effects[0].name == wanted
    assert wanted in why.selected
    assert why.effects[0].probability > 0.9


def test_slack_explains_the_gap(found: dict[str, tl.Diagnosis]) -> None:
    """The loose tendon carries nothing: amplitude 1; the twin's presliding and inertia leave it a little less."""
    why = found["slack"]
    assert why.verdict == "effect"
    assert why.shrinkage["from_nominal"]["value"] > 0.85
    assert why.shrinkage["from_refitted"]["value"] > 0.7
    assert why.effects[0].parameters["slack"]["value"] == pytest.approx(1.0, abs=0.25)


def test_lost_pretension_is_told_by_its_share(found: dict[str, tl.Diagnosis]) -> None:
    """0.2 is missing; the simulator's own friction coefficient is 2 % too large, which looks the same."""
    why = found["pretension_loss"]
    assert why.verdict == "effect"
    assert why.shrinkage["from_nominal"]["value"] > 0.85
    assert why.effects[0].parameters["pretension_loss"]["value"] == pytest.approx(0.2, abs=0.06)


def test_presliding_and_the_drive_s_inertia_are_both_found(found: dict[str, tl.Diagnosis]) -> None:
    """The twin's drive has 0.05 kg·m², behind which its torque is not known."""
    why = found["presliding"]
    inertia = next(e for e in why.effects if e.name == "actuation:drive_inertia")
    assert inertia.name in why.selected
    assert inertia.parameters["inertia"]["value"] == pytest.approx(0.05, abs=0.02)
    assert why.shrinkage["from_nominal"]["value"] > 0.7


def test_an_unknown_case_is_named() -> None:
    with pytest.raises(ParameterError, match="did you mean 'slack'"):
        withheld("slak")

"""S3's own gap, withheld on its twin, must be ranked first: slack, lost pretension, presliding, uneven bends."""

from __future__ import annotations

import pytest

import tendonlab as tl
from diagnoses import diagnose, evidence
from tendonlab.errors import ParameterError
from tendonlab.papers.s3 import withheld

PRESENT = {"sheath:viscous", "actuation:drive_inertia", "sheath:distributed_presliding"}  # in every twin
CASES = ("slack", "pretension_loss", "presliding", "skew")
IMITATED = ["sensor.output_torque:delay", "sheath:distributed_presliding", "cable:compliance"]
IMITATED += ["sheath:viscous", "actuation:drive_inertia"]


@pytest.fixture(scope="module")
def found() -> dict[str, tl.Diagnosis]:
    """Each case once, by a simulator that knows nothing of the viscous friction but that there may be some."""
    return {name: diagnose(withheld(name).dataset()) for name in CASES}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.slow
def test_what_is_withheld_is_ranked_first_and_nothing_that_is_not_there_is_named(
    case: str, found: dict[str, tl.Diagnosis]
) -> None:
    why, wanted = found[case], withheld(case).effect
    others = [e.name for e in why.effects if e.name not in PRESENT - {wanted}]  # those are missing as well
    assert others[0] == wanted
    assert evidence(why, wanted) > 0.9
    assert wanted in why.selected
    assert set(why.selected) <= {wanted} | PRESENT
    assert why.verdict == "effect"


@pytest.mark.slow
def test_slack_explains_the_gap(found: dict[str, tl.Diagnosis]) -> None:
    """The loose tendon carries nothing: amplitude 1."""
    why = found["slack"]
    assert why.shrinkage["from_nominal"]["value"] > 0.9
    assert why.shrinkage["from_refitted"]["value"] > 0.8
    assert why.effects[0].parameters["slack"]["value"] == pytest.approx(1.0, abs=0.15)


@pytest.mark.slow
def test_lost_pretension_is_told_by_its_share(found: dict[str, tl.Diagnosis]) -> None:
    """0.2 is missing; the simulator's own friction coefficient is 2 % too large, which looks the same."""
    why = found["pretension_loss"]
    assert why.shrinkage["from_nominal"]["value"] > 0.9
    assert why.effects[0].parameters["pretension_loss"]["value"] == pytest.approx(0.2, abs=0.04)


@pytest.mark.slow
def test_uneven_bends_are_told_from_a_gain_of_a_sensor(found: dict[str, tl.Diagnosis]) -> None:
    """Three wrap angles: the gain grows with their square. The twin's skew is 0.9."""
    why = found["skew"]
    skew = next(e for e in why.effects if e.name == "sheath:curvature_skew")
    assert skew.parameters["curvature_skew"]["value"] == pytest.approx(0.9, abs=0.1)
    assert why.shrinkage["from_nominal"]["value"] > 0.8
    assert why.shrinkage["from_refitted"]["value"] > 0.55


@pytest.mark.slow
def test_presliding_and_the_drive_s_inertia_are_both_found(found: dict[str, tl.Diagnosis]) -> None:
    """The twin's drive has 0.05 kg·m², its bristles 4e-3 rad before a load of 20 N·m/rad."""
    why = found["presliding"]
    inertia = next(e for e in why.effects if e.name == "actuation:drive_inertia")
    assert inertia.name in why.selected
    assert inertia.parameters["inertia"]["value"] == pytest.approx(0.05, abs=0.015)
    assert why.effects[0].parameters["turnover_rise"]["value"] == pytest.approx(0.08, rel=0.25)
    assert why.shrinkage["from_nominal"]["value"] > 0.8
    assert why.shrinkage["from_refitted"]["value"] > 0.55


@pytest.mark.slow
def test_an_imitation_gives_way_to_what_it_imitated() -> None:
    """By the model as printed, without any viscous friction, a delay of the sensor explains most alone: before a load
    that is a spring, torque rises with velocity. Beside the presliding, viscous friction and inertia explain more."""
    why = diagnose(withheld("presliding").dataset(viscous=False), library=IMITATED)
    assert set(why.selected) == PRESENT
    assert {e.name for e in why.effects[:3]} == PRESENT
    delay = next(e for e in why.effects if e.name == "sensor.output_torque:delay")
    assert delay.probability < 0.05
    viscous = next(e for e in why.effects if e.name == "sheath:viscous")
    assert viscous.parameters["viscous"]["value"] == pytest.approx(
        0.55, rel=0.15
    )  # ten nodes of 0.05, the drive's 0.05
    assert why.verdict == "effect"
    assert why.shrinkage["from_refitted"]["value"] > 0.75


def test_an_unknown_case_is_named() -> None:
    with pytest.raises(ParameterError, match="did you mean 'slack'"):
        withheld("slak")

"""The verdict from what tuning leaves: an assumed floor excuses some of it, and no more."""

from dataclasses import replace

import pytest

import tendonlab as tl
from tendonlab.cli.demo import bundled
from tendonlab.diagnosis.answer.verdict import FAR, Levels, Verdict, decide


def nothing_selected(*, refitted: float, repeated: bool = False, tuned: float = 1.0) -> Verdict:
    levels = Levels(nominal=1e4, tuned=tuned, refitted=refitted, explained=None, repeated=repeated)
    return decide((), (), levels)


def test_tuning_explains_what_it_brings_near_an_assumed_floor() -> None:
    assert nothing_selected(refitted=0.5 * FAR).verdict == "parameters_only"


@pytest.mark.parametrize("left", [1.5 * FAR, 1e6])
def test_what_lies_far_above_an_assumed_floor_is_no_noise(left: float) -> None:
    found = nothing_selected(refitted=left)
    assert found.verdict == "unknown_effect"
    assert found.probability["parameters_only"] < 0.01


def test_where_runs_repeat_they_decide_and_not_the_plain_floor() -> None:
    assert nothing_selected(refitted=1e6, repeated=True, tuned=1.1).verdict == "parameters_only"
    assert nothing_selected(refitted=1.0, repeated=True, tuned=2.0).verdict == "unknown_effect"


@pytest.mark.cpu(10)
def test_without_repeats_a_missing_effect_is_not_called_a_matter_of_parameters() -> None:
    """The bundled rig lacks Stribeck friction; a library that holds only the bias of a sensor cannot explain it."""
    rig = tl.load(bundled())
    alone = replace(rig, experiments=tuple(replace(e, repeat=None) for e in rig))
    found = tl.diagnose(alone, library=["sensor.joint_angle:bias"], progress=False)
    assert (found.selected, found.verdict) == ((), "unknown_effect")

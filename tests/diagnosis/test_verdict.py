"""The verdict from what tuning leaves: an assumed floor excuses some of it, and no more."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.cli.demo import bundled
from tendonlab.diagnosis.answer.verdict import (
    FAR,
    FAR_REPEATED,
    LARGELY,
    MOST,
    PARTLY,
    STRAINED,
    STRAINED_BESIDE,
    Levels,
    Verdict,
    _group,
    decide,
    marginals,
)
from tendonlab.diagnosis.discrepancy import (
    FAR_TRAINED,
    FOLLOWED,
    FOLLOWED_BESIDE,
    FOLLOWED_REPEATED,
    RINGS,
    Patterns,
)
from tendonlab.diagnosis.drift import RARE


def nothing_selected(*, refitted: float, repeated: bool = False, tuned: float = 1.0) -> Verdict:
    levels = Levels(nominal=1e4, tuned=tuned, refitted=refitted, explained=None, left=refitted, repeated=repeated)
    return decide((), (), levels)


def test_tuning_explains_what_it_brings_near_an_assumed_floor() -> None:
    assert nothing_selected(refitted=0.5 * FAR).verdict == "parameters_only"


@pytest.mark.parametrize("left", [1.5 * FAR, 1e6])
def test_what_lies_far_above_an_assumed_floor_is_no_noise(left: float) -> None:
    found = nothing_selected(refitted=left)
    assert found.verdict == "unknown_effect"
    assert found.probability["parameters_only"] < 0.01


@pytest.mark.parametrize("repeated", [False, True])
def test_tuning_is_not_all_where_it_strains_what_was_stated(repeated: bool) -> None:
    """By how much turns the verdict, without a step."""
    near = Levels(nominal=1e4, tuned=1.0, refitted=1.0, explained=None, left=1.0, repeated=repeated)
    found = [decide((), (), replace(near, strained=s * STRAINED)) for s in (0.0, 0.5, 0.95, 1.05, 4.0)]
    told = ["parameters_only"] * 3 + ["unknown_effect"] * 2
    assert [verdict.verdict for verdict in found] == told
    unknown = [verdict.probability["unknown_effect"] for verdict in found]
    assert unknown == sorted(unknown)
    assert unknown[1] < 0.1 < 0.9 < unknown[-1]


@pytest.mark.parametrize("repeated", [False, True])
@pytest.mark.parametrize("nominal", [1.05, 1e4])
def test_friction_that_follows_the_session_is_nothing_that_the_library_has(repeated: bool, nominal: float) -> None:
    near = Levels(nominal=nominal, tuned=1.0, refitted=1.0, explained=None, left=1.0, repeated=repeated)
    assert decide((), (), near).verdict in ("no_gap", "parameters_only")
    found = decide((), (), replace(near, drifted=0.1 * RARE))
    assert found.verdict == "unknown_effect"
    assert found.probability["unknown_effect"] > 0.5


def test_held_out_experiments_at_the_floor_are_no_answer_while_training_ones_are_far() -> None:
    near = Levels(nominal=1.05, tuned=1.0, refitted=1.0, explained=None, left=1.0, repeated=False)
    assert decide((), (), near).verdict == "no_gap"
    found = decide((), (), replace(near, trained=12.0))
    assert found.verdict == "unknown_effect"
    assert found.probability["no_gap"] < found.probability["unknown_effect"]


@pytest.mark.parametrize("repeated", [False, True])
def test_an_effect_beside_friction_that_follows_the_session_is_not_the_whole_answer(repeated: bool) -> None:
    rounds = (contest((), "a", a=0.99, none=0.01),)
    near = Levels(nominal=1e4, tuned=9.0, refitted=9.0, explained=1.0, left=1.0, repeated=repeated)
    assert decide(rounds, ("a",), near).verdict == "effect"
    assert decide(rounds, ("a",), replace(near, drifted=0.1 * RARE)).verdict == "unknown_effect"


@pytest.mark.parametrize(("repeated", "tuned", "refitted"), [(False, 9.0, 1.42), (True, 1.22, 1.6)])
def test_where_tuning_gains_next_to_nothing_there_is_no_gap(repeated: bool, tuned: float, refitted: float) -> None:
    """A floor that is assumed, or from few repeats, may be too low: what tuning does not shrink is no parameter."""
    levels = Levels(
        nominal=1.45 if not repeated else 1.25,
        tuned=tuned,
        refitted=refitted,
        explained=None,
        left=refitted,
        repeated=repeated,
    )
    found = decide((), (), levels)
    assert found.verdict == "no_gap"
    assert found.probability["no_gap"] > 2.0 * found.probability["parameters_only"]
    shrunk = replace(levels, tuned=0.8 * levels.nominal, refitted=0.8 * levels.nominal)
    assert decide((), (), shrunk).verdict == "parameters_only"


@pytest.mark.parametrize("repeated", [False, True])
def test_a_simulator_without_any_error_has_no_gap(repeated: bool) -> None:
    levels = Levels(nominal=0.0, tuned=0.0, refitted=0.0, explained=None, left=0.0, repeated=repeated)
    assert decide((), (), levels).verdict == "no_gap"


def test_noise_above_the_motion_of_every_output_speaks_for_no_verdict() -> None:
    levels = Levels(nominal=0.5, tuned=0.1, refitted=0.1, explained=None, left=0.1, repeated=False)
    assert decide((), (), levels).probability["no_gap"] > 0.8
    found = decide((), (), replace(levels, drowned=True))
    assert found.verdict == "no_gap"
    assert found.probability["no_gap"] < 0.3
    assert found.probability["data_fault"] == 0.0


def test_where_runs_repeat_training_runs_decide_unless_held_out_ones_are_far() -> None:
    assert nothing_selected(refitted=0.9 * FAR_REPEATED, repeated=True, tuned=1.0).verdict == "parameters_only"
    assert nothing_selected(refitted=1.1 * FAR_REPEATED, repeated=True, tuned=1.0).verdict == "unknown_effect"
    assert nothing_selected(refitted=1.0, repeated=True, tuned=2.0).verdict == "unknown_effect"
    far = nothing_selected(refitted=800.0, repeated=True, tuned=0.97)  # a stop that the training runs do not reach
    assert far.verdict == "unknown_effect"
    assert far.probability["unknown_effect"] > 0.9


def test_held_out_runs_that_are_far_are_no_gap_of_none() -> None:
    """A floor from few repeats may be too low, of training and held-out runs alike."""
    levels = Levels(nominal=1.05, tuned=1.0, refitted=2.3, explained=None, left=2.3, repeated=True)
    assert decide((), (), levels).verdict == "unknown_effect"
    assert decide((), (), replace(levels, refitted=1.0)).verdict == "no_gap"
    assert decide((), (), replace(levels, nominal=1.31, tuned=1.29)).verdict == "no_gap"


def test_what_follows_the_motion_is_something_unknown_where_repeats_tell_the_noise() -> None:
    """But not where the untouched simulator is at the floor: another integrator leaves as much."""
    near = Levels(nominal=1e4, tuned=1.1, refitted=1.0, explained=None, left=1.0, repeated=True, whitened=1.1)
    found = [
        decide((), (), replace(near, patterns=Patterns(share * FOLLOWED_REPEATED))) for share in (0.0, 0.5, 1.1, 3.0)
    ]
    assert [verdict.verdict for verdict in found] == ["parameters_only"] * 2 + ["unknown_effect"] * 2
    unknown = [verdict.probability["unknown_effect"] for verdict in found]
    assert unknown == sorted(unknown)
    assert unknown[1] < 0.1 < 0.9 < unknown[-1]
    at_floor = replace(near, nominal=1.05, patterns=Patterns(3.0 * FOLLOWED_REPEATED))
    assert decide((), (), at_floor).verdict == "no_gap"
    far_below = replace(near, whitened=0.9, patterns=Patterns(3.0 * FOLLOWED_REPEATED))
    assert decide((), (), far_below).verdict == "parameters_only"


@pytest.mark.parametrize(
    ("followed", "whitened", "verdict"),
    [(0.9, 2.0, "effect"), (1.1, 2.0, "unknown_effect"), (2.0, 1.2, "effect")],
)
def test_beside_effects_more_may_follow_the_motion_and_all_of_it_at_the_floor(
    followed: float, whitened: float, verdict: str
) -> None:
    rounds = (contest((), "a", a=0.99, none=0.01),)
    levels = Levels(nominal=50.0, tuned=20.0, refitted=20.0, explained=0.95, left=3.0, repeated=True, whitened=whitened)
    levels = replace(levels, patterns=Patterns(followed * FOLLOWED_BESIDE))
    assert decide(rounds, ("a",), levels).verdict == verdict


@pytest.mark.cpu(10)
def test_without_repeats_a_missing_effect_is_not_called_a_matter_of_parameters() -> None:
    """The bundled rig lacks Stribeck friction; a library that holds only the bias of a sensor cannot explain it."""
    rig = tl.load(bundled())
    alone = replace(rig, experiments=tuple(replace(e, repeat=None) for e in rig))
    found = tl.diagnose(alone, library=["sensor.joint_angle:bias"], progress=False)
    assert (found.selected, found.verdict) == ((), "unknown_effect")


def contest(base: tuple[str, ...], accepted: str | None, **probability: float) -> Any:
    """A round over named effects; `none`: that there is no further one."""
    chances: dict[str | None, float] = {name: p for name, p in probability.items() if name != "none"}
    trial = SimpleNamespace(effect=accepted) if accepted else None
    return SimpleNamespace(base=base, accepted=trial, probability={**chances, None: probability["none"]})


FIRST = contest(("b",), "a", a=0.8, c=0.15, none=0.05)
SECOND = contest(("a",), "b", b=0.6, c=0.3, none=0.1)
LAST = contest(("a", "b"), None, c=0.2, none=0.8)


def test_probabilities_of_effects_are_given_the_other_selected_ones() -> None:
    """Of the effects that were not selected only the last round counts in full proportion to the selected ones."""
    effects, _ = marginals((FIRST, SECOND, LAST))
    assert effects == pytest.approx({"a": 0.8, "b": 0.6, "c": 0.15 + 0.3 + 0.8 * 0.6 * 0.2})


def test_a_rival_is_no_likelier_than_what_was_selected_in_its_place() -> None:
    """Though it may also be there beside it. What was selected itself is not bounded by the others."""
    tie, more = contest((), "a", a=0.48, c=0.48, none=0.04), contest(("a",), None, c=0.2, none=0.8)
    assert marginals((tie, more))[0] == pytest.approx({"a": 0.48, "c": 0.48})
    first, second = contest(("b",), "a", a=0.5, b=0.3, none=0.2), contest(("a",), "b", b=0.9, none=0.1)
    assert marginals((first, second))[0] == pytest.approx({"a": 0.5, "b": 1.0})


def test_sets_are_each_alternative_with_what_was_selected_besides() -> None:
    _, sets = marginals((FIRST, SECOND, LAST))
    found = {tuple(s["effects"]): s["probability"] for s in sets}
    expected = {
        ("b", "c"): 0.6 * 0.15, ("b",): 0.6 * 0.05, ("a", "c"): 0.8 * 0.3, ("a",): 0.8 * 0.1,
        ("a", "b", "c"): 0.48 * 0.2, ("a", "b"): 0.48 * 0.8,
    }  # fmt: skip
    assert found == pytest.approx(expected)
    assert [s["probability"] for s in sets] == sorted(found.values(), reverse=True)


def test_effects_within_a_fifth_of_the_accepted_one_are_not_told_apart() -> None:
    assert _group(contest((), "a", a=0.5, b=0.11, c=0.09, none=0.3)) == ["a", "b"]
    assert _group(contest((), "a", a=0.9, b=0.05, none=0.05)) == []
    assert _group(contest((), None, a=0.5, b=0.5, none=0.0)) == []


def selected(
    *,
    nominal: float = 50.0,
    tuned: float = 20.0,
    explained: float | None = 0.9,
    left: float = 3.9,
    none: float = 0.01,
    repeated: bool = True,
    whitened: float = 2.0,
) -> Verdict:
    """The verdict where one effect was selected."""
    levels = Levels(
        nominal=nominal,
        tuned=tuned,
        refitted=tuned,
        explained=explained,
        left=left,
        repeated=repeated,
        whitened=whitened,
    )
    return decide((contest((), "a", a=1.0 - none, none=none),), ("a",), levels)


@pytest.mark.parametrize(
    ("explained", "repeated", "verdict"),
    [(0.9, True, "effect"), (0.74, True, "unknown_effect"), (None, True, "unknown_effect"), (0.74, False, "effect"),
     (0.61, False, "effect"), (0.59, False, "unknown_effect")],
)  # fmt: skip
def test_an_effect_is_the_answer_where_it_removes_three_quarters_of_the_excess_or_three_fifths_over_an_assumed_floor(
    explained: float | None, repeated: bool, verdict: str
) -> None:
    found = selected(explained=explained, repeated=repeated)
    assert found.verdict == verdict
    assert max(found.probability, key=lambda name: found.probability[name]) == verdict
    assert sum(found.probability.values()) == pytest.approx(1.0)


@pytest.mark.parametrize("repeated", [False, True])
@pytest.mark.parametrize(("explained", "verdict"), [(0.84, "unknown_effect"), (0.86, "effect"), (0.98, "effect")])
def test_what_is_left_far_above_the_floor_asks_for_more(explained: float, repeated: bool, verdict: str) -> None:
    found = selected(explained=explained, repeated=repeated, left=8.1)
    assert found.verdict == verdict
    assert explained < 0.9 or found.probability["effect"] > 0.95


@pytest.mark.parametrize(("left", "verdict"), [(3.9, "effect"), (5.6, "effect"), (5.8, "unknown_effect")])
def test_what_is_enough_grows_with_what_is_left(left: float, verdict: str) -> None:
    """Half way (in logarithms) from 4 to 8, an assumed floor asks for 72.5 %."""
    assert selected(explained=0.726, repeated=False, left=left).verdict == verdict


@pytest.mark.parametrize(
    ("explained", "whitened", "verdict"),
    [(0.61, 1.05, "effect"), (0.59, 1.05, "unknown_effect"), (0.61, 1.07, "unknown_effect")],
)
def test_three_fifths_are_enough_with_repeats_where_training_experiments_end_at_the_floor(
    explained: float, whitened: float, verdict: str
) -> None:
    assert selected(explained=explained, whitened=whitened).verdict == verdict


@pytest.mark.parametrize("explained", [None, 0.1])
@pytest.mark.parametrize(("left", "verdict"), [(1.0, "effect"), (1.1, "effect"), (1.3, "unknown_effect")])
def test_nothing_is_unknown_where_held_out_experiments_end_at_the_floor(
    explained: float | None, left: float, verdict: str
) -> None:
    """Short held-out experiments may lie at the floor with the effect and without it: nothing is left to explain."""
    found = selected(explained=explained, left=left)
    assert found.verdict == verdict
    assert found.probability[verdict] > 0.5


def test_verdict_probabilities_follow_the_share_that_is_explained() -> None:
    """Far above and far below three quarters nearly all of the probability is on one side."""
    assert selected(explained=1.0).probability["effect"] > 0.95
    assert selected(explained=0.2).probability["unknown_effect"] > 0.95
    assert selected(explained=1.0, none=0.3).probability["parameters_only"] < 1e-3  # tuning does not reach the floor
    assert selected(tuned=1.0, explained=1.0, none=0.3).probability["parameters_only"] > 0.2


@pytest.mark.parametrize(
    ("repeated", "explained", "probability"), [(True, 0.2, PARTLY), (True, MOST, LARGELY), (False, 0.2, LARGELY)]
)
def test_what_explains_a_part_only_may_imitate_the_unknown(
    repeated: bool, explained: float, probability: float
) -> None:
    partly = selected(explained=explained, repeated=repeated, left=9.0)
    assert partly.verdict == "unknown_effect"
    assert partly.effects["a"] == pytest.approx(0.99 * probability, rel=0.05)
    assert partly.sets[0] == {"effects": ["a"], "probability": pytest.approx(0.99 * probability, rel=0.05)}
    assert selected(explained=1.0, repeated=repeated).effects["a"] > 0.95


@pytest.mark.parametrize(
    "signs",
    [
        {"trained": 1.2 * FAR_TRAINED},
        {"patterns": Patterns(1.2 * FOLLOWED)},
        {"patterns": Patterns(0.0, 1.2 * RINGS)},
        {"strained": 1.5 * STRAINED_BESIDE},
    ],
)
def test_what_selected_effects_leave_must_be_noise(signs: dict[str, Any]) -> None:
    """A motor that fades looks like a gain error, which explains most of the held-out gap and leaves no noise. A
    tension in another unit looked like its bias, beside a wrap angle 287 sd from what was stated."""
    levels = Levels(nominal=50.0, tuned=20.0, refitted=20.0, explained=0.9, left=3.0, repeated=False)
    rounds = (contest((), "a", a=0.99, none=0.01),)
    assert decide(rounds, ("a",), levels).verdict == "effect"
    found = decide(rounds, ("a",), replace(levels, **signs))
    assert found.verdict == "unknown_effect"
    assert found.probability["effect"] < 0.3


def test_an_effect_that_was_established_near_the_floor_is_a_gap() -> None:
    """A slow effect hardly changes whitened residuals: the nominal simulator looks as if it were at the floor."""
    found = selected(nominal=1.05, tuned=1.02, explained=None, left=1.0)
    assert found.verdict == "effect"
    assert found.probability["effect"] > found.probability["no_gap"]


def test_tuning_gains_what_it_predicts_not_what_its_uncertainty_allows() -> None:
    levels = Levels(nominal=1.2, tuned=1.0, refitted=0.9, explained=None, left=0.9, repeated=False, predicted=1.19)
    assert decide((), (), levels).verdict == "no_gap"
    assert decide((), (), replace(levels, predicted=None)).verdict == "parameters_only"


def test_a_simulator_at_the_floor_has_no_gap() -> None:
    for nominal, tuned in ((1.1, 1.0), (1.2, 1.18)):  # below 1.15, or nothing to gain by tuning
        levels = Levels(nominal=nominal, tuned=tuned, refitted=1.0, explained=None, left=1.0, repeated=True)
        found = decide((), (), levels)
        assert found.verdict == "no_gap"
        assert max(found.probability, key=lambda name: found.probability[name]) == "no_gap"
    for nominal, tuned in ((1.2, 1.1), (1.4, 1.35)):
        levels = Levels(nominal=nominal, tuned=tuned, refitted=1.0, explained=None, left=1.0, repeated=True)
        assert decide((), (), levels).verdict != "no_gap"


@pytest.mark.parametrize(("relieved", "held_out", "verdict"), [
    (True, 3.0, "effect"), (False, 3.0, "unknown_effect"), (True, 1.5 * FAR, "unknown_effect"),
])  # fmt: skip
def test_what_may_be_noise_may_be_so_beside_an_effect_that_restores_belief(
    relieved: bool, held_out: float, verdict: str
) -> None:
    """The effect removes nothing of the held-out excess: without it tuning does as well, by what nobody believes."""
    levels = Levels(
        nominal=1e4, tuned=1.5, refitted=held_out, explained=0.0, left=held_out, repeated=False, relieved=relieved
    )
    won = contest((), "a", a=0.99, none=0.01)
    assert decide((won,), ("a",), levels).verdict == verdict


@pytest.mark.parametrize(
    ("relieved", "explained", "by_beliefs"),
    [(True, 0.3, True), (True, None, True), (True, 0.9, False), (False, 0.3, False)],
)
def test_effects_are_told_by_beliefs_where_held_out_experiments_hardly_speak_for_them(
    relieved: bool, explained: float | None, by_beliefs: bool
) -> None:
    levels = Levels(
        nominal=9.0, tuned=2.0, refitted=2.0, explained=explained, left=1.5, repeated=False, relieved=relieved
    )
    assert levels.is_by_beliefs is by_beliefs

"""What counts as found, and which probability was given to the truth."""

from dataclasses import replace

import pytest

from rehearsal.stubs import says
from tendonlab.rehearsal.judge import judged
from tendonlab.rehearsal.sizes import Ladder
from tendonlab.rehearsal.tally import effect_rehearsal, false_effects, nothing_withheld, reliability
from tendonlab.rehearsal.words import effect_words

TRUTH = "load:offset"


def test_the_true_effect_is_found() -> None:
    row = judged(says(TRUTH), TRUTH)
    assert (row["outcome"], row["right"], row["on_truth"], row["stated"]) == ("found", True, 0.9, 0.9)


def test_a_member_of_its_group_counts_and_the_group_is_summed() -> None:
    twin = "actuation:offset"
    row = judged(says(twin, others=(TRUTH,), group=(twin, TRUTH)), TRUTH)
    assert (row["outcome"], row["right"]) == ("tied", True)
    assert row["on_truth"] == pytest.approx(0.98)


def test_an_effect_that_is_selected_beside_something_unknown_must_be_likely() -> None:
    beside = replace(says(TRUTH), verdict="unknown_effect")
    assert judged(beside, TRUTH)["outcome"] == "found"
    unlikely = replace(beside, effects=(replace(beside.effects[0], probability=0.2),))
    row = judged(unlikely, TRUTH)
    assert (row["outcome"], row["right"], row["on_truth"]) == ("unknown", False, 0.2)


def test_another_effect_is_a_miss() -> None:
    row = judged(says("actuation:delay", others=(TRUTH,)), TRUTH)
    assert (row["outcome"], row["named"], row["right"]) == ("other", ["actuation:delay"], False)
    assert (row["on_truth"], row["stated"]) == (0.08, 0.9)


def test_nothing_is_right_only_where_nothing_was_withheld() -> None:
    assert judged(says(None), TRUTH)["right"] is False
    assert judged(says(None), "") == {
        "outcome": "nothing", "verdict": "parameters_only", "named": [], "on_truth": 0.9, "stated": 0.9, "right": True,
    }  # fmt: skip


def test_false_effects_are_counted_with_an_interval() -> None:
    rows = [{"effect": "", "gap": 0.0, **judged(says(None if k else TRUTH), "")} for k in range(20)]
    named = nothing_withheld(rows)["effect"]
    assert (named.hits, named.num) == (1, 20)
    assert named.ci95 == pytest.approx((0.0013, 0.2487), abs=1e-4)  # published table
    assert false_effects(rows) == {TRUTH: 1}


def test_reliability_leaves_out_what_is_too_small_to_be_seen() -> None:
    large = {"effect": TRUTH, "gap": 4.0, **judged(says(TRUTH), TRUTH)}
    wrong = {"effect": TRUTH, "gap": 2.0, **judged(says("actuation:delay"), TRUTH)}
    small = {"effect": TRUTH, "gap": 0.5, **judged(says(None), TRUTH)}
    on_truth, bins = reliability([large, wrong, small])
    assert on_truth == pytest.approx(0.45)  # of 0.9 and 0
    (only,) = bins
    assert (only.stated, only.mean, only.right.hits, only.right.num) == ((0.8, 0.95), 0.9, 1, 2)


def test_the_sentence_names_ties_and_wrong_answers() -> None:
    ladder = Ladder(TRUTH, "load_offset", "N*m", (0.001, 0.01), (0.5, 5.0), {})
    twin = says("actuation:offset", group=("actuation:offset", TRUTH))
    answers = [(0.5, says(None)), (0.5, says("actuation:delay")), *[(5.0, twin)] * 3, *[(5.0, says(TRUTH))] * 9]
    entry = effect_rehearsal(ladder, [{"effect": TRUTH, "gap": gap, **judged(why, TRUTH)} for gap, why in answers])
    assert [(size.gap, size.amount, size.found, size.tried) for size in entry.sizes] == [
        (0.5, pytest.approx(0.001), 0, 2),
        (5.0, pytest.approx(0.01), 12, 12),
    ]
    words = effect_words(entry, "rigid_joint")
    assert words.startswith("Constant disturbance on the load: found 9 times in 10 from offset")
    assert "In 3 of 14 rigs the data could not separate it from constant offset of the actuator (3)." in words
    assert "It was missed in 2 of 14 rigs and taken for nothing, or wrong parameters (1)" in words

"""Which rigs are simulated, in which order, and how many fit the time."""

import numpy as np

from tendonlab.rehearsal.cases import number_that_fits, ordered_cases

SIZES = (0.5, 1.0, 2.0, 4.0)
KNOWN = {name: {size: {"x": size} for size in SIZES} for name in ("a:one", "a:two")}


def test_a_beginning_of_the_order_is_balanced() -> None:
    cases = ordered_cases(KNOWN, SIZES, 2)
    assert len(cases) == 2 * len(SIZES) * (2 + 1)
    assert len({case.key for case in cases}) == len(cases)
    first = cases[: 2 * 3]  # two sizes, each with all effects and one rig without
    assert [case.gap for case in first if case.effect] == [2.0, 2.0, 1.0, 1.0]
    assert sum(not case.effect for case in first) == 2


def test_a_size_that_an_effect_cannot_reach_is_left_out() -> None:
    cases = ordered_cases({"a:one": {0.5: {"x": 1.0}}}, SIZES, 1)
    assert [case.gap for case in cases if case.effect] == [0.5]


def test_a_case_has_its_own_random_numbers_whatever_others_there_are() -> None:
    (one,) = [case for case in ordered_cases(KNOWN, SIZES, 1) if case.key == "a:two 4 0"]
    (same,) = [case for case in ordered_cases(KNOWN, SIZES, 3) if case.key == "a:two 4 0"]
    assert one.random(7).normal() == same.random(7).normal()
    assert one.random(7).normal() != one.random(8).normal()


def test_the_first_durations_tell_how_many_fit() -> None:
    assert number_that_fits([4.0, 6.0], seconds_left=100.0, jobs=2) == int(np.floor(0.95 * 100 * 2 / 5))
    assert number_that_fits([4.0], seconds_left=-3.0, jobs=2) == 0

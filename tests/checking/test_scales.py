"""How many samples of a residual count, and what a right factor must bring."""

from dataclasses import replace

import numpy as np
import pytest

from tendonlab.checking.regression import Fit
from tendonlab.checking.scales import (
    BLOCKING,
    Factor,
    _convinces,
    _helps,
    _is_credible,
    _leading,
    agrees,
    ranked,
    shares,
)


@pytest.mark.parametrize("times", [1, 5, 20])
def test_samples_that_are_written_several_times_count_once(times: int) -> None:
    noise = np.random.default_rng(0).standard_normal((2, 2000))
    residual = np.repeat(noise, times, axis=1)
    run = np.repeat([0, 1], 1000 * times)
    assert shares(residual, run) == pytest.approx(1.0 / times, rel=0.2)


def left(level: list[float], strain: float) -> Fit:
    num = len(level)
    return Fit(0.0, np.zeros(0), np.zeros(0), np.array(level), np.zeros((num, 1)), np.ones((num, 1)), strain)


@pytest.mark.parametrize(
    ("before", "after", "helps"),
    [
        (([0.31, 0.02], 8.0), ([0.29, 0.01], 5.8), False),  # a stop: nothing is better by much
        (([0.31, 0.02], 8.0), ([0.29, 0.01], 3.9), True),
        (([0.31, 0.02], 8.0), ([0.2, 0.01], 8.0), True),
        (([0.31, 0.02], 1.9), ([0.29, 0.01], 0.1), False),  # nothing was strained
        (([0.04, 0.02], 1.9), ([0.01, 0.01], 1.9), False),  # nothing balances badly, nothing is strained
        (([0.029, 0.024], 4.4), ([0.034, 0.024], 3.5), False),  # cables with compliant ends, and another clock
        (([0.015, 0.015], 8.9), ([0.015, 0.015], 0.6), True),  # a doubled constant that the parameters make up for
        (([0.31, 0.91], 8.0), ([0.02, 1.88], 1.0), False),  # another equation is spoilt
        (([0.31, 0.91], 8.0), ([0.02, 1.2], 1.0), True),
        (([0.31, 0.02], 8.0), ([0.02, 0.6], 1.0), True),
    ],
)
def test_a_factor_mends_an_equation_or_relieves_beliefs_and_spoils_nothing(
    before: tuple[list[float], float], after: tuple[list[float], float], helps: bool
) -> None:
    assert _helps(left(*after), left(*before), np.array([True, True])) == helps


@pytest.mark.parametrize(
    ("value", "level", "strain", "convinces"),
    [
        (3.0, [0.14, 0.69], 2.1, False),
        (3.0, [0.14, 0.69], 1.9, True),
        (3.0, [0.08, 0.69], 5.0, True),
        (0.01745, [0.38, 0.34], 2.4, True),  # degrees, from far away, near balance
        (0.0185, [0.38, 0.34], 2.4, False),  # which no unit explains
        (0.01745, [0.38, 0.69], 2.4, False),
        (-1.0, [0.38, 0.34], 2.4, False),
    ],
)
def test_corrected_logs_balance_somewhere_or_suit_the_beliefs_or_another_unit(
    value: float, level: list[float], strain: float, convinces: bool
) -> None:
    before, told = left([20.0, 17.0], 6.0), np.array([True, True])
    assert _convinces(Factor(("joint_angle",), value, left(level, strain)), before, told) == convinces


@pytest.mark.parametrize(
    ("value", "level", "strain", "before", "credible"),
    [
        (1e-3, 0.08, 7.0, 750.0, True),  # from far away to balance
        (0.1, 0.32, 7.6, 138.0, True),  # one of seven tensions in kilogram-force, beside a bristle
        (1e-3, 0.68, 7.0, 750.0, False),  # which it does not reach
        (1e-3, 0.08, 7.0, 2.0, False),  # or not from so far
        (1e-3, 0.68, 3.0, 750.0, True),  # beliefs bear it
        (-1.0, 0.68, 7.0, 750.0, True),  # a mere sign
    ],
)
def test_a_corrected_scale_may_strain_beliefs_where_it_brings_an_equation_to_balance(
    value: float, level: float, strain: float, before: float, credible: bool
) -> None:
    factor = Factor(("output_torque",), value, left([level, 1.0], strain))
    assert _is_credible(factor, left([before, 1.0], 0.1), BLOCKING) == credible


@pytest.mark.parametrize(
    ("before", "after", "strain", "agree"),
    [
        ([0.65], [0.0018], 0.99, True),  # the right unit of a sheath's output,
        ([0.65], [0.0002], 11.4, False),  # and another torque, beside friction eleven sd away
        ([0.21], [0.06], 1.5, True),  # balances, though a strong effect is missing
        ([1.6, 11.8, 4.2], [0.04, 0.95, 0.01], 1.7, True),  # friction holds the second, a tension
        ([0.04, 19.0, 9.0], [0.04, 19.0, 0.01], 1.7, False),  # another tension stays worse than nothing
        ([3.3, 267.0], [0.05, 2.6], 3.9, False),  # far nearer than before, and still worse than nothing
        ([0.3, 0.3], [0.2, 0.2], 0.5, False),
    ],
)
def test_a_correction_that_agrees_heals_or_balances_and_strains_nothing(
    before: list[float], after: list[float], strain: float, agree: bool
) -> None:
    assert agrees(left(after, strain), left(before, 6.0)) == agree


def factor(signal: str, value: float, gain: float, *, exact: bool = False) -> Factor:
    return Factor((signal,), value, replace(left([0.1], 1.0), cost=-gain), gain, exact)


def test_a_ratio_of_units_is_preferred_to_one_near_it_and_not_to_one_far_better() -> None:
    near = ranked([factor("a", 0.11, 100.0), factor("a", 0.102, 97.0, exact=True), factor("b", 2.0, 99.0)])
    assert [(f.signals[0], f.value) for f in near] == [("a", 0.102), ("b", 2.0)]
    far = ranked([factor("a", 0.15, 100.0), factor("a", 0.102, 80.0, exact=True)])
    assert [f.value for f in far] == [0.15]


def test_units_of_one_channel_take_no_place_of_others() -> None:
    units = [factor("a", 10.0**k, 50.0 + k, exact=True) for k in range(6)]
    leading = _leading([*units, *(factor(name, 2.0, 10.0) for name in "abcd")])
    assert {f.signals[0] for f in leading if not f.exact} == set("abcd")

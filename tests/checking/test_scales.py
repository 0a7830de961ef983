"""How many samples of a residual count, and what a right factor must bring."""

import numpy as np
import pytest

from tendonlab.checking.regression import Fit
from tendonlab.checking.scales import BLOCKING, Factor, _convinces, _helps, _is_credible, shares


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

"""The step of the regression: the minimum of a parabola where some unknowns cannot be negative."""

import numpy as np
import pytest

from tendonlab.checking.regression import _solve

INFORMATION = np.array([[2.0, 1.0], [1.0, 2.0]])


@pytest.mark.parametrize("positive", [False, True])
def test_an_unknown_that_cannot_be_negative_ends_at_zero_and_the_other_one_allows_for_it(positive: bool) -> None:
    x, lowest = np.array([0.3, 0.5]), np.array([-0.4, 1.0])
    gradient = INFORMATION @ (x - lowest)
    reached = x + _solve(INFORMATION, gradient, x, np.array([positive, False]))
    along_zero = [0.0, 1.0 - 0.4 * INFORMATION[1, 0] / INFORMATION[1, 1]]
    assert reached == pytest.approx(along_zero if positive else lowest)

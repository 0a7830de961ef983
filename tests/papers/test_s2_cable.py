"""The cable of S2's twin: a parabola up to the toe, a line above, and the same line on below its natural length."""

import numpy as np
import pytest

from tendonlab.papers import s2
from tendonlab.papers.s2.cable import Spring

RIG = s2.constants()


@pytest.mark.parametrize("toe", [0.0, 50.0, 200.0, 400.0])
def test_at_its_preload_a_cable_pulls_by_it(toe: float) -> None:
    """Preloaded above the toe, at its end, or within it."""
    assert RIG.T == 200.0
    assert Spring(RIG, toe).pull(0.0)[0] == pytest.approx(RIG.T)


@pytest.mark.parametrize("toe", [0.0, 50.0, 400.0])
def test_tension_is_that_of_a_line_above_the_toe_and_of_a_parabola_in_it(toe: float) -> None:
    """From the natural length on; below it the line of a cable without a toe goes on."""
    spring = Spring(RIG, toe)
    length = np.linspace(-1.0, 3.0, 41) * 200.0 / RIG.K
    tension, stiffness = np.array([spring.pull(x - spring.preloaded) for x in length]).T
    span = 2.0 * toe / RIG.K
    within = (length > 0.0) & (length < span)
    expected = np.where(length > 0.0, toe + RIG.K * (length - span), RIG.K * length)
    if toe:
        expected = np.where(within, toe * (length / span) ** 2, expected)
    assert tension == pytest.approx(expected, abs=1e-9)
    assert stiffness == pytest.approx(RIG.K * np.where(within, length / (span or 1.0), 1.0))


@pytest.mark.parametrize("toe", [50.0, 400.0])
def test_stiffness_is_the_slope_of_the_tension_which_has_no_jump(toe: float) -> None:
    spring = Spring(RIG, toe)
    for length in (1e-3 * spring.span, 0.5 * spring.span, 0.999 * spring.span, 1.001 * spring.span, 2.0 * spring.span):
        at, step = length - spring.preloaded, 1e-6 * spring.span
        slope = (spring.pull(at + step)[0] - spring.pull(at - step)[0]) / (2.0 * step)
        assert spring.pull(at)[1] == pytest.approx(slope, rel=1e-3)
    for end in (0.0, spring.span):
        below, above = (spring.pull(end - spring.preloaded + s * 1e-12)[0] for s in (-1.0, 1.0))
        assert above == pytest.approx(below, abs=1e-6)


@pytest.mark.parametrize("toe", [0.0, 50.0, 400.0])
@pytest.mark.parametrize("difference", [-300.0, -20.0, 0.0, 120.0])
def test_two_cables_hold_a_difference(toe: float, difference: float) -> None:
    spring = Spring(RIG, toe)
    by = spring.holding(difference)
    assert spring.pull(by)[0] - spring.pull(-by)[0] == pytest.approx(difference, abs=1e-6)
    if toe == 0.0:
        assert by == pytest.approx(difference / (2.0 * RIG.K))

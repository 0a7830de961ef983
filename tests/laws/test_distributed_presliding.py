"""A play in torque: the output is held until the friction of the whole sheath has turned over."""

from __future__ import annotations

import numpy as np
import pytest

from tendonlab import _core

LEVEL = 2.0


def law(rise: float, share: float = 1.0) -> _core.Law:
    return _core.sheath.DistributedPresliding(turnover_rise=rise, distributed_share=share)


def output(one: _core.Law, effort: np.ndarray) -> np.ndarray:
    """The output under an effort that no other friction acts on."""
    time = np.arange(effort.size) * 1e-3
    return np.asarray(one.apply(effort, start=effort, smooth=effort, dry_level=LEVEL, time=time))


def play(effort: np.ndarray) -> np.ndarray:
    """The play operator of half width LEVEL, from its definition."""
    held, out = effort[0], []
    for u in effort:
        held = min(max(held, u - LEVEL), u + LEVEL)
        out.append(held)
    return np.array(out)


EFFORT = np.concatenate([np.linspace(0, 10, 400), np.linspace(10, -6, 500), np.linspace(-6, 3, 300)])


def test_without_rise_it_is_the_play_operator() -> None:
    answer = output(law(1e-9), EFFORT)
    np.testing.assert_allclose(answer, play(EFFORT), atol=1e-6)


def test_a_rise_rounds_the_corner_only() -> None:
    """From the balance s dm = d + w (1 - exp(-d/rho)): the output trails by w (1 - exp(-d/rho)) after a reversal."""
    rho = 0.4
    down = EFFORT[400:900]
    answer = output(law(rho), EFFORT)
    fall = answer[399] - answer[400:900]
    turned = 2.0 * LEVEL * (1.0 - np.exp(-fall / rho))
    np.testing.assert_allclose(EFFORT[399] - down, fall + turned, atol=0.02)
    np.testing.assert_allclose(answer[800:900], play(EFFORT)[800:900], atol=1e-6)


def test_half_a_share_is_the_mean_of_effort_and_play() -> None:
    np.testing.assert_allclose(output(law(1e-9, 0.5), EFFORT), 0.5 * (EFFORT + play(EFFORT)), atol=1e-6)


def test_friction_dissipates_over_a_cycle() -> None:
    """Effort against output encloses 4 LEVEL times the way of the output: the area of a play loop."""
    phase = np.linspace(0.0, 6.0 * np.pi, 60_001)
    effort = 9.0 * np.sin(phase)
    answer = output(law(1e-9), effort)
    last = slice(40_000, None)
    area = np.trapezoid(effort[last], answer[last])
    assert area == pytest.approx(4.0 * LEVEL * (9.0 - LEVEL), rel=1e-3)

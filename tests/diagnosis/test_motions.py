"""Motions that are proposed stay within what the rig was seen to do."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.answer.motions import (
    RATE,
    Reach,
    _constant_speeds,
    _reversals,
    _rounded,
    _sweep,
    motions,
    seen_reach,
)


def test_proposals_respect_travel_speed_and_acceleration(twin_case: Any) -> None:
    reach = seen_reach(twin_case, twin_case.outputs.index("motor_angle"))
    for motion in motions(twin_case, "motor_angle"):
        speed = np.gradient(motion.path, 1 / RATE)
        assert np.all(np.abs(motion.path - reach.middle) <= 1.02 * reach.travel), motion.words
        assert np.max(np.abs(speed)) <= 1.1 * reach.speed, motion.words
        assert np.quantile(np.abs(np.gradient(speed, 1 / RATE)), 0.99) <= 1.1 * reach.acceleration, motion.words


def test_gravity_asks_for_more_payload(twin_case: Any) -> None:
    assert [m.payload > 0 for m in motions(twin_case, "motor_angle")] == [False] * 6 + [True]


def sine_case(time: np.ndarray, angle: np.ndarray) -> Any:
    runs = [SimpleNamespace(measured=np.array([angle]))]
    return SimpleNamespace(
        experiments=[SimpleNamespace(time=time)], prepared=runs, system=SimpleNamespace(axis="rotary")
    )


def test_the_reach_of_a_sine_is_its_amplitude_and_that_of_its_derivatives() -> None:
    time = np.arange(0.0, 20 * np.pi / 3, 0.002)  # ten cycles
    angle = 1.0 + 0.5 * np.sin(3.0 * time)
    angle[100] = np.nan
    reach = seen_reach(sine_case(time, angle), 0)
    assert reach.unit == "rad"
    assert (reach.middle, reach.travel) == (pytest.approx(1.0, abs=0.02), pytest.approx(0.5, rel=0.01))
    assert reach.speed == pytest.approx(1.5, rel=0.02)
    assert reach.acceleration == pytest.approx(4.5, rel=0.05)


def test_rounded_corners_keep_lines_and_turn_a_step_into_a_smooth_move() -> None:
    """Averaged twice over s seconds, a step of h moves within 2·s with an acceleration of h/s²."""
    line = np.linspace(0.0, 3.0, 1000)
    inside = slice(150, -150)
    np.testing.assert_allclose(_rounded(line, 0.2)[inside], line[inside], atol=3.0 / 999)
    step = np.where(np.arange(2000) < 1000, 0.0, 2.0)
    moved = _rounded(step, 0.2)
    assert (moved[0], moved[-1]) == (pytest.approx(0.0), pytest.approx(2.0))
    moving = np.flatnonzero((moved > 1e-9) & (moved < 2.0 - 1e-9))
    assert (moving[-1] - moving[0]) / RATE == pytest.approx(0.4, abs=4 / RATE)
    bend = np.abs(np.diff(moved, 2)) * RATE**2
    assert bend.max() == pytest.approx(2.0 / 0.2**2, rel=0.1)


def test_triangles_have_the_speed_and_sweeps_the_limits_that_were_seen() -> None:
    reach = Reach(middle=1.0, travel=0.8, speed=1.2, acceleration=40.0, unit="rad")
    slow = _reversals(reach, "joint", "reversals", 0.5, 0.5).path
    assert np.max(np.abs(slow - 1.0)) == pytest.approx(0.4, rel=0.1)
    assert np.quantile(np.abs(np.gradient(slow, 1 / RATE)), 0.9) == pytest.approx(0.6, rel=0.15)
    sweep = _sweep(reach, "joint").path
    speed = np.gradient(sweep, 1 / RATE)
    assert np.max(np.abs(sweep - 1.0)) == pytest.approx(min(0.24, 1.2 / (6 * np.pi), 40.0 / (6 * np.pi) ** 2), rel=0.01)
    assert np.max(np.abs(speed)) <= 1.02 * reach.speed
    turns = np.flatnonzero(np.diff(np.sign(speed[10:-10])))
    first, last = np.diff(turns[:2])[0] / RATE, np.diff(turns[-2:])[0] / RATE
    assert 0.5 / last == pytest.approx(3.0, rel=0.15)  # Hz, from half a period
    assert 0.5 / first < 1.0


def test_reversals_begin_upwards_from_the_middle() -> None:
    reach = Reach(middle=1.0, travel=0.8, speed=1.2, acceleration=40.0, unit="rad")
    path = _reversals(reach, "joint", "reversals", 0.5, 0.5).path
    assert path[0] == pytest.approx(1.0, abs=0.05)
    assert path[int(0.2 * RATE)] > path[0]


def test_constant_speeds_rise_geometrically_and_are_held_in_both_directions() -> None:
    reach = Reach(middle=0.1, travel=1.0, speed=1.5, acceleration=20.0, unit="rad")
    speed = np.gradient(_constant_speeds(reach, "joint").path, 1 / RATE)
    for k, top in enumerate(np.geomspace(0.045, 1.5, 5)):
        for way, sign in (
            (2 * k, 1.0),
            (2 * k + 1, -1.0),
        ):  # 0.6 s each, of which the middle third is away from corners
            held = speed[round((0.6 * way + 0.2) * RATE) : round((0.6 * way + 0.4) * RATE)]
            np.testing.assert_allclose(held, sign * top, rtol=1e-6)

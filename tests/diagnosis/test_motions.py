"""Motions that are proposed stay within what the rig was seen to do."""

from typing import Any

import numpy as np

from tendonlab.diagnosis.answer.motions import RATE, motions, seen_reach


def test_proposals_respect_travel_speed_and_acceleration(twin_case: Any) -> None:
    reach = seen_reach(twin_case, twin_case.outputs.index("motor_angle"))
    for motion in motions(twin_case, "motor_angle"):
        speed = np.gradient(motion.path, 1 / RATE)
        assert np.all(np.abs(motion.path - reach.middle) <= 1.02 * reach.travel), motion.words
        assert np.max(np.abs(speed)) <= 1.1 * reach.speed, motion.words
        assert np.quantile(np.abs(np.gradient(speed, 1 / RATE)), 0.99) <= 1.1 * reach.acceleration, motion.words


def test_gravity_asks_for_more_payload(twin_case: Any) -> None:
    assert [m.payload > 0 for m in motions(twin_case, "motor_angle")] == [False] * 5 + [True]

"""Reversals of a motion, and the samples near them to leave out (S4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from tendonlab.arguments import along, times, within
from tendonlab.errors import ParameterError

REST = 0.01  # share of the greatest speed that counts as rest: what noise crosses there is no reversal


def reversals(time: ArrayLike, velocity: ArrayLike, *, rest: float = REST) -> np.ndarray:
    """Times, s, at which the velocity changes its sign, by straight lines between samples; the middle of a dwell.

    `time`, s, and `velocity`, shapes (n,); uneven sampling is fine. Speeds up to a share `rest` of the greatest count
    as standing still: a dwell between motions in one direction is no reversal, even if noise changes the sign there.

    Raises ParameterError: unequal lengths, time that runs back, `rest` not in [0, 1)."""
    t = times(time)
    return np.asarray(_spans(t, along(t, "velocity", velocity), rest).mean(axis=1))


def reversal_mask(
    time: ArrayLike, velocity: ArrayLike, *, share: float = 0.4, around: float = 0.25, rest: float = REST
) -> np.ndarray:
    """True, shape (n,), for samples to keep: |velocity| at least `share` of its maximum, and no reversal (nor dwell
    that holds one) within `around` s.

    There a friction coefficient from a ratio of tensions is undefined (presliding). `rest` as in `reversals`. Source:
    S4 section 5 (0.4 and 0.25 s).

    Raises ParameterError: unequal lengths, time that runs back, a velocity of 0 throughout, `share` not in [0, 1),
    `around` below 0."""
    within("share", share, 0.0, 1.0, open_upper=True)
    within("around", around, 0.0, np.inf, "s")
    t = times(time)
    v = along(t, "velocity", velocity)
    if not v.any():
        raise ParameterError("velocity = 0 throughout: expected a motion")
    keep = np.abs(v) >= share * np.max(np.abs(v))
    begin, end = _spans(t, v, rest).T
    latest = np.searchsorted(begin - around, t, side="right") - 1  # the last reversal to have begun
    near = latest >= 0
    near[near] = t[near] <= end[latest[near]] + around
    return np.asarray(keep & ~near)


def _spans(time: np.ndarray, velocity: np.ndarray, rest: float) -> np.ndarray:
    """First and last zero of the velocity at each reversal, shape (reversals, 2); the same where it just crosses."""
    within("rest", rest, 0.0, 1.0, open_upper=True)
    moving = np.flatnonzero(np.abs(velocity) > rest * np.max(np.abs(velocity)))
    turns = np.flatnonzero(np.diff(np.sign(velocity[moving])))
    zeros = _zeros(time, velocity)
    first = np.searchsorted(zeros, time[moving[turns]])
    last = np.searchsorted(zeros, time[moving[turns + 1]], side="right") - 1
    return np.column_stack([zeros[first], zeros[last]])


def _zeros(time: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Times at which the velocity is 0 or crosses it."""
    at = np.flatnonzero(np.sign(velocity[:-1]) * np.sign(velocity[1:]) < 0.0)
    share = velocity[at] / (velocity[at] - velocity[at + 1])
    roots = np.minimum(time[at] + share * (time[at + 1] - time[at]), time[at + 1])  # rounding may lead past the sample
    return np.sort(np.concatenate([roots, time[velocity == 0.0]]))

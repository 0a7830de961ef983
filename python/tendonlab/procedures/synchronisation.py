"""Jumps of a signal, and how late they come (S2: T_shift)."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy.optimize import linear_sum_assignment

from tendonlab.arguments import along, interval, positive, times, within

MISMATCH = 1e6  # cost of pairing opposite jumps, in squared lengths of the record: never worth it


def jumps(time: ArrayLike, values: ArrayLike, *, threshold: float, within_time: float = 0.1) -> pd.DataFrame:
    """Jumps of a signal, in order: `time`, s, of the middle of each, and its signed `jump`, in the signal's unit.

    A jump is a change of more than `threshold` (unit of `values`) within `within_time` s: long enough for what smears a
    jump, short enough for what a slow signal changes meanwhile to stay below the threshold. Even sampling.

    Raises ParameterError: `threshold` not above 0, `within_time` not between one sampling interval and the record's
    length, uneven sampling."""
    t = times(time, fewest=3)
    return _jumps(t, along(t, "values", values), threshold, within_time)


def time_shift(
    time: ArrayLike,
    simulated: ArrayLike,
    measured: ArrayLike,
    *,
    threshold: float,
    within_time: float = 0.1,
    longest: float | None = None,
) -> pd.DataFrame:
    """Delay of each jump of `measured` after the matching jump of `simulated`; one row per pair, in order of time.

    Columns `simulated_time`, `measured_time` and `shift` = measured - simulated, s; `simulated_jump`, `measured_jump`
    in the unit of the signals. Jumps as in `jumps`; paired are jumps of one sign, one to one, so that the sum of
    squared shifts is least, none above `longest` s. Jumps without partner are left out: `jumps` lists them all. S2
    Fig. 12, where forces of 15 N and more count.

    Raises ParameterError as `jumps`, and where `longest` is not above 0."""
    t = times(time, fewest=3)
    ours = _jumps(t, along(t, "simulated", simulated), threshold, within_time)
    theirs = _jumps(t, along(t, "measured", measured), threshold, within_time)
    if longest is not None:
        positive("longest", longest, "s")
    pairs = _pairs(ours, theirs, float(t[-1] - t[0]), longest)
    left, right = ours.iloc[[i for i, _ in pairs]], theirs.iloc[[j for _, j in pairs]]
    begin, end = left["time"].to_numpy(), right["time"].to_numpy()
    return pd.DataFrame(
        {
            "simulated_time": begin,
            "measured_time": end,
            "shift": end - begin,
            "simulated_jump": left["jump"].to_numpy(),
            "measured_jump": right["jump"].to_numpy(),
        }
    )


def _jumps(time: np.ndarray, values: np.ndarray, threshold: float, within_time: float) -> pd.DataFrame:
    positive("threshold", threshold)
    dt = interval(time)
    within("within_time", within_time, 0.99 * dt, time[-1] - time[0], "s, one interval to the record's length")
    reach = max(1, round(within_time / dt))
    change = values[reach:] - values[:-reach]
    middle = 0.5 * (time[reach:] + time[:-reach])
    sense = np.where(np.abs(change) > threshold, np.sign(change), 0.0)
    edges = np.flatnonzero(np.diff(sense, prepend=0.0, append=0.0))
    found = []
    for begin, end in pairwise(edges):
        if sense[begin] == 0.0:
            continue
        weight = np.abs(change[begin:end])
        # the windows overlap by `reach`: the first begins before the jump, the last ends after it
        found.append((float(weight @ middle[begin:end] / weight.sum()), values[end - 1 + reach] - values[begin]))
    return pd.DataFrame(found, columns=["time", "jump"], dtype=float)


def _pairs(ours: pd.DataFrame, theirs: pd.DataFrame, length: float, longest: float | None) -> list[tuple[int, int]]:
    shift = theirs["time"].to_numpy()[None, :] - ours["time"].to_numpy()[:, None]
    opposite = np.sign(theirs["jump"].to_numpy())[None, :] != np.sign(ours["jump"].to_numpy())[:, None]
    barred = opposite if longest is None else opposite | (np.abs(shift) > longest)
    cost = np.where(barred, MISMATCH, (shift / length) ** 2)  # squares keep pairs in order, sums of times would not
    rows, columns = linear_sum_assignment(cost)
    return [(int(i), int(j)) for i, j in zip(rows, columns, strict=True) if not barred[i, j]]

"""Steady averages: one speed and one torque per plateau, with or without gravity (S1 section 5)."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy.integrate import trapezoid
from scipy.signal import savgol_coeffs, savgol_filter

from tendonlab.arguments import along, interval, times, within
from tendonlab.errors import ParameterError
from tendonlab.procedures.runs import blocks, of_samples, stretches, trimmed
from tendonlab.simulation.reading import white_noise_sd

NOISE = 5.0  # sd of noise that still count as none
REST = 0.01  # share of the greatest speed that counts as rest
FINE = 100  # samples of the shortest plateau that are looked at: a finer record is averaged in blocks
COLUMNS = ["start", "end", "speed", "torque", "sd", "num_samples"]


def steady_averages(
    time: ArrayLike,
    velocity: ArrayLike,
    torque: ArrayLike,
    *,
    position: ArrayLike | None = None,
    tolerance: float = 0.05,
    shortest: float = 0.5,
    trim: float = 0.1,
) -> pd.DataFrame:
    """One speed and one torque for each plateau of the velocity, in order of time.

    `time`, s, evenly sampled; `velocity`, rad/s or m/s; `torque`, N·m or N; `position`, rad or m: shapes (n,). A
    plateau lasts at least `shortest` s, in which the speed changes by less than a share `tolerance` of itself (or than
    five sd of its noise); a share `trim` is cut at each end. Rest is no plateau. Columns: `start`, `end`, s; `speed`
    and `torque`, means; `sd` of the torque's samples about their mean; `num_samples`.

    With `position`, two more columns split the torque into a part that changes sign with the motion and the rest: half
    the difference and half the sum of a plateau and the one nearest in time that passes the same positions at the
    opposite speed, each averaged over the positions that both pass. `friction` keeps the sign of `speed`, `gravity` is
    the rest. This takes friction to be the same in both directions. S1 section 5.

    Raises ParameterError: uneven sampling, unequal lengths, no plateau, `tolerance` not in (0, 1), `shortest` below 10
    samples or above the record, `trim` not in [0, 0.5), and, with `position`, a plateau without an opposite one."""
    within("tolerance", tolerance, 0.0, 1.0, open_lower=True, open_upper=True)
    within("trim", trim, 0.0, 0.5, open_upper=True)
    t = times(time, fewest=10)
    v, load = along(t, "velocity", velocity), along(t, "torque", torque)
    found = [trimmed(p, trim) for p in _plateaus(t, v, tolerance, shortest)]
    if not found:
        raise ParameterError(
            f"shortest = {shortest} s: expected a plateau of that length with the speed within {tolerance:g} of itself"
        )
    rows = [(t[p][0], t[p][-1], v[p].mean(), load[p].mean(), load[p].std(ddof=1), p.stop - p.start) for p in found]
    averages = pd.DataFrame(rows, columns=COLUMNS)
    if position is None:
        return averages
    y = along(t, "position", position)
    passes = [np.polyfit(t[p] - t[p].mean(), y[p], 1) for p in found]
    split = [_split(k, averages, passes, (t, load), tolerance) for k in range(len(found))]
    return averages.assign(friction=[half for half, _ in split], gravity=[rest for _, rest in split])


def _plateaus(time: np.ndarray, velocity: np.ndarray, tolerance: float, shortest: float) -> list[slice]:
    dt = interval(time)
    within("shortest", shortest, 9.5 * dt, time[-1] - time[0], "s, 10 samples to the record's length")
    size = max(1, int(shortest / dt / FINE))
    v, step = blocks(velocity, size), dt * size
    num = 2 * int(0.25 * shortest / step) + 1  # half of the shortest plateau: its other half is then free of ramps
    level, change = (savgol_filter(v, num, 1, deriv=d, delta=step) for d in range(2))
    noise = [white_noise_sd(v) * float(np.linalg.norm(savgol_coeffs(num, 1, deriv=d, delta=step))) for d in range(2)]
    moving = np.abs(level) > max(REST * float(np.max(np.abs(level))), NOISE * noise[0])
    allowed = np.maximum(tolerance * np.abs(level) / shortest, NOISE * noise[1])
    found = (of_samples(s, size, len(time)) for s in stretches(moving & (np.abs(change) < allowed)))
    return [s for s in found if (s.stop - s.start) * dt >= 0.5 * shortest]


def _split(
    k: int, averages: pd.DataFrame, passes: list[np.ndarray], log: tuple[np.ndarray, np.ndarray], tolerance: float
) -> tuple[float, float]:
    """Friction and gravity of plateau `k`."""
    speed = averages["speed"].to_numpy()
    middle = 0.5 * (averages["start"] + averages["end"]).to_numpy()
    opposite = np.abs(speed + speed[k]) < tolerance * abs(speed[k])
    for other in np.argsort(np.abs(middle - middle[k]), kind="stable"):
        if not opposite[other]:
            continue
        ranges = [_range(averages.iloc[i], passes[i]) for i in (k, int(other))]
        lower, upper = max(r[0] for r in ranges), min(r[1] for r in ranges)
        if upper - lower < 0.5 * min(r[1] - r[0] for r in ranges):
            continue
        ours, theirs = (_mean_between(lower, upper, averages.iloc[i], passes[i], log) for i in (k, int(other)))
        return 0.5 * (ours - theirs), 0.5 * (ours + theirs)
    raise ParameterError(
        f"velocity = {speed[k]:.4g} about {middle[k]:.4g} s: expected a plateau at the opposite speed that passes the "
        "same positions"
    )


def _range(plateau: pd.Series[float], line: np.ndarray) -> tuple[float, float]:
    """Least and greatest position on the straight line through a plateau's positions."""
    reach = 0.5 * abs(line[0]) * (plateau["end"] - plateau["start"])
    return float(line[1] - reach), float(line[1] + reach)


def _mean_between(
    lower: float, upper: float, plateau: pd.Series[float], line: np.ndarray, log: tuple[np.ndarray, np.ndarray]
) -> float:
    """Mean torque between two positions, over time: at steady speed all positions count alike."""
    time, torque = log
    middle = 0.5 * (plateau["start"] + plateau["end"])
    begin, end = sorted(middle + (edge - line[1]) / line[0] for edge in (lower, upper))
    at = np.concatenate([[begin], time[(time > begin) & (time < end)], [end]])
    return float(trapezoid(np.interp(at, time, torque), at) / (end - begin))

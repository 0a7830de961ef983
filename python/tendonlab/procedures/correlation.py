"""Lag of one signal behind another."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import correlate

from tendonlab.arguments import along, interval, times, within
from tendonlab.errors import ParameterError


def correlation_shift(time: ArrayLike, a: ArrayLike, b: ArrayLike, *, longest: float) -> float:
    """Time, s, by which `b` comes after `a` (negative: before it), at most `longest` s, where their correlation is
    largest.

    Shapes (n,), evenly sampled; units of `a` and `b` do not matter. For each shift the correlation coefficient of the
    samples that overlap is taken; a parabola through the greatest and its neighbours places it between samples. A
    periodic signal repeats at every period: keep `longest` below half a period.

    Raises ParameterError: `longest` below one sampling interval or above half the record, uneven sampling, a constant
    signal, or a correlation that still grows at `longest`."""
    t = times(time, fewest=8)
    dt = interval(t)
    rows = along(t, "a", a), along(t, "b", b)
    within("longest", longest, dt * (1.0 - 1e-9), 0.5 * (t[-1] - t[0]), "s, one interval to half the record")
    for name, row in zip("ab", rows, strict=True):
        if np.ptp(row) == 0.0:
            raise ParameterError(f"{name} = {row[0]} throughout: expected a signal that varies")
    most = math.floor(longest / dt * (1.0 + 1e-9))
    alike = _coefficients(rows[0] - rows[0].mean(), rows[1] - rows[1].mean(), most + 1)
    best = int(np.argmax(alike))
    if best in (0, len(alike) - 1):
        raise ParameterError(f"longest = {longest} s: the signals grow more alike beyond it; expected a longer one")
    left, top, right = alike[best - 1 : best + 2]
    bend = left - 2.0 * top + right
    between = 0.5 * (left - right) / bend if bend < 0.0 else 0.0
    return float((best - most - 1 + between) * dt)


def _coefficients(a: np.ndarray, b: np.ndarray, most: int) -> np.ndarray:
    """Correlation coefficients of a[k] and b[k + lag] for lags -most … most; 0 where an overlap is constant."""
    n = len(a)
    lags = np.arange(-most, most + 1)
    num = n - np.abs(lags)
    products = correlate(b, a)[n - 1 + lags]
    begin_a, begin_b = np.maximum(0, -lags), np.maximum(0, lags)

    def sums(row: np.ndarray, begin: np.ndarray) -> np.ndarray:
        total = np.concatenate([[0.0], np.cumsum(row)])
        return np.asarray(total[begin + num] - total[begin])

    sum_a, sum_b = sums(a, begin_a), sums(b, begin_b)
    spread_a = sums(a * a, begin_a) - sum_a**2 / num
    spread_b = sums(b * b, begin_b) - sum_b**2 / num
    varies = (spread_a > 1e-12 * float(a @ a)) & (spread_b > 1e-12 * float(b @ b))
    scale = np.sqrt(np.where(varies, spread_a * spread_b, 1.0))
    return np.where(varies, (products - sum_a * sum_b / num) / scale, 0.0)

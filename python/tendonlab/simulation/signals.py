"""Signals for the core: piecewise cubics through or near samples."""

from __future__ import annotations

from typing import Any

import numpy as np

from tendonlab import _core
from tendonlab.simulation.reading import common_step, is_noiseless, noise_sd

AT_ONCE = 0.02  # s from the first sample, within which a signal shows how an experiment begins
BEYOND_NOISE = 3.0  # sd of noise, or of rounding, within which a smooth curve may miss a sample
CLEAR = 4.0  # sd from 0 of a velocity or a curvature that is there


def hold(time: np.ndarray, values: np.ndarray) -> _core.Signal:
    """Each value held until the next sample, as hardware does."""
    return _core.Signal(time, np.column_stack([values, np.zeros((len(values), 3))]), True)


def linear(time: np.ndarray, values: np.ndarray) -> _core.Signal:
    """Straight between samples."""
    slope = np.diff(values) / np.diff(time)
    return _core.Signal(time[:-1], np.column_stack([values[:-1], slope, np.zeros((len(slope), 2))]), False)


def averaged(time: np.ndarray, means: np.ndarray) -> _core.Signal:
    """Parabolas without kinks or jumps, each with the given mean until the next sample; the last sample ends them."""
    from scipy.interpolate import CubicSpline

    gathered = np.concatenate([[0.0], np.cumsum(means[:-1] * np.diff(time))])
    return _from_pieces(CubicSpline(time, gathered, bc_type="natural").derivative())


def smooth(time: np.ndarray, values: np.ndarray) -> _core.Signal:
    """A cubic spline through the samples: for what is differentiated."""
    from scipy.interpolate import CubicSpline

    return _from_pieces(CubicSpline(time, values))


def smoothed(time: np.ndarray, values: np.ndarray) -> _core.Signal:
    """A cubic spline near noisy samples, its smoothness chosen by generalised cross-validation; through them where they
    carry no noise, which leaves nothing to choose by."""
    kept = np.isfinite(values)
    return _from_pieces(spline_near(time[kept], values[kept]))


def smoothed_within_noise(time: np.ndarray, values: np.ndarray) -> _core.Signal:
    """At each sample the curve of `smoothed`; where the curve misses a sample by more than noise may, that sample as
    logged, for a smooth curve takes a sudden stop for a gradual one. Not for what is differentiated between samples."""
    from scipy.interpolate import CubicHermiteSpline

    near = spline_near(time, values)
    curve, noise = near(time), max(noise_sd(values), common_step([values]) / np.sqrt(12.0))
    missed = np.abs(values - curve) > BEYOND_NOISE * noise
    return _from_pieces(CubicHermiteSpline(time, np.where(missed, values, curve), near(time, 1)))


def sloped(time: np.ndarray, values: np.ndarray) -> _core.Signal:
    """A cubic through the samples that has there the slopes of `smoothed`: values as logged, slopes freed of noise."""
    from scipy.interpolate import CubicHermiteSpline

    return _from_pieces(CubicHermiteSpline(time, values, spline_near(time, values)(time, 1)))


def first_samples(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """The samples of the first 20 ms that were measured (at least 8 samples)."""
    kept = np.isfinite(values)
    since = time[kept] - time[kept][0]
    return np.asarray(values[kept][: max(8, int(np.searchsorted(since, AT_ONCE)))])


def first_seen(time: np.ndarray, values: np.ndarray) -> float:
    """Time after the first sample at which a signal was first measured, s."""
    return float(time[np.isfinite(values)][0] - time[0])


def motion_at_start(time: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Position and velocity at the first sample, or where the signal was first measured if that is more than 20 ms
    later. From a line through the first 20 ms measured (at least 8 samples), or from a parabola where the motion is
    clearly curved there. A velocity within its uncertainty, or below 1 % of the record's typical speed, is rest."""
    kept = np.isfinite(values)
    t, y = time[kept] - time[0], values[kept]
    if t[0] > AT_ONCE:
        t = t - t[0]
    num = len(first_samples(time, values))
    if len(t) <= num:
        return float(np.mean(y[:num])), 0.0
    (position, rate, bend), sd = _polynomial(t[:num], y[:num], 2)
    still = position
    if abs(bend) < CLEAR * sd[2]:
        (position, rate), sd = _polynomial(t[:num], y[:num], 1)
        still = np.mean(y[:num])
    speed = float(np.ptp(y)) / max(float(t[-1]), 1e-12)
    if abs(rate) < max(CLEAR * sd[1], 0.01 * speed):
        return float(still), 0.0
    return float(position), float(rate)


def _polynomial(t: np.ndarray, y: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients of the best polynomial, the constant first, and the sd of each."""
    found, covariance = np.polyfit(t, y, degree, cov=True)
    return found[::-1], np.sqrt(np.diag(covariance))[::-1]


def scales_of(time: np.ndarray, positions: np.ndarray) -> tuple[float, float]:
    """A tenth of the smallest rms travel and speed among measured positions (rows): scales of the stepper."""
    travel, speed = [], []
    for row in positions:
        kept = np.isfinite(row)
        if kept.sum() < 3 or np.ptp(row[kept]) == 0:
            continue
        t, y = time[kept], row[kept]
        width = max(1, min(round(0.02 * len(t) / (t[-1] - t[0])), len(t) // 3))
        even = np.convolve(y, np.ones(width) / width, mode="valid")
        travel.append(float(np.std(y)))
        speed.append(float(np.std(np.gradient(even, t[: len(even)]))) if len(even) > 2 else travel[-1])
    if not travel:
        return 1e-2, 1e-2
    return 0.1 * min(travel), max(0.1 * min(speed), 1e-12)


def spline_near(time: np.ndarray, values: np.ndarray) -> Any:
    """A cubic spline near noisy samples, through them where they carry no noise, as scipy has it."""
    from scipy.interpolate import CubicSpline

    from tendonlab.simulation.smoothing import smoothing_spline  # loads scipy

    return CubicSpline(time, values) if is_noiseless(values) else smoothing_spline(time, values)


def _from_pieces(piecewise: Any) -> _core.Signal:
    knots = np.asarray(piecewise.x, dtype=np.float64)
    c = np.asarray(piecewise.c, dtype=np.float64)
    pieces = np.flatnonzero(np.diff(knots) > 0)  # a spline repeats its end knots
    coefficients = np.zeros((len(pieces), 4))
    coefficients[:, : c.shape[0]] = c[::-1, pieces].T
    return _core.Signal(np.ascontiguousarray(knots[pieces]), coefficients, False)

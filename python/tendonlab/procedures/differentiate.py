"""Velocity from a measured position."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from tendonlab.arguments import along, choice, interval, times, within
from tendonlab.errors import ParameterError
from tendonlab.simulation.reading import noise_sd

METHODS = ("central", "spline", "savgol")
CUBIC = 3  # degree of the polynomials of the Savitzky-Golay filter
DEFAULT_SAMPLES = 21  # its window where none is given


def velocity(time: ArrayLike, values: ArrayLike, *, method: str = "central", window: float | None = None) -> np.ndarray:
    """Rate of `values` (a position, rad or m), shape (n,), at the times of `time`, s, shape (n,): rad/s or m/s.

    "central": central differences, second order, also where sampling is uneven; for positions without noise, such as
    denoised ones. "spline": derivative of a smoothing spline of degree 5 that misses the samples by as much as their
    white noise (or the step of their quantisation) says; uneven sampling is fine. "savgol": Savitzky-Golay, cubics over
    `window` seconds (None: 21 samples), exact on cubics, even sampling only.

    Raises ParameterError: fewer samples than the method needs, time that runs back, uneven sampling ("savgol"), a
    window of fewer than 5 samples or longer than the record, a window where the method has none. Source: S0 section 2.3
    (central), S4 section 5 (Savitzky-Golay)."""
    choice("method", method, METHODS)
    if window is not None and method != "savgol":
        raise ParameterError(f"window = {window}: expected None, since only the method 'savgol' has a window")
    if method == "savgol":
        return _savgol(time, values, window)
    t = times(time, fewest=3 if method == "central" else 10)
    y = along(t, "values", values)
    if method == "central":
        return np.asarray(np.gradient(y, t, edge_order=2), dtype=float)
    return _spline(t, y)


def _savgol(time: ArrayLike, values: ArrayLike, window: float | None) -> np.ndarray:
    from scipy.signal import savgol_filter

    t = times(time, fewest=CUBIC + 2)
    y = along(t, "values", values)
    dt = interval(t)
    num = window_samples(t, window)
    return np.asarray(savgol_filter(y, num, CUBIC, deriv=1, delta=dt), dtype=float)


def window_samples(time: np.ndarray, window: float | None) -> int:
    """Odd number of samples of a window of `window` seconds; None: 21, or what a short record has."""
    longest = len(time) - 1 + len(time) % 2
    if window is None:
        return min(DEFAULT_SAMPLES, longest)
    dt = interval(time)
    within("window", window, (CUBIC + 1) * dt, longest * dt, "s, at least 5 samples and within the record")
    return min(2 * math.floor(0.5 * window / dt) + 1, longest)


def _spline(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    from scipy.interpolate import UnivariateSpline

    noise = noise_sd(values)
    level = 1e-14 * float(np.max(np.abs(values)))  # rounding: FITPACK would never end on an exact fit of it
    middle, half = 0.5 * (time[0] + time[-1]), 0.5 * (time[-1] - time[0])
    scale = max(float(np.ptp(values)), level) or 1.0
    allowed = len(values) * (max(noise, level) / scale) ** 2
    spline = UnivariateSpline((time - middle) / half, (values - values[0]) / scale, k=5, s=allowed)
    return np.asarray(spline.derivative()((time - middle) / half) * (scale / half), dtype=float)

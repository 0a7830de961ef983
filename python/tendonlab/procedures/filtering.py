"""Low-pass filtering, and a signal less its mean (S2)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import butter, sosfilt, sosfilt_zi, sosfiltfilt

from tendonlab.arguments import positive, samples, whole, within
from tendonlab.errors import ParameterError


def lowpass(
    values: ArrayLike, *, cutoff: float, sample_rate: float, order: int = 2, zero_phase: bool = True
) -> np.ndarray:
    """`values`, shape (n,), through a Butterworth low-pass filter; same shape and unit.

    `cutoff` and `sample_rate` in Hz. With `zero_phase` the filter runs forwards and backwards: no delay, gain 1/2 at
    `cutoff` and twice the order's slope; the record is extended at its ends so that a straight line passes unchanged.
    Without, it runs once forwards, as an instrument's does, from rest at the first value: gain 1/sqrt(2) at `cutoff`,
    and a delay. Filter all signals that are compared alike. S2 filters at 1 Hz; order and phase are reconstructed.

    Raises ParameterError: `cutoff` not between 0 and half the sampling rate, order below 1, fewer than 3 (order + 1)
    samples, numbers that are not finite, `cutoff` too low for the filter to be computed."""
    whole("order", order, 1)
    row = samples("values", values, fewest=3 * (order + 1))
    positive("sample_rate", sample_rate, "Hz")
    within("cutoff", cutoff, 0.0, 0.5 * sample_rate, "Hz", open_lower=True, open_upper=True)
    try:
        with np.errstate(divide="raise", invalid="raise"):
            return _filtered(row, cutoff, sample_rate, order, zero_phase)
    except (np.linalg.LinAlgError, ArithmeticError, ValueError) as error:
        raise ParameterError(
            f"cutoff = {cutoff}: expected a greater share of sample_rate = {sample_rate} Hz; rounding leaves no filter"
        ) from error


def remove_mean(values: ArrayLike) -> np.ndarray:
    """`values`, shape (n,), less their mean; same shape and unit.

    Of a force over a sweep that takes off what does not change, such as a preload, but also the mean of what does: the
    levels of the branches of a friction law are then known only up to one common number. S2 does so before its fit.
    Raises ParameterError for numbers that are not finite."""
    row = samples("values", values, fewest=1)
    return np.asarray(row - row.mean())


def _filtered(row: np.ndarray, cutoff: float, sample_rate: float, order: int, zero_phase: bool) -> np.ndarray:
    sections = butter(order, cutoff, fs=sample_rate, output="sos")
    if not zero_phase:
        return np.asarray(sosfilt(sections, row, zi=sosfilt_zi(sections) * row[0])[0], dtype=float)
    # long enough for the start of the filter to have died out (to 1e-12 and less) before the record begins
    extension = min(len(row) - 1, math.ceil(3 * order * sample_rate / cutoff))
    return np.asarray(sosfiltfilt(sections, row, padlen=extension), dtype=float)

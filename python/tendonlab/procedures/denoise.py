"""Wavelet denoising of a measured position (S0 section 2.3)."""

from __future__ import annotations

import math
import warnings
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import detrend

from tendonlab.arguments import choice, samples, whole, within
from tendonlab.errors import ParameterError

GAUSSIAN = 0.6745  # median of |x| of a standard normal variable: turns a median into an sd
MODES = ("soft", "hard", "garrote")


def universal_threshold(num_samples: int, *, sigma: float = 1.0) -> float:
    """sigma sqrt(2 ln n): the level that noise alone of sd `sigma` hardly ever exceeds in `num_samples` samples."""
    num_samples = whole("num_samples", num_samples, 1)
    return within("sigma", sigma, 0.0, math.inf) * math.sqrt(2.0 * math.log(num_samples))


def wavelet_denoise(
    values: ArrayLike,
    *,
    wavelet: str = "db4",
    level: int | None = 10,
    mode: str = "soft",
    sigma: float | None = None,
) -> np.ndarray:
    """`values`, shape (n,), evenly sampled, without their noise; same shape and unit.

    The straight trend is taken off first and put back at the end, since a ramp would be bent at its ends. The details
    of `level` levels of the discrete wavelet transform are pulled to zero (`mode` "soft"), or kept or dropped ("hard"),
    at the universal threshold. `sigma`, in the unit of `values`, is the noise's sd; None estimates it from the finest
    details d as median|d| / 0.6745. A `level` deeper than the length allows is capped, with a warning (db4 needs 7168
    samples for 10); None goes as deep as the length allows. S0 section 2.3 has Daubechies wavelets, 10 levels and the
    universal threshold; order 4 and the soft mode are reconstructed.

    Raises ParameterError for fewer samples than one level needs, numbers that are not finite, an unknown wavelet or
    mode; ImportError without PyWavelets (extra `procedures`)."""
    pywt = _pywavelets()
    if wavelet not in pywt.wavelist(kind="discrete"):
        raise ParameterError(
            f"wavelet = {wavelet!r}: expected a discrete wavelet of PyWavelets, such as 'db4' or 'sym8'"
        )
    choice("mode", mode, MODES)
    shortest = 2 * (pywt.Wavelet(wavelet).dec_len - 1)
    row = samples("values", values, fewest=max(shortest, 2))
    deepest = pywt.dwt_max_level(len(row), wavelet)
    if level is not None and whole("level", level, 1) > deepest:
        warnings.warn(
            f"level = {level}: {len(row)} samples allow {deepest} levels of {wavelet}; {deepest} are used", stacklevel=2
        )
    about_trend = detrend(row)
    smooth, *details = pywt.wavedec(about_trend, wavelet, level=deepest if level is None else min(level, deepest))
    if sigma is None:
        sigma = float(np.median(np.abs(details[-1]))) / GAUSSIAN
    threshold = universal_threshold(len(row), sigma=sigma)
    if threshold > 0.0:
        details = [pywt.threshold(d, threshold, mode) for d in details]
    denoised = pywt.waverec([smooth, *details], wavelet)[: len(row)]
    return np.asarray(row + (denoised - about_trend), dtype=float)


def _pywavelets() -> ModuleType:
    try:
        import pywt
    except ImportError as error:
        message = "wavelet_denoise needs PyWavelets: install it with the extra, pip install 'tendonlab[procedures]'"
        raise ImportError(message) from error
    return pywt  # type: ignore[no-any-return]

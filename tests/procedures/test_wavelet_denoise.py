"""Wavelet denoising: keeps what is smooth, drops what is noise, caps what the length forbids."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.procedures import universal_threshold, velocity, wavelet_denoise

TIME = np.arange(0.0, 10.0, 1e-3)
MOTION = 3.0 * TIME + 0.5 * np.sin(2.0 * np.pi * 0.4 * TIME)


def test_universal_threshold_of_ten_thousand_samples() -> None:
    """sqrt(2 ln 10000) = 4.29193, proportional to the noise."""
    assert universal_threshold(10_000) == pytest.approx(4.291932052578694, rel=1e-9)
    assert universal_threshold(10_000, sigma=0.2) == pytest.approx(0.2 * 4.291932052578694, rel=1e-9)


def test_noise_falls_below_the_threshold_and_the_motion_stays() -> None:
    """Some 50 of 10000 details carry this motion, and soft thresholding pulls each by 4.29 sd of the noise: a bias of
    4.29 sqrt(50 / 10000) = 0.30 sd, with little noise beside it. In the velocity it is less than a hundredth."""
    noise = 0.01 * np.random.default_rng(3).normal(size=len(TIME))
    denoised = wavelet_denoise(MOTION + noise)
    assert np.std(denoised - MOTION) < 0.33 * 0.01
    rough, smooth = (np.std(velocity(TIME, y) - np.gradient(MOTION, TIME)) for y in (MOTION + noise, denoised))
    assert smooth < 0.01 * rough


def test_a_straight_ramp_is_returned_untouched_to_its_ends() -> None:
    ramp = 105.0 * TIME - 2.0
    np.testing.assert_allclose(wavelet_denoise(ramp), ramp, rtol=0, atol=1e-9 * ramp[-1])


def test_the_trend_passes_by_the_wavelets() -> None:
    """Denoising with a ramp added is denoising, with the ramp added."""
    noisy = np.sin(TIME) + 0.02 * np.random.default_rng(5).normal(size=len(TIME))
    np.testing.assert_allclose(wavelet_denoise(noisy + 7.0 * TIME), wavelet_denoise(noisy) + 7.0 * TIME, atol=1e-10)


@pytest.mark.parametrize("n", [10_000, 9_999])
@pytest.mark.parametrize("mode", ["soft", "hard", "garrote"])
def test_without_noise_the_transform_is_inverted(mode: str, n: int) -> None:
    np.testing.assert_allclose(wavelet_denoise(MOTION[:n], sigma=0.0, mode=mode), MOTION[:n], rtol=0, atol=1e-10)


def test_a_constant_stays() -> None:
    np.testing.assert_allclose(wavelet_denoise(np.full(8192, 2.5)), 2.5, rtol=1e-14)


def test_noise_is_estimated_from_the_finest_details() -> None:
    """The estimate is as good as being told the sd: the median of 5000 details is known to 1.2 %."""
    noisy = MOTION + 0.01 * np.random.default_rng(7).normal(size=len(TIME))
    told, estimated = wavelet_denoise(noisy, sigma=0.01), wavelet_denoise(noisy)
    assert np.std(told - estimated) < 0.02 * 0.01


def test_soft_pulls_and_hard_keeps() -> None:
    """A lone spike of 100 sd survives hard thresholding nearly whole; soft takes the threshold off each coefficient."""
    spike = np.zeros(8192)
    spike[4000] = 100.0
    hard, soft = (wavelet_denoise(spike, sigma=1.0, mode=mode)[4000] for mode in ("hard", "soft"))
    assert soft < hard < 100.5
    assert hard > 95.0


def test_ten_levels_need_7168_samples() -> None:
    """With 7168 db4 samples there is no warning (warnings are errors here); with one less the level is capped."""
    wavelet_denoise(MOTION[:7168])
    with pytest.warns(UserWarning, match=r"level = 10: 7167 samples allow 9 levels of db4"):
        capped = wavelet_denoise(MOTION[:7167])
    np.testing.assert_array_equal(capped, wavelet_denoise(MOTION[:7167], level=9))
    np.testing.assert_array_equal(capped, wavelet_denoise(MOTION[:7167], level=None))


@pytest.mark.parametrize("speed", [1.0, -5.0, 16.0, 35.0, -80.0, 105.0])
def test_speeds_by_wavelet_are_the_commanded_ones(bench_run: Callable[..., Any], speed: float) -> None:
    """Within 0.5 % (S0), on average and, unlike the raw record's, sample by sample (one sd)."""
    run = bench_run(speed)
    steady = np.flatnonzero(run.speed == speed)[60:-60]
    found = velocity(run.time, wavelet_denoise(run.measured, level=10 if len(run.time) >= 7168 else None))[steady]
    assert found.mean() == pytest.approx(speed, rel=0.005)
    assert found.std() < 0.005 * abs(speed)


def test_without_pywavelets_the_message_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pywt", None)
    with pytest.raises(ImportError, match=r"pip install 'tendonlab\[procedures\]'"):
        wavelet_denoise(MOTION)


@pytest.mark.parametrize(
    ("values", "options", "message"),
    [
        (MOTION[:13], {}, "values has 13 samples: expected at least 14"),
        (np.where(np.arange(10_000) == 412, np.nan, MOTION), {}, r"values\[412\] = nan: expected a finite number"),
        (MOTION.reshape(2, -1), {}, r"values has shape \(2, 5000\): expected one row of samples"),
        (["a", "b"], {}, "values holds <U1: expected real numbers"),
        (MOTION, {"wavelet": "db44"}, "wavelet = 'db44': expected a discrete wavelet"),
        (MOTION, {"mode": "sfot"}, "mode = 'sfot': did you mean 'soft'"),
        (MOTION, {"level": 0}, "level = 0: expected a whole number of at least 1"),
        (MOTION, {"sigma": -1.0}, "sigma = -1.0: expected a value in"),
    ],
)
def test_bad_input_is_named(values: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        wavelet_denoise(values, **options)

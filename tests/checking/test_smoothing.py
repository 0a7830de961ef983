"""The Gaussian that all channels pass: derivatives of parabolas, its noise, its width, and an even grid."""

import numpy as np
import pytest

from tendonlab.checking import smoothing

WIDTHS = [1.5, 4.0, 11.0, 40.0]


def inner(values: np.ndarray, sd: float) -> np.ndarray:
    """Smoothed values that do not look beyond the ends of the record."""
    edge = int(np.ceil((smoothing.REACH + 1) * sd / smoothing.stride(sd))) + 1
    return values[edge:-edge]


@pytest.mark.parametrize("sd", WIDTHS)
def test_derivatives_of_a_parabola_are_exact(sd: float) -> None:
    """y = a + b·n + c·n²: the first derivative is b + 2·c·n, the second 2·c, and the mean a + b·n + c·(n² + var)."""
    n = np.arange(3000.0)
    a, b, c = 5.0, -0.2, 3e-4
    block = max(1, int(sd / smoothing.BLOCK))
    y = a + b * n + c * n**2
    at = smoothing.stride(sd) * np.arange(len(smoothing.smooth(y, sd))) + 0.5 * (block - 1)
    slope = smoothing.smooth(y, sd, order=1)
    np.testing.assert_allclose(inner(slope, sd), inner(b + 2 * c * at, sd), rtol=1e-9)
    np.testing.assert_allclose(inner(smoothing.smooth(y, sd, order=2), sd), 2 * c, rtol=1e-6)
    lifted = inner(smoothing.smooth(y, sd) - (a + b * at + c * at**2), sd)
    np.testing.assert_allclose(lifted, c * sd**2, rtol=0.05)  # thinning by blocks adds their own variance, 2 %


@pytest.mark.parametrize("sd", WIDTHS)
@pytest.mark.parametrize("order", [0, 1, 2])
def test_white_noise_comes_out_as_small_as_stated(sd: float, order: int) -> None:
    noise = np.random.default_rng(2).standard_normal(400_000)
    out = inner(smoothing.smooth(noise, sd, order=order), sd)
    share = 0.35 if sd < 2 else 0.08  # the formula is of a continuous Gaussian
    assert np.std(out) == pytest.approx(smoothing.spread(sd, order), rel=share)


def test_about_one_value_is_left_per_width() -> None:
    for sd in WIDTHS:
        assert smoothing.stride(sd) == pytest.approx(sd, rel=0.35)
        assert len(smoothing.smooth(np.zeros(1000), sd)) == pytest.approx(1000 / smoothing.stride(sd), abs=1)


def test_a_quiet_record_needs_the_least_width_and_a_noisy_one_more() -> None:
    """At the width found, noise is the stated share of the acceleration: counted here by smoothing each alone."""
    n = np.arange(4000.0)
    moving, rng = np.sin(0.02 * n), np.random.default_rng(3)
    assert smoothing.width([moving], [1e-9], len(n)) == smoothing.LEAST_WIDTH
    assert smoothing.width([moving], [1e-9], 10 * smoothing.MOST_SAMPLES) == 10.0
    for noise in (1e-4, 1e-3):
        sd = smoothing.width([moving + noise * rng.standard_normal(len(n))], [noise], len(n))
        shares = [noise * smoothing.spread(w, 2) / np.std(smoothing.smooth(moving, w, order=2)) for w in (sd, sd / 1.6)]
        assert shares[0] < 1.1 * smoothing.NOISE_SHARE < shares[1]
    assert smoothing.width([1e-3 * rng.standard_normal(900)], [1.0], 900) == pytest.approx(30.0)


def test_records_of_unequal_length_share_a_width() -> None:
    n, rng = np.arange(3000.0), np.random.default_rng(4)
    records = [np.sin(0.02 * n) + 1e-3 * rng.standard_normal(3000), np.zeros(900)]
    assert smoothing.width(records, [1e-3, 1e-3], 3900) <= 30.0


def test_an_even_grid_reads_a_ramp_exactly_and_a_held_sample_at_the_middle_of_its_interval() -> None:
    time = 2.0 + np.array([0.0, 0.1, 0.25, 0.3, 0.4, 0.5, 0.6])
    ramp = 3.0 * time
    grid = 2.0 + 0.1 * np.arange(7)
    np.testing.assert_allclose(smoothing.even(time, ramp, 0.1, held=False), 3.0 * grid, rtol=1e-12)
    gone = np.where(np.arange(7) == 3, np.nan, ramp)
    np.testing.assert_allclose(smoothing.even(time, gone, 0.1, held=False), 3.0 * grid, rtol=1e-12)
    steps = 0.1 * np.arange(7)
    held = smoothing.even(steps, steps, 0.1, held=True)  # a staircase below the ramp, by half a step on average
    np.testing.assert_allclose(held[1:], steps[1:] - 0.05, atol=1e-12)

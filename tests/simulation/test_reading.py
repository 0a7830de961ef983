"""What a record shows of its sensor's noise: the white part and the step of its rounding."""

import numpy as np
import pytest

from tendonlab.simulation.reading import is_noiseless, noise_sd, rounding_step, smallest_change, white_noise_sd

RAMP = np.linspace(0.0, 1.0, 5001)


def rounded(values: np.ndarray, step: float) -> np.ndarray:
    return np.floor(values / step) * step


def test_white_noise_is_seen_beneath_smooth_motion() -> None:
    noise = 0.01 * np.random.default_rng(2).standard_normal(20_000)
    line = np.linspace(0.0, 50.0, 20_000)
    assert white_noise_sd(np.sin(line) + noise) == pytest.approx(0.01, rel=0.05)
    assert white_noise_sd(noise[:9]) == 0.0


@pytest.mark.parametrize("step", [0.02, 0.007])
def test_the_step_of_rounded_readings_is_found(step: float) -> None:
    reading = rounded(RAMP, step)
    assert smallest_change(reading) == pytest.approx(step)
    assert rounding_step(reading) == pytest.approx(step)
    reading[100:4000:97] = np.nan
    assert rounding_step(np.round(reading, 5)) == pytest.approx(step, abs=1e-5)  # as a file of numbers has it
    assert noise_sd(reading) >= step / np.sqrt(12.0) * 0.999


def test_readings_of_other_kinds_have_no_step() -> None:
    rng = np.random.default_rng(3)
    stuck = np.maximum(np.sin(20.0 * RAMP), 0.0)  # at rest half of the time, and smooth
    for smooth in (RAMP, stuck, RAMP + 0.05 * rng.standard_normal(5001), np.repeat(rng.standard_normal(2500), 2)):
        assert rounding_step(smooth) == 0.0
    assert rounding_step(np.full(10, 3.0)) == smallest_change(np.full(10, 3.0)) == 0.0
    assert rounding_step(rounded(300.0 * RAMP, 0.02)) == 0.0  # moves on at every sample: differences hold the rounding


@pytest.mark.parametrize("every", [1, 2, 5, 10])
def test_noise_of_a_coarse_encoder_hardly_depends_on_the_sampling_rate(every: int) -> None:
    """Differences of so coarse readings come in few sizes: their median alone jumps by half between rates."""
    rng = np.random.default_rng(every)
    motion = 0.6 * np.sin(2 * np.pi * 0.7 * np.linspace(0.0, 20.0, 20_001)[::every])
    step = 3.8e-4
    reading = step * np.round((motion + 0.14 * step * rng.standard_normal(len(motion))) / step)
    true = step * np.hypot(1 / np.sqrt(12.0), 0.14)
    assert 0.85 * true < noise_sd(reading) < 1.25 * true


def test_only_what_was_computed_carries_no_noise() -> None:
    assert is_noiseless(np.sin(RAMP))
    assert not is_noiseless(rounded(RAMP, 0.02))
    assert not is_noiseless(RAMP + 1e-3 * np.random.default_rng(1).standard_normal(5001))

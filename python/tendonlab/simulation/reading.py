"""What a record of a sensor shows of its noise: the white part, and the steps that its readings were rounded to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

ROUNDING = 1e-9  # of its range: a record with less noise was computed, not measured
REPEATED = 0.05  # share of samples equal to the one before, from which on readings may have been rounded
ALL_NOISE = 1.3  # times the white part of records, within which all of them is noise
FEWEST, SAME_STEP = 10, 0.01  # samples of a record that may show a step; share by which steps of records may differ
SMALL, USUAL = 5.5, 0.15  # steps, up to which changes show whether all are whole; share of changes that are so small
LONG = 50.0  # steps, up to which changes are looked at where readings move on by more than a step at every sample
FEW = 2  # different numbers of steps, as triangles at one speed have them without any rounding
ROUGH = 0.5  # share of the noise of a record that such a step must make up to matter
WHOLE, MOSTLY = 0.1, 0.9  # of a step, from whole ones; share of the small changes that must be so near


def noise_sd(values: np.ndarray) -> float:
    """Sd of the noise of a record: of the white part, at least of rounding."""
    return max(white_noise_sd(values), rounding_step(values) / float(np.sqrt(12.0)))


def is_noiseless(values: np.ndarray) -> bool:
    """Whether a signal was computed, not measured."""
    kept = values[np.isfinite(values)]
    return white_noise_sd(kept) <= ROUNDING * float(np.ptp(kept)) and rounding_step(kept) == 0


def white_noise_sd(values: np.ndarray) -> float:
    """Sd of the white part of a sampled signal, from its fourth differences (smooth motion cancels)."""
    y = values[np.isfinite(values)]
    if len(y) < 10:
        return 0.0
    weights = np.sqrt(70.0)  # root of the sum of squared binomials of the fourth difference
    return float(1.4826 * np.median(np.abs(np.diff(y, 4))) / weights)


def is_all_noise(records: Sequence[np.ndarray]) -> bool:
    """Whether records of one sensor, without gaps, read 0 alone, or about one value nothing but noise."""
    if not any(record.any() for record in records):
        return True
    white = float(np.median([white_noise_sd(record) for record in records]))
    return white > 0.0 and float(np.std(np.concatenate(records))) <= ALL_NOISE * white


def rounding_step(values: np.ndarray) -> float:
    """The step of readings that were rounded: many equal the one before, and all changes are whole steps. 0 where
    nothing of the kind shows, as in readings that move on by more than a step at every sample: their differences hold
    the rounding as white noise."""
    kept = values[np.isfinite(values)]
    changes = np.abs(np.diff(kept))
    step = smallest_change(kept)
    moved = changes[changes > 0.5 * step]
    if step == 0 or len(moved) > (1.0 - REPEATED) * len(changes):
        return 0.0
    small = moved[moved < SMALL * step] / step
    is_usual, is_whole = len(small) > USUAL * len(moved), np.abs(small - np.round(small)) < WHOLE
    return step if is_usual and np.mean(is_whole) > MOSTLY else 0.0


def smallest_change(values: np.ndarray) -> float:
    """The smallest change between two samples that differ; 0 where nothing changes."""
    changes = np.abs(np.diff(values))
    changes = changes[changes > 1e-9 * max(float(np.ptp(values)), 1e-300)]
    return float(np.quantile(changes, 0.01)) if len(changes) else 0.0


def common_step(records: Sequence[np.ndarray]) -> float:
    """The step that the readings of one sensor were rounded to, as more than half of its records that move show it, or
    as all changes in all of them are multiples of it; 0 where they do not."""
    moving = [r for r in records if len(r) > FEWEST and np.nanstd(r) > 0]
    steps = np.array([rounding_step(r) for r in moving])
    if 2 * np.count_nonzero(steps) <= len(steps):
        return _coarse_step(moving)
    middle = float(np.median(steps[steps > 0]))
    return middle if 2 * np.count_nonzero(np.abs(steps - middle) < SAME_STEP * middle) > len(steps) else 0.0


def _coarse_step(records: Sequence[np.ndarray]) -> float:
    """The step of which all changes of all records are multiples, where rounding to it is much of their noise; 0 where
    there is none. Of changes that are rounded to nothing a fifth would look like multiples; those of a steady motion
    are all one."""
    steps = [step for r in records if (step := smallest_change(r)) > 0.0]
    noise = float(np.median([white_noise_sd(r) for r in records])) if records else 0.0
    if not steps or min(steps) < ROUGH * noise * np.sqrt(12.0):
        return 0.0
    step, different = min(steps), set()
    for record in records:
        multiples = np.abs(np.diff(record)) / step
        multiples = multiples[(multiples > 0.5) & (multiples < LONG)]
        if len(multiples) and np.mean(np.abs(multiples - np.round(multiples)) < WHOLE) < MOSTLY:
            return 0.0
        different |= set(np.round(multiples).tolist())
    return step if len(different) > FEW else 0.0

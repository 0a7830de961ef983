"""Whether stated probabilities are true: how often what was called p came out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit, logit

from tendonlab.rehearsal.curve import clopper_pearson

Array = NDArray[np.float64]
NUM_BINS, NUM_DRAWS = 10, 400
NUM_SAMPLES = 2000  # bootstrap samples of rigs
Interval = tuple[float, float]
LEAST = 1e-4  # a stated probability counts as no closer to 0 or 1
WEAK = 0.05  # precision of the prior of slope and shift


def calibration_error(probability: Array, came_true: Array) -> float:
    """Mean distance of the stated probabilities from the shares that came true, over ten bins of equal width."""
    return float(np.sum(np.abs(_gaps(probability, came_true))) / probability.size)


def _gaps(probability: Array, came_true: Array) -> Array:
    """Stated probabilities less what came true, summed in every bin."""
    place = np.minimum((probability * NUM_BINS).astype(int), NUM_BINS - 1)
    return np.asarray(np.bincount(place, probability - came_true, minlength=NUM_BINS), dtype=float)


def error_beyond_chance(probability: Array, came_true: Array) -> float:
    """`calibration_error` less what a forecaster whose probabilities are true would show at this number of cases."""
    draw = np.random.default_rng(0)
    lucky = draw.random((NUM_DRAWS, probability.size)) < probability
    chance = np.mean([calibration_error(probability, row.astype(float)) for row in lucky])
    return calibration_error(probability, came_true) - float(chance)


def reliability_line(probability: Array, came_true: Array) -> tuple[float, float]:
    """Slope and shift of the true log odds over the stated ones, 1 and 0 where probabilities are true; below 1 they
    are too sure of themselves."""
    stated = logit(np.clip(probability, LEAST, 1.0 - LEAST))

    def cost(line: Array) -> float:
        true = expit(line[0] * stated + line[1])
        true = np.clip(true, 1e-12, 1.0 - 1e-12)
        likelihood = np.sum(came_true * np.log(true) + (1.0 - came_true) * np.log(1.0 - true))
        return float(WEAK * ((line[0] - 1.0) ** 2 + line[1] ** 2) - likelihood)

    slope, shift = minimize(cost, np.array([1.0, 0.0]), method="Nelder-Mead").x
    return float(slope), float(shift)


def too_far_off(probability: Array, came_true: Array) -> float:
    """Spiegelhalter's z: by how many standard deviations the outcomes are worse than true probabilities would let them
    be; beyond +-1.96 the probabilities are false."""
    excess = np.sum((came_true - probability) * (1.0 - 2.0 * probability))
    spread = np.sqrt(np.sum((1.0 - 2.0 * probability) ** 2 * probability * (1.0 - probability)))
    return float(excess / spread) if spread > 0 else 0.0


def spread_of_error(groups: Sequence[Sequence[tuple[float, bool]]]) -> float:
    """Standard deviation of the calibration error over bootstrap samples of rigs; each group holds the probabilities of
    one rig, which belong together, and whether they came true."""
    columns = [np.array(group, dtype=float).reshape(-1, 2).T for group in groups]
    gaps, sizes = np.array([_gaps(*column) for column in columns]), np.array([len(group) for group in groups])
    times = _samples(len(groups))
    return float(np.std(np.abs(times @ gaps).sum(axis=1) / np.maximum(times @ sizes, 1)))


def interval_of_mean(values: Array) -> Interval | None:
    """95 % interval of the mean of numbers from 0 to 1, one for each rig, by bootstrap; where all are 0, or all are 1,
    that of Clopper and Pearson. None for a single rig."""
    if values.size < 2:
        return None
    if np.ptp(values) == 0.0 and values[0] in (0.0, 1.0):
        return clopper_pearson(round(float(values.sum())), values.size)
    low, high = np.quantile(_samples(values.size) @ values / values.size, [0.025, 0.975])
    return float(low), float(high)


def _samples(num: int) -> Array:
    """How often each of `num` rigs is in each bootstrap sample."""
    return np.random.default_rng(0).multinomial(num, np.full(num, 1.0 / num), size=NUM_SAMPLES).astype(float)

"""Whether stated probabilities are true: how often what was called p came out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit, logit

Array = NDArray[np.float64]
NUM_BINS, NUM_DRAWS = 10, 400
LEAST = 1e-4  # a stated probability counts as no closer to 0 or 1
WEAK = 0.05  # precision of the prior of slope and shift


def calibration_error(probability: Array, came_true: Array) -> float:
    """Mean distance of the stated probabilities from the shares that came true, over ten bins of equal width."""
    place = np.minimum((probability * NUM_BINS).astype(int), NUM_BINS - 1)
    gaps = np.bincount(place, probability - came_true, minlength=NUM_BINS)
    return float(np.sum(np.abs(gaps)) / probability.size)


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

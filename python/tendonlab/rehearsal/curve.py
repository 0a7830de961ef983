"""From counts at several sizes to the size from which 9 in 10 are found, with intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

TARGET = 0.9  # share of the rigs in which an effect must be found
GRID = 161  # values of the midpoint and of the steepness
STEEPNESS = (0.7, 12.0)  # of the logistic curve per e-fold of the size
BEYOND = 8.0  # how far outside the sizes that were tried the midpoint may lie, as a factor
LEVEL = 0.95


@dataclass(frozen=True)
class DetectionCurve:
    """P(found) = 1/(1 + exp(−b (log size − m))), with weights of many m and b: a posterior under a flat prior of m and
    of log b. It rises with the size by construction."""

    midpoint: np.ndarray
    steepness: np.ndarray
    weight: np.ndarray

    def probability(self, sizes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Mean and 95 % bounds of P(found) at `sizes`, shape (n,) each."""
        shares = _logistic(self.steepness * (np.log(sizes)[:, None] - self.midpoint))
        bounds = [[_quantile(row, self.weight, q) for q in ((1 - LEVEL) / 2, (1 + LEVEL) / 2)] for row in shares]
        low, high = np.array(bounds).T
        return shares @ self.weight, low, high

    def size_at(self, share: float, level: float) -> float:
        """Quantile `level` of the size at which `share` is found."""
        logs = self.midpoint + np.log(share / (1 - share)) / self.steepness
        return float(np.exp(_quantile(logs, self.weight, level)))


def fit_curve(sizes: Sequence[float], found: Sequence[int], tried: Sequence[int]) -> DetectionCurve:
    """The curve for `found` of `tried` rigs at each size; sizes > 0, at least one tried."""
    logs = np.log(np.asarray(sizes, dtype=float))
    middle = np.linspace(logs.min() - np.log(BEYOND), logs.max() + np.log(BEYOND), GRID)
    steep = np.geomspace(*STEEPNESS, GRID)
    m, b = (axis.ravel() for axis in np.meshgrid(middle, steep))
    share = np.clip(_logistic(b * (logs[:, None] - m)), 1e-12, 1 - 1e-12)
    hits, num = np.asarray(found, dtype=float)[:, None], np.asarray(tried, dtype=float)[:, None]
    log_likelihood = (hits * np.log(share) + (num - hits) * np.log1p(-share)).sum(axis=0)
    weight = np.exp(log_likelihood - log_likelihood.max())
    return DetectionCurve(m, b, weight / weight.sum())


@dataclass(frozen=True)
class Threshold:
    """The size from which an effect is found 9 times in 10. `kind`: "within" the sizes that were tried, "above" all of
    them or "below" all of them; then `size` is the largest or the smallest of them. `ci95`: bounds of the size, None
    where they lie outside of what was tried."""

    kind: str
    size: float
    ci95: tuple[float | None, float | None]


def threshold_of(sizes: Sequence[float], found: Sequence[int], tried: Sequence[int]) -> Threshold:
    """Where the curve through the counts reaches 9 in 10."""
    curve = fit_curve(sizes, found, tried)
    low, best, high = (curve.size_at(TARGET, q) for q in ((1 - LEVEL) / 2, 0.5, (1 + LEVEL) / 2))
    first, last = min(sizes), max(sizes)
    inside = tuple(bound if first <= bound <= last else None for bound in (low, high))
    if best > last:
        return Threshold("above", last, (inside[0], None))
    if best < first:
        return Threshold("below", first, (None, inside[1]))
    return Threshold("within", best, (inside[0], inside[1]))


def clopper_pearson(hits: int, num: int) -> tuple[float, float]:
    """Exact 95 % interval of a share, `hits` of `num`; 0 to 1 where nothing was tried."""
    from scipy.stats import beta

    tail = (1 - LEVEL) / 2
    low = 0.0 if hits == 0 else float(beta.ppf(tail, hits, num - hits + 1))
    high = 1.0 if hits == num else float(beta.ppf(1 - tail, hits + 1, num - hits))
    return low, high


def _logistic(x: np.ndarray) -> np.ndarray:
    return np.asarray(0.5 * (1 + np.tanh(0.5 * x)))


def _quantile(values: np.ndarray, weight: np.ndarray, level: float) -> float:
    order = np.argsort(values)
    place = int(np.searchsorted(np.cumsum(weight[order]), level))
    return float(values[order][min(place, len(values) - 1)])

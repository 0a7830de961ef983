"""How far fitted values can be trusted when the residuals are neither white nor independent: a clustered sandwich."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri, stdtrit

from tendonlab._core import Free

FEWEST_EXPERIMENTS = 4  # with fewer, contiguous blocks of 2 s stand for them
ALIKE = 2.0  # so many experiments speak for the belief that experiments scatter no more than blocks
NOTHING = 1e-8  # of a prior's variance: data that narrow it by less say nothing

Marginal = tuple[np.ndarray, np.ndarray, Sequence[np.ndarray]]  # residual, jacobian, rows of each block as masks


@dataclass(frozen=True)
class Uncertainty:
    """Of the values, one per free parameter: sd, ends of the 95 % interval; correlations of the coordinates."""

    sd: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    correlations: np.ndarray


def informed(jacobians: Iterable[np.ndarray], free: Sequence[Free]) -> np.ndarray:
    """For each free parameter, whether any residual depends on it. `jacobians`: of the residuals, in noise sd, by the
    coordinates, shape (rows, free)."""
    with np.errstate(over="ignore"):  # derivatives may explode: then they inform
        information = sum((np.sum(np.square(j), axis=0) for j in jacobians), np.zeros(len(free)))
    width = np.array([f.sd if np.isfinite(f.sd) else 1.0 for f in free])
    return np.asarray(information * width**2 > NOTHING)


@np.errstate(over="ignore", invalid="ignore")  # derivatives may explode: nothing is then known of a parameter
def uncertainty(
    runs: Sequence[Marginal],
    free: Sequence[Free],
    x: np.ndarray,
    *,
    at_bound: Sequence[bool],
    informed: Sequence[bool],
    count: float | None = None,
) -> Uncertainty:
    """Uncertainty of a fit that ended at `x`, whose rows `runs` count as `count` independent ones (default: all).

    Covariance H^-1 (B + P) H^-1: H is the curvature with priors, P the priors' part of it, B the sum of g g' over
    clusters with g the score of a cluster. Clusters are contiguous blocks of at least 2 s, and with four experiments
    or more also the experiments, whose variance is pooled with that of blocks: few experiments tell their own scatter
    badly. The larger sd counts, and none is below that of independent noise of the residuals' size. Intervals use
    Student's t with the number of clusters. A parameter at a bound counts as fixed for the others; its own sd is what
    it would be without the bound, where its interval ends. One that is not informed is what its prior says."""
    known = np.asarray(informed, dtype=bool)
    inside = known & ~np.asarray(at_bound, dtype=bool)
    precision = np.array([0.0 if np.isinf(f.sd) else f.sd**-2.0 for f in free])
    count = float(sum(len(residual) for residual, _, _ in runs)) if count is None else count
    covariances = _covariances(runs, precision, inside, count)
    sd = np.array([f.sd for f in free])
    half = ndtri(0.975) * sd
    if (known & ~inside).any():
        sd[known], half[known] = _spread(_covariances(runs, precision, known, count))
    sd[inside], half[inside] = _spread(covariances)
    correlations = np.eye(len(free))
    last, _ = covariances[min(1, len(covariances) - 1)]
    correlations[np.ix_(inside, inside)] = _correlation(last)
    return _intervals(free, x, sd, half, correlations)


def _correlation(covariance: np.ndarray) -> np.ndarray:
    """Of each pair; 0 with what has no variance that doubles resolve."""
    variance = np.diag(covariance)
    spread = variance > 1e-300
    scale = np.sqrt(np.where(spread, variance, 1.0))
    found = np.where(np.outer(spread, spread), covariance / np.outer(scale, scale), 0.0)
    np.fill_diagonal(found, 1.0)
    return np.where(np.isfinite(found), found, 0.0)


def _covariances(
    runs: Sequence[Marginal], precision: np.ndarray, inside: np.ndarray, count: float
) -> list[tuple[np.ndarray, float]]:
    """Of the coordinates `inside`, others fixed: for independent residuals, blocks, and experiments where there are
    enough of them; each with its number of clusters."""
    prior = np.diag(precision[inside])
    slopes = [jacobian[:, inside] for _, jacobian, _ in runs]
    information = sum((j.T @ j for j in slopes), np.zeros_like(prior))
    bread = _inverse(information + prior)
    misfit = sum(float(residual @ residual) for residual, _, _ in runs)
    size = max(1.0, misfit / max(1.0, count - int(inside.sum())))
    found = [(bread @ (size * information + prior) @ bread, count)]
    scores = [j * residual[:, None] for j, (residual, _, _) in zip(slopes, runs, strict=True)]
    blocks = [score[part].sum(axis=0) for score, (_, _, parts) in zip(scores, runs, strict=True) for part in parts]
    found.append((_sandwich(bread, prior, blocks), len(blocks)))
    if len(runs) >= FEWEST_EXPERIMENTS:
        found.append((_sandwich(bread, prior, [score.sum(axis=0) for score in scores]), len(runs)))
    return found


def _inverse(curvature: np.ndarray) -> np.ndarray:
    """Scaled to a unit diagonal first, so that no parameter is lost beside one that is known far better."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(curvature), 1e-300))
    return np.asarray(scale[:, None] * np.linalg.pinv(scale[:, None] * curvature * scale, hermitian=True) * scale)


def _sandwich(bread: np.ndarray, prior: np.ndarray, scores: Sequence[np.ndarray]) -> np.ndarray:
    """With the usual factor for few clusters; one cluster alone says nothing of its spread."""
    clusters = len(scores)
    stacked = np.array(scores)
    meat = stacked.T @ stacked * (clusters / (clusters - 1) if clusters > 1 else 1.0)
    return np.asarray(bread @ (meat + prior) @ bread)


def _spread(covariances: Sequence[tuple[np.ndarray, float]]) -> tuple[np.ndarray, np.ndarray]:
    """Sd and half width of the 95 % interval of each coordinate: the largest that any of the covariances gives."""
    variance = [np.maximum(np.diag(covariance), 0.0) for covariance, _ in covariances]
    variance = [np.where(np.isnan(v), np.inf, v) for v in variance]
    freedom = [max(1.0, clusters - 1) for _, clusters in covariances]
    if len(covariances) == 3:
        variance[2] = (ALIKE * variance[1] + freedom[2] * variance[2]) / (ALIKE + freedom[2])
        freedom[2] += ALIKE
    sd = np.sqrt(variance)
    return np.max(sd, axis=0), np.max(sd * stdtrit(freedom, 0.975)[:, None], axis=0)


def _intervals(
    free: Sequence[Free], x: np.ndarray, sd: np.ndarray, half: np.ndarray, correlations: np.ndarray
) -> Uncertainty:
    """The same for the values: sd and half intervals of the coordinates through their slopes, within bounds."""
    slope = np.array([f.slope(a) for f, a in zip(free, x, strict=True)])
    lower = np.array([f.value(a - h) for f, a, h in zip(free, x, half, strict=True)])
    upper = np.array([f.value(a + h) for f, a, h in zip(free, x, half, strict=True)])
    return Uncertainty(sd * slope, lower, upper, correlations)

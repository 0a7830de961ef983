"""How far fitted values can be trusted when the residuals are neither white nor independent: a clustered sandwich."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

from tendonlab.fitting.priors import Free
from tendonlab.simulation.prepare import Prepared

BLOCK = 2.0  # s: longer than residuals of a mechanism stay correlated
FEWEST_EXPERIMENTS = 4  # that can stand for the spread between experiments


@dataclass(frozen=True)
class Uncertainty:
    """Of the values, one a free parameter: sd, ends of the 95 % interval, and correlations of the coordinates."""

    sd: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    correlations: np.ndarray


@dataclass(frozen=True)
class Linear:
    """One experiment about the optimum: residuals, sensitivities free of its initial state, and each row's time, s."""

    residual: np.ndarray
    sensitivity: np.ndarray
    time: np.ndarray


def uncertainty(
    found: dict[str, Any],
    free: Sequence[Free],
    informed: np.ndarray,
    experiments: Sequence[Prepared],
    scored: Sequence[bool],
) -> Uncertainty:
    """Uncertainty of a fit `found` (see `_core.fit`), in which `informed` parameters have data of their own.

    Covariance H^-1 (B + P) H^-1: H is the curvature with priors and without the nuisances, P the priors' part of it,
    B the sum of g g' over clusters with g the score of a cluster. Clusters are contiguous blocks of at least 2 s, and
    with four experiments or more also the experiments; the larger sd counts, and none is below that of independent
    noise of the residuals' size. Intervals use Student's t with the number of clusters. A parameter at a bound
    counts as fixed for the others; its own sd is what it would be without the bound, where its interval ends. One that
    is not informed is what its prior says."""
    runs = [_linear(found, e, k, scored) for k, e in enumerate(experiments)]
    precision = np.array([0.0 if np.isinf(f.sd) else f.sd**-2.0 for f in free])
    inside = informed & ~np.asarray(found["at_bound"], dtype=bool)
    covariances = _covariances(runs, precision, inside)
    sd = np.array([f.sd for f in free])
    half = stats.norm.ppf(0.975) * sd
    if (informed & ~inside).any():
        sd[informed], half[informed] = _spread(_covariances(runs, precision, informed))
    sd[inside], half[inside] = _spread(covariances)
    correlations = np.eye(len(free))
    last, _ = covariances[min(1, len(covariances) - 1)]
    scale = np.sqrt(np.maximum(np.diag(last), 1e-300))
    correlations[np.ix_(inside, inside)] = last / np.outer(scale, scale)
    return _intervals(found, free, sd, half, correlations)


def _covariances(runs: Sequence[Linear], precision: np.ndarray, inside: np.ndarray) -> list[tuple[np.ndarray, int]]:
    """Of the coordinates `inside`, others fixed: for independent residuals, blocks, and experiments where there are
    enough of them; each with its number of clusters."""
    prior = np.diag(precision[inside])
    information = sum((r.sensitivity[:, inside].T @ r.sensitivity[:, inside] for r in runs), np.zeros_like(prior))
    bread = _inverse(information + prior)
    rows = sum(len(r.residual) for r in runs)
    size = max(1.0, sum(float(r.residual @ r.residual) for r in runs) / max(1, rows - int(inside.sum())))
    found = [(bread @ (size * information + prior) @ bread, rows)]
    blocks = [g for r in runs for g in _block_scores(r, inside)]
    found.append((_sandwich(bread, prior, blocks), len(blocks)))
    if len(runs) >= FEWEST_EXPERIMENTS:
        whole = [r.sensitivity[:, inside].T @ r.residual for r in runs]
        found.append((_sandwich(bread, prior, whole), len(whole)))
    return found


def _linear(found: dict[str, Any], experiment: Prepared, k: int, scored: Sequence[bool]) -> Linear:
    """Initial states enter as nuisances with their unit priors: what they explain is taken from the sensitivities."""
    jacobian, nuisance = np.asarray(found["jacobian"][k]), np.asarray(found["jacobian_initial"][k])
    weight = nuisance.T @ nuisance + np.eye(nuisance.shape[1])
    sensitivity = jacobian - nuisance @ np.linalg.solve(weight, nuisance.T @ jacobian)
    time = np.asarray(experiment.core.time)
    stamps = [time[np.isfinite(m)] for m, s in zip(experiment.measured, scored, strict=True) if s]
    return Linear(np.asarray(found["residuals"][k]), sensitivity, np.concatenate(stamps))


def _inverse(curvature: np.ndarray) -> np.ndarray:
    """Scaled to a unit diagonal first, so that no parameter is lost beside one that is known far better."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(curvature), 1e-300))
    return np.asarray(scale[:, None] * np.linalg.pinv(scale[:, None] * curvature * scale, hermitian=True) * scale)


def _block_scores(run: Linear, inside: np.ndarray) -> list[np.ndarray]:
    begin, end = float(run.time.min()), float(run.time.max())
    num_blocks = max(1, int((end - begin) / BLOCK))
    edges = np.linspace(begin, end, num_blocks + 1)[1:-1]
    block = np.searchsorted(edges, run.time, side="right")
    scores = run.sensitivity[:, inside] * run.residual[:, None]
    return [scores[block == b].sum(axis=0) for b in range(num_blocks)]


def _sandwich(bread: np.ndarray, prior: np.ndarray, scores: Sequence[np.ndarray]) -> np.ndarray:
    """With the usual factor for few clusters; one cluster alone says nothing of its spread."""
    clusters = len(scores)
    stacked = np.array(scores)
    meat = stacked.T @ stacked * (clusters / (clusters - 1) if clusters > 1 else 1.0)
    return np.asarray(bread @ (meat + prior) @ bread)


def _spread(covariances: Sequence[tuple[np.ndarray, int]]) -> tuple[np.ndarray, np.ndarray]:
    """Sd and half width of the 95 % interval of each coordinate: the largest that any of the covariances gives."""
    sd = [np.sqrt(np.maximum(np.diag(covariance), 0.0)) for covariance, _ in covariances]
    half = [one * stats.t.ppf(0.975, max(1, c - 1)) for one, (_, c) in zip(sd, covariances, strict=True)]
    return np.max(sd, axis=0), np.max(half, axis=0)


def _intervals(
    found: dict[str, Any], free: Sequence[Free], sd: np.ndarray, half: np.ndarray, correlations: np.ndarray
) -> Uncertainty:
    """The same for the values: sd and half intervals of the coordinates through their slopes, within bounds."""
    x = np.array(found["x"])
    bounded = [sorted((f.value(a - h), f.value(a + h))) for f, a, h in zip(free, x, half, strict=True)]
    slope = np.array([abs(f.slope(a)) for f, a in zip(free, x, strict=True)])
    lower = np.array([max(b[0], f.lower) for b, f in zip(bounded, free, strict=True)])
    upper = np.array([min(b[1], f.upper) for b, f in zip(bounded, free, strict=True)])
    return Uncertainty(sd * slope, lower, upper, correlations)

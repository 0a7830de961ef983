"""Whether what a model leaves follows the motion: noise of a sensor does not, and what the model lacks often does."""

from __future__ import annotations

import numpy as np

from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted

NUM_KNOTS = 9  # of the map over the position, at quantiles
SLOW = 0.03  # of the velocity's rms: neither forwards nor backwards
RIDGE = 0.02  # prior weight of each cell, of an even share of the samples


FAR_TRAINED = 8.0  # mean square over what the sensors and run-to-run friction may leave, beyond which it is no noise
FOLLOWED = 0.2  # share of the residual that follows the motion, beyond which it is no noise


def may_be_noise(case: Case, model: Fitted) -> bool:
    """Whether nothing in what a model leaves tells that anything is missing, where nothing repeats."""
    return model.over_scatter(len(case.scatter)) < FAR_TRAINED and followed(case, model) < FOLLOWED


def followed(case: Case, model: Fitted) -> float:
    """Largest share of the mean square residual of an output that a map over position and direction of a port foretells
    in experiments other than those that it was learnt from; 0 where maps mislead, and of a single experiment."""
    if len(case.train) < 2:
        return 0.0
    runs = [case.run(i, model.system, own, ports=True) for i, own in zip(case.train, model.initial, strict=True)]
    residuals = [run["outputs"] - case.prepared[i].measured for i, run in zip(case.train, runs, strict=True)]
    shares = [0.0]
    for port in range(len(case.system.info.ports)):
        motions = [np.asarray(run["ports"])[port] for run in runs]
        if np.ptp(np.concatenate([m[1] for m in motions])) == 0.0:
            continue
        cells = _cells(motions)
        shares += [_foretold(cells, [r[c] for r in residuals]) for c in case.measured]
    return max(shares)


def _cells(motions: list[np.ndarray]) -> list[np.ndarray]:
    """Weights of the cells of the map at each sample of each experiment, (samples, cells)."""
    velocity, position = (np.concatenate([m[k] for m in motions]) for k in (0, 1))
    knots = np.unique(np.quantile(position, np.linspace(0.0, 1.0, NUM_KNOTS)))
    slow = SLOW * float(np.sqrt(np.mean(np.square(velocity))))
    found = []
    for motion in motions:
        direction = np.sign(motion[0]) * (np.abs(motion[0]) > slow)
        near = np.array([np.interp(motion[1], knots, row) for row in np.eye(len(knots))]).T
        found.append(np.concatenate([near * (direction == d)[:, None] for d in (-1.0, 0.0, 1.0)], axis=1))
    return found


def _foretold(cells: list[np.ndarray], residuals: list[np.ndarray]) -> float:
    """Share of the mean square of all residuals that maps learnt from all other experiments foretell."""
    there = [np.isfinite(r) for r in residuals]
    pairs = [(a[ok], r[ok]) for a, r, ok in zip(cells, residuals, there, strict=True) if ok.any()]
    if len(pairs) < 2:
        return 0.0
    inner, along = [a.T @ a for a, _ in pairs], [a.T @ r for a, r in pairs]
    total, left = sum(float(r @ r) for _, r in pairs), 0.0
    for k, (a, r) in enumerate(pairs):
        others = sum(inner) - inner[k]
        weight = RIDGE * np.trace(others) / len(others)
        learnt = np.linalg.solve(others + weight * np.eye(len(others)), sum(along) - along[k])
        left += float(np.sum(np.square(r - a @ learnt)))
    return 1.0 - left / total if total > 0 else 0.0

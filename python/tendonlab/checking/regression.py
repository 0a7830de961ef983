"""Robust regression with beliefs: Student-t residuals, a scale per equation, unknowns with priors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

FREEDOM = 4.0  # of Student's t: outliers lose their say
MOST_STEPS, CLOSE = 30, 1e-4
LONGEST = 1.0  # step in the logarithm of an unknown
LEVEL_STEPS = 3
RIDGE = 1e-10
TINY = 1e-6  # of its own size: no equation is satisfied better than this


@dataclass(frozen=True)
class Unknown:
    """A number that the regression may change from what is believed: 0, with that sd. `logarithm`: it multiplies its
    term by its exponential; `positive`: it cannot be negative."""

    name: str
    sd: float
    logarithm: bool = False
    positive: bool = False


@dataclass(frozen=True)
class Fit:
    """`cost`: negative log posterior, nats; `x`: the unknowns, `sd` of each from the data and the beliefs; `level`:
    robust rms residual of each equation in units of its own channel; `residual`: (equations, samples)."""

    cost: float
    x: np.ndarray
    sd: np.ndarray
    level: np.ndarray
    residual: np.ndarray
    strain: float


def impossible(num: int, residual: np.ndarray) -> Fit:
    """The fit where there is none: its cost is infinite."""
    infinite = np.full(len(residual), np.inf)
    return Fit(np.inf, np.zeros(num), np.full(num, np.inf), infinite, residual, np.inf)


@np.errstate(all="ignore")
def fit(
    residual: np.ndarray,
    columns: np.ndarray,
    unknowns: tuple[Unknown, ...],
    size: np.ndarray,
    share: np.ndarray,
    *,
    steps: int = MOST_STEPS,
) -> Fit:
    """The most probable unknowns for `residual` + sum of columns·unknowns = noise.

    `residual` (equations, samples), `columns` (unknowns, equations, samples); `size`: of each equation's own channel;
    `share`: of its samples that count as independent."""
    r0, t = residual / size[:, None], columns / size[:, None]
    logarithm, positive = (np.array([getattr(u, of) for u in unknowns], dtype=bool) for of in ("logarithm", "positive"))
    belief = np.array([1.0 / u.sd**2 for u in unknowns])
    longest = np.where(logarithm, LONGEST, np.inf)
    x = np.zeros(len(unknowns))
    r = r0 + np.tensordot(_amount(x, logarithm), t, axes=1)
    level, weight = scale_and_weight(r, 1.4826 * np.median(np.abs(r), axis=1))
    information = np.diag(belief)
    for _ in range(steps):
        root = np.sqrt(weight * (share / level**2)[:, None])
        rows = (t * growth(x, unknowns)[:, None, None] * root).reshape(len(x), -1)
        information = rows @ rows.T + np.diag(belief)
        gradient = rows @ (r * root).ravel() + belief * x
        if not (np.isfinite(information).all() and np.isfinite(gradient).all()):
            return impossible(len(x), residual)
        step = _solve(information, gradient, x, positive)
        step = np.clip(step, -longest, longest)
        x = x + step
        r = r0 + np.tensordot(_amount(x, logarithm), t, axes=1)
        level, weight = scale_and_weight(r, level)
        if np.all(np.abs(step) < CLOSE * (1.0 + np.abs(x))):
            break
    strain = np.abs(x) * np.sqrt(belief)
    sd = np.sqrt(np.maximum(np.diag(np.linalg.pinv(information, hermitian=True)), 0.0))
    cost = float(share @ _surprise(r, level) + 0.5 * np.sum(strain**2))
    return Fit(cost, x, sd, level, r * size[:, None], float(strain.max(initial=0.0)))


def growth(x: np.ndarray, unknowns: tuple[Unknown, ...]) -> np.ndarray:
    """By how much the column of each unknown has grown at `x`."""
    logarithm = np.array([u.logarithm for u in unknowns], dtype=bool)
    return np.asarray(np.where(logarithm, np.exp(np.where(logarithm, x, 0.0)), 1.0))


def _amount(x: np.ndarray, logarithm: np.ndarray) -> np.ndarray:
    return np.where(logarithm, np.expm1(np.where(logarithm, x, 0.0)), x)


def scale_and_weight(r: np.ndarray, level: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Scale of Student's t of each equation, near `level`, and the weight of each sample."""
    square = np.square(r)
    for _ in range(LEVEL_STEPS):
        level = np.maximum(level, TINY)
        weight = (FREEDOM + 1) / (FREEDOM + square / level[:, None] ** 2)
        level = np.sqrt(np.mean(weight * square, axis=1))
    return np.maximum(level, TINY), weight


def _surprise(r: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Negative log likelihood of each equation, all samples independent."""
    tails = 0.5 * (FREEDOM + 1) * np.log1p((r / level[:, None]) ** 2 / FREEDOM)
    return np.asarray(np.log(level) * r.shape[1] + np.sum(tails, axis=1))


def _solve(information: np.ndarray, gradient: np.ndarray, x: np.ndarray, positive: np.ndarray) -> np.ndarray:
    """The Gauss-Newton step; unknowns that would become negative and cannot are held at 0."""
    information = information + RIDGE * np.diag(np.diag(information) + 1.0)
    held = np.zeros(len(x), dtype=bool)
    while True:
        free = ~held
        step = np.where(held, -x, 0.0)
        right = -(gradient + information[:, held] @ step[held])[free]
        step[free] = np.linalg.solve(information[np.ix_(free, free)], right)
        below = positive & ~held & (x + step < 0)
        if not below.any():
            return step
        held |= below

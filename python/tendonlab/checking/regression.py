"""Robust regression with beliefs: Student-t residuals, a scale per equation, unknowns with priors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tendonlab import _core

FREEDOM = 4.0  # of Student's t in the core: outliers lose their say
MOST_STEPS = 30


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
    robust rms residual of each equation in units of its own channel; `residual`, and the `weight` of each sample:
    (equations, samples)."""

    cost: float
    x: np.ndarray
    sd: np.ndarray
    level: np.ndarray
    residual: np.ndarray
    weight: np.ndarray
    strain: float


def impossible(num: int, residual: np.ndarray) -> Fit:
    """The fit where there is none: its cost is infinite."""
    infinite = np.full(len(residual), np.inf)
    return Fit(np.inf, np.zeros(num), np.full(num, np.inf), infinite, residual, np.zeros_like(residual), np.inf)


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
    r = residual / size[:, None]
    belief = np.array([1.0 / u.sd**2 for u in unknowns])
    found = _core.regress(
        r,
        (columns / size[:, None]).reshape(len(unknowns), -1),
        belief,
        _flags(unknowns, "logarithm"),
        _flags(unknowns, "positive"),
        share,
        1.4826 * np.median(np.abs(r), axis=1),
        steps,
    )
    if not found["finite"]:
        return impossible(len(unknowns), residual)
    x, r, level = found["x"], found["residual"], found["level"]
    strain = np.abs(x) * np.sqrt(belief)
    sd = np.sqrt(np.maximum(np.diag(np.linalg.pinv(found["information"], hermitian=True)), 0.0))
    cost = float(share @ _surprise(r, level) + 0.5 * np.sum(strain**2))
    return Fit(cost, x, sd, level, r * size[:, None], found["weight"], float(strain.max(initial=0.0)))


def _flags(unknowns: tuple[Unknown, ...], of: str) -> list[bool]:
    return [getattr(u, of) for u in unknowns]


def growth(x: np.ndarray, unknowns: tuple[Unknown, ...]) -> np.ndarray:
    """By how much the column of each unknown has grown at `x`."""
    logarithm = np.array(_flags(unknowns, "logarithm"), dtype=bool)
    return np.asarray(np.where(logarithm, np.exp(np.where(logarithm, x, 0.0)), 1.0))


def _surprise(r: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Negative log likelihood of each equation, all samples independent."""
    tails = 0.5 * (FREEDOM + 1) * np.log1p((r / level[:, None]) ** 2 / FREEDOM)
    return np.asarray(np.log(level) * r.shape[1] + np.sum(tails, axis=1))

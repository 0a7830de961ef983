"""The cubic smoothing spline of a long record, its smoothness chosen by generalised cross-validation (GCV)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg.lapack import zgbtrf, zgbtrs

from tendonlab.simulation.rests import settled

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

SEARCHED = (-14.0, 30.0)  # of log lambda, in mean steps³: from through the samples to periods of 10 000 of them
COARSE, FINE = 2.0, 1e-3  # in log lambda: distance of the first looks, accuracy of the last
TINY = 1e-30  # relative imaginary step of lambda; no difference is taken, so none is lost


def smoothing_spline(time: np.ndarray, values: np.ndarray) -> CubicSpline:
    """The function g with the least sum of (values - g)² + lambda·integral of g''², at the lambda of least GCV; where
    the record rests, the values are their mean.

    `time`: increasing, s, shape (n,), n >= 5; `values`: shape (n,), finite. Cost is proportional to n. Source:
    P. J. Green and B. W. Silverman, Nonparametric Regression and Generalized Linear Models, sections 2.3 and 3.2."""
    from scipy.interpolate import CubicSpline

    step = float(time[-1] - time[0]) / (len(time) - 1)
    smoother = Smoother.of(time / step, values)
    best = smoother.best()
    fitted, freedom = smoother.solve(best)
    noise = float(np.sqrt(np.mean((values - fitted) ** 2) * len(values) / freedom))
    fitted, _ = replace(smoother, values=settled(time, values, noise)).solve(best)
    return CubicSpline(time, fitted, bc_type="natural")


@dataclass(frozen=True)
class Smoother:
    """Reinsch's equations (R + lambda Q'Q) g'' = Q' values, g = values - lambda Q g'', for a record of unit mean step.

    `second`: the rows of Q' as three diagonals; `stiff`, `rough`: R and Q'Q as main diagonal and the two beside it."""

    values: np.ndarray
    second: np.ndarray
    stiff: np.ndarray
    rough: np.ndarray

    @classmethod
    def of(cls, time: np.ndarray, values: np.ndarray) -> Smoother:
        """For `values` at instants `time`, in mean steps."""
        h = np.diff(time)
        q = np.array([1 / h[:-1], -1 / h[:-1] - 1 / h[1:], 1 / h[1:]])
        r = np.zeros_like(q)
        r[0], r[1, :-1] = (h[:-1] + h[1:]) / 3, h[1:-1] / 6
        p = np.zeros_like(q)
        p[0] = np.sum(q**2, axis=0)
        p[1, :-1] = q[1, :-1] * q[0, 1:] + q[2, :-1] * q[1, 1:]
        p[2, :-2] = q[2, :-2] * q[0, 2:]
        return cls(values, q, r, p)

    def best(self) -> float:
        """log lambda at the minimum of GCV, from coarse to fine. (Over lambda itself, which spans decades, a search
        ends far from it: in a straight line, or in a spline too stiff for what moves within tens of samples.)"""
        from scipy.optimize import minimize_scalar

        looks = np.arange(*SEARCHED, COARSE)
        near = float(looks[np.argmin([self.score(x) for x in looks])])
        bounds = (near - COARSE, near + COARSE)
        return float(minimize_scalar(self.score, bounds=bounds, method="bounded", options={"xatol": FINE}).x)

    def score(self, log_lambda: float) -> float:
        """GCV: mean square residual over the square of the share of freedom that is left to it."""
        fitted, freedom = self.solve(log_lambda)
        residual = self.values - fitted
        return float(residual @ residual) * len(residual) / freedom**2

    def solve(self, log_lambda: float) -> tuple[np.ndarray, float]:
        """Fitted values and the freedom of the residual, tr(I - A) = d log det(R + lambda Q'Q) / d log lambda: the
        imaginary part of the determinant's logarithm at a lambda with a tiny imaginary part."""
        weight = np.exp(log_lambda)
        lu, pivots, _ = zgbtrf(_banded(self.stiff + weight * (1 + TINY * 1j) * self.rough), 2, 2, overwrite_ab=True)
        freedom = float(np.sum(lu[4].imag / lu[4].real)) / TINY
        bent, _ = zgbtrs(lu, 2, 2, self._transposed(self.values).astype(complex), pivots, overwrite_b=True)
        return self.values - weight * self._applied(bent.real), freedom

    def _transposed(self, of: np.ndarray) -> np.ndarray:
        """Q' of: second divided differences."""
        return np.asarray(self.second[0] * of[:-2] + self.second[1] * of[1:-1] + self.second[2] * of[2:])

    def _applied(self, to: np.ndarray) -> np.ndarray:
        """Q to."""
        sum_ = np.zeros(len(to) + 2)
        for k, diagonal in enumerate(self.second):
            sum_[k : len(to) + k] += diagonal * to
        return sum_


def _banded(of: np.ndarray) -> np.ndarray:
    """A symmetric matrix with two diagonals on each side, for LAPACK's zgbtrf: five bands, and two rows to fill in."""
    ab = np.zeros((7, of.shape[1]), dtype=complex, order="F")
    ab[4], ab[5], ab[6] = of
    ab[3, 1:], ab[2, 2:] = of[1, :-1], of[2, :-2]
    return ab

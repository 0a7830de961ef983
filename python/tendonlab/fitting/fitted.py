"""A model fitted to the training experiments, and what it is worth: evidence and leave-one-experiment-out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tendonlab import _core
from tendonlab._core import Free
from tendonlab.fitting.uncertainty import FEWEST_EXPERIMENTS, Uncertainty, uncertainty
from tendonlab.simulation.system import System


@dataclass(frozen=True)
class Score:
    """`residual`, `jacobian`: whitened rows of one block of training experiment `experiment`, the initial state and
    run-to-run friction marginalised."""

    residual: np.ndarray
    jacobian: np.ndarray
    experiment: int


@dataclass(frozen=True)
class Run:
    """One training experiment at the fit: whitened `residual` (rows,); `jacobian` (rows, free) by the coordinates, the
    experiment's own unknowns marginalised as the random `effect` about their prior means, by which the residual lies
    `shift` higher; the `block` of 2 s of each row."""

    residual: np.ndarray
    jacobian: np.ndarray
    shift: np.ndarray
    effect: _core.RandomEffect
    block: np.ndarray

    def marginal(self, residual: np.ndarray) -> np.ndarray:
        """Whitened residuals of this experiment, its own unknowns marginalised."""
        return self.effect.whiten(residual - self.shift)

    def parts(self) -> list[np.ndarray]:
        """Rows of each block of 2 s, as masks."""
        return [self.block == b for b in range(int(self.block.max()) + 1)]


@dataclass(frozen=True)
class Fitted:
    """A model fitted to the training experiments. `added`: effects beyond the nominal ones. `initial`: own unknowns of
    each training experiment. `informed`: whether any residual depends on a free parameter. `cost`: half the sum of
    squared residuals, priors included; `prior_cost`: the priors' part. `effective`: share of the rows that count as
    independent."""

    added: tuple[str, ...]
    system: System
    free: tuple[Free, ...]
    x: np.ndarray
    initial: tuple[tuple[float, ...], ...]
    runs: tuple[Run, ...]
    at_bound: tuple[bool, ...]
    informed: tuple[bool, ...]
    cost: float
    prior_cost: float
    converged: bool
    message: str
    num_iterations: int
    effective: float = 1.0

    @cached_property
    def blocks(self) -> tuple[Score, ...]:
        """What is left out at a time: an experiment; where there are few, contiguous parts of 2 s."""
        rows = [self.split(t, run.residual) for t, run in enumerate(self.runs)]
        slopes = [_parts(run.jacobian, self._masks(run)) for run in self.runs]
        return tuple(
            Score(residual, jacobian, t)
            for t in range(len(self.runs))
            for residual, jacobian in zip(rows[t], slopes[t], strict=True)
        )

    def split(self, t: int, residual: np.ndarray) -> list[np.ndarray]:
        """Whitened residuals of training experiment t, its own unknowns marginalised as in this fit, in blocks."""
        run = self.runs[t]
        return _parts(run.marginal(residual), self._masks(run))

    def _masks(self, run: Run) -> list[np.ndarray]:
        return run.parts() if len(self.runs) < FEWEST_EXPERIMENTS else [np.ones(len(run.residual), dtype=bool)]

    @cached_property
    def precision(self) -> np.ndarray:
        """Of the coordinates, prior included."""
        return self._information + np.diag(self._prior)

    @cached_property
    def evidence(self) -> float:
        """Laplace log evidence, up to what all models share."""
        away = (self.x - np.array([f.mean for f in self.free])) ** 2 * self._prior
        misfit = self.effective * sum(float(b.residual @ b.residual) for b in self.blocks)
        sd = np.array([f.sd if np.isfinite(f.sd) else 1e3 for f in self.free])
        _, volume = np.linalg.slogdet(np.eye(len(sd)) + sd[:, None] * self._information * sd)
        own = sum(run.effect.volume for run in self.runs)
        return float(-0.5 * (misfit + np.sum(away) + volume + own))

    @cached_property
    def left_out(self) -> np.ndarray:
        """Predictive log score of each block when it is left out: one Newton step without it."""
        scores = []
        for b in self.blocks:
            predicted = b.residual + b.jacobian @ self._step_without([b])
            scores.append(-0.5 * self.effective * float(predicted @ predicted))
        return np.array(scores)

    def leaving_out(self, experiment: int) -> System:
        """The model fitted without one training experiment, by one Newton step; itself where there is no other."""
        blocks = [b for b in self.blocks if b.experiment == experiment]
        if len(blocks) == len(self.blocks):
            return self.system
        x = self.x + self._step_without(blocks)
        return self.system.with_parameters({f.name: f.value(float(v)) for f, v in zip(self.free, x, strict=True)})

    def _step_without(self, blocks: Sequence[Score]) -> np.ndarray:
        """How the coordinates move when some blocks are left out: one Newton step; what is at a bound stays there."""
        moving = ~np.array(self.at_bound, dtype=bool)
        known = self.precision - self.effective * sum(b.jacobian.T @ b.jacobian for b in blocks)
        known += 1e-9 * np.diag(np.diag(self.precision))
        pull = self.effective * sum(b.jacobian.T @ b.residual for b in blocks)
        step = np.zeros(len(self.x))
        step[moving] = np.linalg.solve(known[np.ix_(moving, moving)], np.asarray(pull)[moving])
        return step

    @property
    def not_informed(self) -> tuple[str, ...]:
        """Free parameters that the training experiments say nothing about: they stay where their priors have them."""
        return tuple(f.name for f, known in zip(self.free, self.informed, strict=True) if not known)

    @cached_property
    def mean_square(self) -> float:
        """Of the whitened residuals: 1 where the model explains all but the floor."""
        rows = sum(len(b.residual) for b in self.blocks)
        return sum(float(b.residual @ b.residual) for b in self.blocks) / rows

    @cached_property
    def uncertainty(self) -> Uncertainty:
        """Sd and 95 % interval of each free parameter, and the correlations of the coordinates."""
        marginal = [(run.marginal(run.residual), run.jacobian, run.parts()) for run in self.runs]
        return uncertainty(
            marginal, self.free, self.x, at_bound=self.at_bound, informed=self.informed, effective=self.effective
        )

    def value(self, name: str) -> tuple[float, tuple[float, float]]:
        """Fitted value of a free parameter and its 95 % interval."""
        k = [f.name for f in self.free].index(name)
        of = self.uncertainty
        return self.free[k].value(float(self.x[k])), (float(of.lower[k]), float(of.upper[k]))

    @property
    def _prior(self) -> np.ndarray:
        return np.array([0.0 if not np.isfinite(f.sd) else f.sd**-2.0 for f in self.free])

    @cached_property
    def _information(self) -> np.ndarray:
        width = len(self.free)
        return self.effective * sum((b.jacobian.T @ b.jacobian for b in self.blocks), np.zeros((width, width)))


def _parts(rows: np.ndarray, masks: Sequence[np.ndarray]) -> list[np.ndarray]:
    return [rows[mask] for mask in masks]

"""A model fitted to the training experiments, and what it is worth: evidence and leave-one-experiment-out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from tendonlab import _core
from tendonlab._core import Free
from tendonlab.fitting.noise import RUN_TO_RUN, RUN_TO_RUN_UNKNOWN, integrated_time
from tendonlab.fitting.uncertainty import Uncertainty, uncertainty
from tendonlab.simulation.system import System

UNKNOWN_SCATTER = RUN_TO_RUN_UNKNOWN / RUN_TO_RUN
EXPLODED = 1e30  # precision of a coordinate, in units of its prior or of its size, that no measurement has


def solved(precision: np.ndarray, push: np.ndarray) -> np.ndarray:
    """precision^-1 push, of one matrix or of many. Where derivatives exploded, a precision may be singular in its last
    digits; what nothing determines then stays at 0."""
    try:
        return np.linalg.solve(precision, push)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(precision, hermitian=True) @ push)


@dataclass(frozen=True)
class Score:
    """`residual`, `jacobian`: whitened rows of one block of training experiment `experiment`, the initial state and
    run-to-run friction marginalised."""

    residual: np.ndarray
    jacobian: np.ndarray
    experiment: int


@dataclass(frozen=True)
class Run:
    """One training experiment at the fit: whitened `residual` (rows,); its derivatives `jacobian` (rows, free) by the
    coordinates and `by_own` (rows, unknowns) by the experiment's own unknowns, which ended at `own`; the output and the
    `block` of 2 s of each row."""

    residual: np.ndarray
    jacobian: np.ndarray
    by_own: np.ndarray
    own: np.ndarray
    output: np.ndarray
    block: np.ndarray

    def scaled(self, scale: np.ndarray) -> Run:
        """The same with the rows of each output times its `scale`."""
        rows = scale[self.output]
        return replace(
            self,
            residual=rows * self.residual,
            jacobian=rows[:, None] * self.jacobian,
            by_own=rows[:, None] * self.by_own,
        )

    @property
    def cost(self) -> float:
        """Sum of squares of residuals and own unknowns."""
        return float(self.residual @ self.residual + self.own @ self.own)

    def parts(self) -> list[np.ndarray]:
        """Rows of each block of 2 s, as masks."""
        return [self.block == b for b in range(int(self.block.max()) + 1)]


@dataclass(frozen=True)
class Marginal:
    """A run whose rows count with their `weight`, its own unknowns marginalised as the random `effect` about their
    prior means, by which the residual lies `shift` higher."""

    weight: np.ndarray
    shift: np.ndarray
    effect: _core.RandomEffect
    jacobian: np.ndarray

    @classmethod
    def of(cls, run: Run, shares: np.ndarray) -> Marginal:
        """The rows of each output count as their share in `shares` of as many independent ones."""
        weight = np.sqrt(shares[run.output])
        effect = _core.RandomEffect(weight[:, None] * run.by_own)
        return cls(weight, run.by_own @ run.own, effect, effect.whiten(weight[:, None] * run.jacobian))

    def residual(self, whitened: np.ndarray) -> np.ndarray:
        """Whitened residuals of this run as they count."""
        return self.effect.whiten(self.weight * (whitened - self.shift))


@dataclass(frozen=True)
class Fitted:
    """A model fitted to the training experiments. `added`: effects beyond the nominal ones. `initial`: own unknowns of
    each training experiment. `informed`: whether any residual depends on a free parameter. `cost`: half the sum of
    squared residuals, priors included; `prior_cost`: the priors' part. Of each output: `levels`, sd of the noise under
    which the rows were whitened; `known`, the part of it that does not depend on the model; `shares`, share of the rows
    that count as independent."""

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
    levels: np.ndarray
    known: np.ndarray
    shares: np.ndarray

    def counted(self, shares: np.ndarray | None = None) -> Fitted:
        """The same fit whose rows count as these `shares` of independent ones, without them as all."""
        shares = np.ones_like(self.levels) if shares is None else shares
        return self if np.array_equal(shares, self.shares) else replace(self, shares=shares)

    def under(self, levels: np.ndarray) -> Fitted:
        """The same fit under noise of these levels."""
        scale = self.levels / np.where(levels > 0, levels, 1.0)
        runs = tuple(run.scaled(scale) for run in self.runs)
        cost = self.prior_cost + 0.5 * sum(float(run.residual @ run.residual) for run in runs)
        return replace(self, runs=runs, levels=levels, cost=cost)

    @cached_property
    def marginals(self) -> tuple[Marginal, ...]:
        """The runs as they count."""
        return tuple(Marginal.of(run, self.shares) for run in self.runs)

    @cached_property
    def blocks(self) -> tuple[Score, ...]:
        """What is left out at a time: contiguous parts of 2 s. Whole experiments would be too much: often one alone
        determines a parameter, and without that one a Newton step leads nowhere."""
        rows = [self.split(t, run.residual) for t, run in enumerate(self.runs)]
        slopes = [_parts(of.jacobian, run.parts()) for of, run in zip(self.marginals, self.runs, strict=True)]
        return tuple(
            Score(residual, jacobian, t)
            for t in range(len(self.runs))
            for residual, jacobian in zip(rows[t], slopes[t], strict=True)
        )

    @cached_property
    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Whitened residuals of all training experiments as they count, and their derivatives."""
        residuals = [of.residual(run.residual) for of, run in zip(self.marginals, self.runs, strict=True)]
        return np.concatenate(residuals), np.concatenate([of.jacobian for of in self.marginals])

    def split(self, t: int, residual: np.ndarray) -> list[np.ndarray]:
        """Whitened residuals of training experiment t, its own unknowns marginalised as in this fit, in blocks."""
        return _parts(self.marginals[t].residual(residual), self.runs[t].parts())

    def by_experiment(self, scores: np.ndarray) -> np.ndarray:
        """Scores of blocks summed over each training experiment; one alone keeps them block by block."""
        if len(self.runs) == 1:
            return scores
        return np.bincount([b.experiment for b in self.blocks], scores, minlength=len(self.runs))

    @cached_property
    def precision(self) -> np.ndarray:
        """Of the coordinates, prior included."""
        return self._information + np.diag(self._prior)

    @property
    def exploded(self) -> bool:
        """Whether the derivatives are so large that nothing follows from them."""
        known = self._information
        return not bool(np.isfinite(known).all() and np.all(np.abs(np.diag(known)) < EXPLODED))

    @cached_property
    def evidence(self) -> float:
        """Laplace log evidence, up to what all models share; -inf where derivatives exploded."""
        if self.exploded:
            return float("-inf")
        away = (self.x - np.array([f.mean for f in self.free])) ** 2 * self._prior
        misfit = sum(float(b.residual @ b.residual) for b in self.blocks) + sum(self._spreads)
        sd = np.array([f.sd if np.isfinite(f.sd) else 1e3 for f in self.free])
        _, volume = np.linalg.slogdet(np.eye(len(sd)) + sd[:, None] * self._information * sd)
        own = sum(of.effect.volume for of in self.marginals)
        return float(-0.5 * (misfit + np.sum(away) + volume + own)) + self._overpaid

    @property
    def _overpaid(self) -> float:
        """Nats by which a fit that counts all rows goes too far from what was believed, where the rows count as fewer:
        what a Newton step back wins, by at most 1 in each coordinate."""
        moving, share = self._moving, float(np.mean(self.shares[self.levels > 0]))
        pull = ((1.0 - share) * self._prior * (self.x - np.array([f.mean for f in self.free])))[moving]
        if share == 1.0 or not moving.any():
            return 0.0
        back = solved(self._moving_precision([]), pull)
        part = 1.0 / max(1.0, float(np.max(np.abs(back))))
        return float(part * (1.0 - 0.5 * part) * (pull @ back))

    @cached_property
    def left_out(self) -> np.ndarray:
        """Predictive log score of each block when it is left out: of the values that the other blocks give by one
        Newton step, and of how uncertain these are. A block that alone determines a value is hard to predict."""
        if self.exploded:
            return np.full(len(self.blocks), -np.inf)
        return np.asarray(-0.5 * (self._predicted() + np.array(self._spreads)))

    @property
    def scores(self) -> np.ndarray:
        """Log score of each block as it was fitted."""
        misfit = np.array([float(b.residual @ b.residual) for b in self.blocks])
        return np.asarray(-0.5 * (misfit + np.array(self._spreads)))

    def _predicted(self) -> np.ndarray:
        """Of each block: minus twice the logarithm of the normal density of its rows under the fit to the others, whose
        covariance is 1 + J C J', with C that of the coordinates there. Only J'J and J'r are needed."""
        slopes = [b.jacobian[:, self._moving] for b in self.blocks]
        own = np.array([j.T @ j for j in slopes])
        pull = np.array([j.T @ b.residual for j, b in zip(slopes, self.blocks, strict=True)])
        square = np.array([float(b.residual @ b.residual) for b in self.blocks])
        whole = self._moving_precision([])
        rest = whole - own
        step = solved(rest, pull[..., None])[..., 0]
        along = pull + np.einsum("bij,bj->bi", own, step)
        square += np.einsum("bi,bi->b", pull + along, step)
        (_, volume), (_, before) = np.linalg.slogdet(whole), np.linalg.slogdet(rest)
        settled = solved(whole, along.T).T
        return np.asarray(square - np.einsum("bi,bi->b", along, settled) + volume - before)

    @cached_property
    def _spreads(self) -> list[float]:
        """Of each block: what the logarithms of the noise cost, sum of 2 log sd over the rows as they count."""
        cost = 2.0 * self.shares * np.log(np.where(self.levels > 0, self.levels, 1.0))
        return [float(cost[run.output[mask]].sum()) for run in self.runs for mask in run.parts()]

    def leaving_out(self, experiment: int) -> System:
        """The model fitted without one training experiment, by one Newton step; itself where there is no other."""
        blocks = [b for b in self.blocks if b.experiment == experiment]
        if len(blocks) == len(self.blocks):
            return self.system
        x = self.x + self._step_without(blocks)
        return self.system.with_parameters({f.name: f.value(float(v)) for f, v in zip(self.free, x, strict=True)})

    def _step_without(self, blocks: Sequence[Score]) -> np.ndarray:
        """How the coordinates move when some blocks are left out: one Newton step; what is at a bound stays there."""
        pull = sum(b.jacobian.T @ b.residual for b in blocks)
        step = np.zeros(len(self.x))
        step[self._moving] = solved(self._moving_precision(blocks), np.asarray(pull)[self._moving])
        return step

    @cached_property
    def _moving(self) -> np.ndarray:
        """Coordinates that are not at a bound, as a mask."""
        return ~np.array(self.at_bound, dtype=bool)

    def _moving_precision(self, without: Sequence[Score]) -> np.ndarray:
        """Precision of the coordinates that are not at a bound, without some blocks."""
        known = self.precision - sum(b.jacobian.T @ b.jacobian for b in without)
        known += 1e-9 * np.diag(np.diag(self.precision))
        return np.asarray(known[np.ix_(self._moving, self._moving)])

    @property
    def not_informed(self) -> tuple[str, ...]:
        """Free parameters that the training experiments say nothing about: they stay where their priors have them."""
        return tuple(f.name for f, known in zip(self.free, self.informed, strict=True) if not known)

    @cached_property
    def mean_square(self) -> float:
        """Of the residuals in units of the known noise: 1 where the model explains all but that."""
        if np.array_equal(self.levels, self.known):
            rows = sum(len(b.residual) for b in self.blocks)
            return sum(float(b.residual @ b.residual) for b in self.blocks) / rows
        scale = self.levels / np.where(self.known > 0, self.known, 1.0)
        return float(np.mean(np.square(np.concatenate([run.residual * scale[run.output] for run in self.runs]))))

    def over_scatter(self, groups: int) -> float:
        """`mean_square` over what the known noise and `groups` of friction that differ from run to run leave of a
        perfect model, where nothing says by how much they do."""
        scale = np.square(self.levels / np.where(self.known > 0, self.known, 1.0))
        own = [run.by_own[:, run.by_own.shape[1] - groups :] for run in self.runs]
        scatter = [scale[run.output] * np.sum(np.square(o), axis=1) for run, o in zip(self.runs, own, strict=True)]
        return self.mean_square / (1.0 + UNKNOWN_SCATTER**2 * float(np.mean(np.concatenate(scatter))))

    @cached_property
    def whitened_square(self) -> float:
        """Mean square of the residuals in units of the noise under which they were fitted."""
        return float(np.mean(np.square(np.concatenate([run.residual for run in self.runs]))))

    @cached_property
    def own_levels(self) -> np.ndarray:
        """Of each output: rms residual, at least the known noise; what was not measured stays."""
        rows = [(run.output, run.residual) for run in self.runs]
        outputs, residuals = (np.concatenate(part) for part in zip(*rows, strict=True))
        count = np.bincount(outputs, minlength=len(self.levels))
        square = np.bincount(outputs, np.square(residuals), minlength=len(self.levels)) / np.maximum(count, 1)
        return np.where(count > 0, np.maximum(np.sqrt(square) * self.levels, self.known), self.levels)

    @cached_property
    def own_shares(self) -> np.ndarray:
        """Of each output: share of its rows that count as independent, by the memory of their residuals."""
        memory = [
            np.mean([integrated_time(run.residual[run.output == c]) for run in self.runs if np.any(run.output == c)])
            if any(np.any(run.output == c) for run in self.runs)
            else 1.0
            for c in range(len(self.levels))
        ]
        return 1.0 / np.array(memory)

    @cached_property
    def uncertainty(self) -> Uncertainty:
        """Sd and 95 % interval of each free parameter, and the correlations of the coordinates."""
        rows = [
            (of.residual(run.residual), of.jacobian, run.parts())
            for of, run in zip(self.marginals, self.runs, strict=True)
        ]
        count = sum(float(np.sum(of.weight**2)) for of in self.marginals)
        return uncertainty(rows, self.free, self.x, at_bound=self.at_bound, informed=self.informed, count=count)

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
        with np.errstate(over="ignore", invalid="ignore"):  # derivatives may explode, which `evidence` sees
            return np.asarray(sum((b.jacobian.T @ b.jacobian for b in self.blocks), np.zeros((width, width))))


def _parts(rows: np.ndarray, masks: Sequence[np.ndarray]) -> list[np.ndarray]:
    return [rows[mask] for mask in masks]

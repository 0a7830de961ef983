"""Fits of one model to the training experiments, and what they are worth: evidence and leave-one-experiment-out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tendonlab import _core
from tendonlab.fitting.case import Case
from tendonlab.fitting.informed import informed
from tendonlab.fitting.noise import Floor, integrated_time, kept_samples, whitenings
from tendonlab.fitting.priors import Free, free_parameters
from tendonlab.simulation.system import System

BLOCK = 2.0  # s, shortest contiguous block that stands for an experiment
FEW = 4  # with fewer training experiments, blocks stand for them


@dataclass(frozen=True)
class Score:
    """`residual`, `jacobian`: whitened rows of one block of training experiment `experiment`, the initial state and
    run-to-run friction marginalised."""

    residual: np.ndarray
    jacobian: np.ndarray
    experiment: int


@dataclass(frozen=True)
class Fitted:
    """A model fitted to the training experiments. `added`: effects beyond the nominal ones."""

    added: tuple[str, ...]
    system: System
    free: tuple[Free, ...]
    x: np.ndarray
    initial: tuple[tuple[float, ...], ...]
    blocks: tuple[Score, ...]
    states: tuple[tuple[np.ndarray, np.ndarray], ...]  # directions and coordinates of each initial state
    state_volume: float  # log determinant that marginalising the initial states costs
    at_bound: tuple[bool, ...]
    converged: bool
    message: str
    share: float = 1.0  # of the rows that count as independent

    @cached_property
    def precision(self) -> np.ndarray:
        """Of the coordinates, prior included."""
        return self._information + np.diag(self._prior)

    @cached_property
    def evidence(self) -> float:
        """Laplace log evidence, up to what all models share."""
        away = (self.x - np.array([f.mean for f in self.free])) ** 2 * self._prior
        fit = self.share * sum(float(b.residual @ b.residual) for b in self.blocks)
        sd = np.array([f.sd if np.isfinite(f.sd) else 1e3 for f in self.free])
        _, volume = np.linalg.slogdet(np.eye(len(sd)) + sd[:, None] * self._information * sd)
        return float(-0.5 * (fit + np.sum(away) + volume + self.state_volume))

    @cached_property
    def left_out(self) -> np.ndarray:
        """Predictive log score of each block when it is left out: one Newton step without it."""
        scores = []
        for b in self.blocks:
            predicted = b.residual + b.jacobian @ self._step_without([b])
            scores.append(-0.5 * self.share * float(predicted @ predicted))
        return np.array(scores)

    def without(self, experiment: int) -> System:
        """The model fitted without one training experiment, by one Newton step; itself where there is no other."""
        blocks = [b for b in self.blocks if b.experiment == experiment]
        if len(blocks) == len(self.blocks):
            return self.system
        x = self.x + self._step_without(blocks)
        values = [min(max(f.value(float(v)), f.lower), f.upper) for f, v in zip(self.free, x, strict=True)]
        return self.system.with_parameters({f.name: v for f, v in zip(self.free, values, strict=True)})

    def _step_without(self, blocks: Sequence[Score]) -> np.ndarray:
        """How the coordinates move when some blocks are left out: one Newton step; what is at a bound stays there."""
        moving = ~np.array(self.at_bound, dtype=bool)
        known = self.precision - self.share * sum(b.jacobian.T @ b.jacobian for b in blocks)
        known += 1e-9 * np.diag(np.diag(self.precision))
        pull = self.share * sum(b.jacobian.T @ b.residual for b in blocks)
        step = np.zeros(len(self.x))
        step[moving] = np.linalg.solve(known[np.ix_(moving, moving)], np.asarray(pull)[moving])
        return step

    @cached_property
    def not_informed(self) -> tuple[str, ...]:
        """Free parameters that the training experiments say nothing about: they stay where their priors have them."""
        seen = informed([b.jacobian for b in self.blocks], self.free)
        return tuple(f.name for f, known in zip(self.free, seen, strict=True) if not known)

    @cached_property
    def mean_square(self) -> float:
        """Of the whitened residuals: 1 where the model explains all but the floor."""
        rows = sum(len(b.residual) for b in self.blocks)
        return sum(float(b.residual @ b.residual) for b in self.blocks) / rows

    @cached_property
    def covariance(self) -> np.ndarray:
        """Of the coordinates: a sandwich over blocks, never less than what the prior, the noise and the errors that the
        model leaves give."""
        plain = np.linalg.inv(self.precision)
        memory = float(np.mean([integrated_time(b.residual) for b in self.blocks]))  # what is left is not white
        excess = max(1.0, self.mean_square * memory * self.share)
        meat = excess * self._information + np.diag(self._prior)
        usual = np.asarray(plain @ meat @ plain)
        if len(self.blocks) < 2:
            return usual
        pieces = self.share * np.array([b.jacobian.T @ b.residual for b in self.blocks])
        between = pieces.T @ pieces * len(pieces) / (len(pieces) - 1) + np.diag(self._prior)
        ratio = np.diag(plain @ between @ plain) / np.maximum(np.diag(usual), 1e-300)
        grow = np.sqrt(np.maximum(1.0, ratio))
        return np.asarray(grow[:, None] * usual * grow)

    def value(self, name: str) -> tuple[float, tuple[float, float]]:
        """Fitted value of a free parameter and its 95 % interval."""
        k = [f.name for f in self.free].index(name)
        f, x, sd = self.free[k], float(self.x[k]), float(np.sqrt(max(self.covariance[k, k], 0.0)))
        low, high = sorted((f.value(x - 1.96 * sd), f.value(x + 1.96 * sd)))
        return f.value(x), (max(low, f.lower), min(high, f.upper))

    @property
    def _prior(self) -> np.ndarray:
        return np.array([0.0 if not np.isfinite(f.sd) else f.sd**-2.0 for f in self.free])

    @cached_property
    def _information(self) -> np.ndarray:
        width = len(self.free)
        return self.share * sum((b.jacobian.T @ b.jacobian for b in self.blocks), np.zeros((width, width)))


@dataclass(frozen=True)
class Fitter:
    """Fits models of one case under one whitening."""

    case: Case
    whitening: Sequence[_core.Whitening]
    floor: Floor
    cancel: _core.Cancel

    def fit(
        self,
        system: System,
        *,
        added: Sequence[str] = (),
        initial: Sequence[Sequence[float]] = (),
        max_iterations: int = 25,
        solve: bool = True,
        known: bool = False,
    ) -> Fitted:
        """Fit `system` from its own values, with priors about the nominal ones, and the `initial` unknowns of each
        experiment. `solve` False: only linearise there. `known`: fit those unknowns alone."""
        case = self.case
        rows = [] if known else free_parameters(system, case.dataset.parameters, case.scales, added=added)
        free = [f.started(system.parameters[f.name]) for f in rows]
        tasks = [case.task(i, self.whitening[i]) for i in case.train]
        arguments = (
            system.kind, system.values(), system.active(keep_zero=True), tasks, [f.core() for f in free], case.settings,
        )  # fmt: skip
        start = [list(s) for s in initial]
        if solve:
            found = _core.fit(
                *arguments, initial=start, max_iterations=max_iterations, tolerance=1e-6, cancel=self.cancel
            )
        else:
            found = _core.linearise(*arguments, initial=start)
        fitted = system.with_parameters({f.name: found["values"][f.index] for f in free})
        return self._summarise(fitted, tuple(added), tuple(free), found)

    def under(self, level: float) -> Fitter:
        """The same under noise of `level` times the power, for fits to the training experiments."""
        floor = replace(self.floor, sd=[float(np.sqrt(level)) * sd for sd in self.floor.sd])
        return replace(self, whitening=whitenings(self.case, floor), floor=floor)

    def _summarise(
        self, system: System, added: tuple[str, ...], free: tuple[Free, ...], found: Mapping[str, Any]
    ) -> Fitted:
        blocks: list[Score] = []
        states = []
        volume = 0.0
        for t, i in enumerate(self.case.train):
            k = found["jacobian_initial"][t]
            z = (np.array(found["initial"][t]) - self.case.own_mean(i)) / self.case.own_sd(i)
            states.append((k, z))
            volume += float(np.linalg.slogdet(np.eye(k.shape[1]) + k.T @ k)[1])
            rows = self.rows(states[t], t, found["residuals"][t])
            slopes = self.rows((k, np.zeros(len(z))), t, found["jacobian"][t])
            blocks += [Score(r, j, t) for r, j in zip(rows, slopes, strict=True)]
        return Fitted(
            added=added,
            system=system,
            free=free,
            x=np.array(found["x"]),
            initial=tuple(tuple(s) for s in found["initial"]),
            blocks=tuple(blocks),
            states=tuple(states),
            state_volume=volume,
            at_bound=tuple(found["at_bound"]),
            converged=found["converged"],
            message=found["message"],
            share=self.floor.share,
        )

    def rows(self, state: tuple[np.ndarray, np.ndarray], t: int, of: np.ndarray) -> list[np.ndarray]:
        """Whitened rows (residuals or slopes) of training experiment t with its initial state marginalised, in blocks:
        an experiment is one; where there are few, contiguous parts of it are."""
        k, z = state
        offset = k @ z
        whole = marginalised(k, of - (offset if of.ndim == 1 else offset[:, None]))
        if len(self.case.train) >= FEW:
            return [whole]
        index = block_index(self.case, self.case.train[t], self.floor)
        return [whole[index == b] for b in range(int(index.max()) + 1)]


def block_index(case: Case, i: int, floor: Floor) -> np.ndarray:
    """Which contiguous block of at least 2 s each whitened row of experiment i belongs to."""
    time = np.asarray(case.experiments[i].time)
    num = max(1, int((time[-1] - time[0]) / BLOCK))
    of_sample = np.minimum((num * (time - time[0]) / (time[-1] - time[0])).astype(int), num - 1)
    kept = kept_samples(floor, case.prepared[i].measured)
    return np.concatenate([of_sample[k] for k in kept])


def marginalised(directions: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """(I + K K')^(-1/2) rows: K is a random effect of unit covariance."""
    if directions.shape[1] == 0:
        return rows
    u, s, _ = np.linalg.svd(directions, full_matrices=False)
    gain = 1.0 - 1.0 / np.sqrt(1.0 + s**2)
    inner = u.T @ rows
    return np.asarray(rows - u @ (gain * inner if rows.ndim == 1 else gain[:, None] * inner))

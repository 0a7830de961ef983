"""What the fit's own uncertainty allows on experiments that it did not see."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri  # scipy.stats takes half a second to import

from tendonlab.diagnosis.answer.heldout import Replayed, row_mean_squares
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted, Run, solved
from tendonlab.fitting.noise import Floor
from tendonlab.fitting.problem import Problem, pose
from tendonlab.simulation.system import System

ROUNDS = 5  # of Gauss and Newton
RARE = 0.001  # chance below which what suits an experiment best is nothing that the fit allows
Row = tuple[System, tuple[float, ...], np.ndarray, np.ndarray]  # system, initial state, residuals, outputs
PARTS = (1.0, 0.5, 0.25, 0.1)  # of a step that are tried


def allowed(
    case: Case, models: Mapping[str, Fitted], floor: Floor, stages: Mapping[str, Replayed], experiments: Sequence[int]
) -> dict[str, Replayed]:
    """The replays of these models on held-out experiments, each again with the parameters, the initial state and the
    friction that suit it best within what the fit knows of the parameters and friction differs from run to run.

    A held-out experiment may depend on what no training experiment told, as where it alone reaches a limit."""
    if not case.test:
        return {stage: stages[stage] for stage in models}
    return {stage: _allowed(case, model, floor, stages[stage], experiments) for stage, model in models.items()}


def _allowed(case: Case, fitted: Fitted, floor: Floor, of: Replayed, experiments: Sequence[int]) -> Replayed:
    as_predicted = zip(of.systems, of.initial, of.residuals, of.outputs, strict=True)
    rows = [_nearest(case, fitted, floor, i, row) for i, row in zip(experiments, as_predicted, strict=True)]
    return Replayed(*(tuple(part) for part in zip(*rows, strict=True)))


def _nearest(case: Case, fitted: Fitted, floor: Floor, i: int, row: Row) -> Row:
    """One experiment; as predicted where that is at the floor, or nothing is more probable."""
    _, initial, residual, _ = row
    if not _is_off(residual, floor):
        return row
    nearest = _Search.of(case, fitted, floor, i).best(initial)
    return row if nearest is None or _error(nearest, floor) > _error(row, floor) else nearest


def _error(row: Row, floor: Floor) -> float:
    """Mean square over the floor, which rows that count as independent may raise where they lower their own."""
    return float(np.nanmean(row_mean_squares(row[2]) / np.square(floor.rms)))


def _is_off(residual: np.ndarray, floor: Floor) -> bool:
    """Whether an experiment lies above the floor in any output."""
    return bool(np.any(row_mean_squares(residual) > np.square(floor.rms)))  # NaN is not


@dataclass(frozen=True)
class _Search:
    """The most probable model of one experiment: `prior` is the precision of the parameters that no bound holds,
    `moving`, and of the experiment's own unknowns, the latter in units of their sd."""

    case: Case
    fitted: Fitted
    problem: Problem
    moving: np.ndarray
    prior: np.ndarray
    i: int

    @classmethod
    def of(cls, case: Case, fitted: Fitted, floor: Floor, i: int) -> _Search:
        """Of experiment i, under the noise of the fit."""
        under = replace(floor, sd=fitted.levels.tolist())
        case = replace(case, scatter=tuple((group, max(sd, floor.tau_unseen)) for group, sd in case.scatter))
        problem = pose(case.training_on([i]), under, fitted.system, added=fitted.added)
        moving = ~np.array(fitted.at_bound, dtype=bool)
        num = int(moving.sum())
        prior = np.eye(num + len(case.own_sd(i)))
        prior[:num, :num] = fitted.precision[np.ix_(moving, moving)]
        return cls(case, fitted, problem, moving, prior, i)

    def best(self, initial: tuple[float, ...]) -> Row | None:
        """The most probable model, sought from the fitted one and this initial state; None where nothing is more
        probable than these, or where it is itself improbable. Parameters that bend to a detail may be improbable where
        the unknowns of the experiment alone explain most."""
        num = int(self.moving.sum())
        start = ([*initial, *[0.0] * len(self.case.scatter)] - self.case.own_mean(self.i)) / self.case.own_sd(self.i)
        found = (self._sought(np.concatenate([np.zeros(num), start]), first) for first in (0, num))
        probable = next((f for f in found if f is not None), None)
        if probable is None:
            return None
        at, best = probable
        return self._system(at), tuple(self._own(at)[: len(initial)].tolist()), best - self._measured, best

    def _sought(self, at: np.ndarray, first: int) -> tuple[np.ndarray, np.ndarray] | None:
        """The most probable coordinates, where only those from the `first` on move, and the outputs there; None as
        `best` has it."""
        best = None
        try:
            for _ in range(ROUNDS):
                run = self._run(at)
                cost = self._cost(at, run.residual, run.output)
                step = self._step(at, run, first)
                tries = ((at + part * step, self._seen(at + part * step)) for part in PARTS)
                better = next((t for t in tries if self._cost(t[0], self._white(t[1]), run.output) < cost), None)
                if better is None:
                    break
                at, best = better
        except NumericalError:
            pass
        return None if best is None or at @ self.prior @ at > chdtri(len(at) - first, RARE) else (at, best)

    @property
    def _measured(self) -> np.ndarray:
        return self.case.prepared[self.i].measured

    def _system(self, at: np.ndarray) -> System:
        x = self.fitted.x.copy()
        x[self.moving] += at[: int(self.moving.sum())]
        return self.fitted.system.with_parameters(
            {f.name: f.value(float(v)) for f, v in zip(self.fitted.free, x, strict=True)}
        )

    def _own(self, at: np.ndarray) -> np.ndarray:
        own = at[int(self.moving.sum()) :]
        return np.asarray(self.case.own_mean(self.i) + self.case.own_sd(self.i) * own)

    def _run(self, at: np.ndarray) -> Run:
        (run,) = self.problem.at(self._system(at), [self._own(at).tolist()]).linearise().runs
        return run

    def _seen(self, at: np.ndarray) -> np.ndarray:
        return np.asarray(self.case.run(self.i, self._system(at), self._own(at).tolist())["outputs"])

    def _white(self, outputs: np.ndarray) -> np.ndarray:
        return np.asarray(self.problem.floor.whitening(self._measured).residual(outputs))

    def _cost(self, at: np.ndarray, residual: np.ndarray, output: np.ndarray) -> float:
        return float(self.fitted.shares[output] @ np.square(residual) + at @ self.prior @ at)

    def _step(self, at: np.ndarray, run: Run, first: int) -> np.ndarray:
        weight = np.sqrt(self.fitted.shares[run.output])
        slopes = weight[:, None] * np.concatenate([run.jacobian[:, self.moving], run.by_own], axis=1)
        if not np.isfinite(slopes).all():
            raise NumericalError("derivatives are not finite")
        push = slopes.T @ (weight * run.residual) + self.prior @ at
        step = np.zeros(len(at))
        step[first:] = -solved((slopes.T @ slopes + self.prior)[first:, first:], push[first:])
        return step

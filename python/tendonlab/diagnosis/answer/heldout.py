"""How far: the gap on experiments that nothing was fitted to or chosen by, before and after."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tendonlab import _core
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import BLOCK, Fitted, block_index
from tendonlab.fitting.noise import Floor, started
from tendonlab.simulation.system import System

START = 0.2  # s of a held-out experiment on which its initial state is estimated
NUM_BOOTSTRAP = 1000


@dataclass(frozen=True)
class Replayed:
    """One model on some experiments: residuals (outputs, samples) and outputs of each."""

    systems: tuple[System, ...]
    residuals: tuple[np.ndarray, ...]
    outputs: tuple[np.ndarray, ...]


def models(case: Case, fitted: Fitted, experiments: Sequence[int]) -> list[System]:
    """The model to replay each experiment with: as fitted; where nothing is held out, without it."""
    if case.test:
        return [fitted.system] * len(experiments)
    return [fitted.without(case.train.index(i)) for i in experiments]


def replay(case: Case, systems: Sequence[System], experiments: Sequence[int]) -> Replayed:
    """Replay a model on each of some whole experiments, from an initial state estimated on its first 0.2 s."""
    outputs = []
    for system, i in zip(systems, experiments, strict=True):
        run = _core.simulate(system.kind, *case.at(i, system), initial_state(case, system, i), [], case.settings)
        outputs.append(run["outputs"])
    residuals = tuple(o - case.prepared[i].measured for o, i in zip(outputs, experiments, strict=True))
    return Replayed(tuple(systems), residuals, tuple(outputs))


def initial_state(case: Case, system: System, i: int) -> _core.Experiment:
    """Experiment i started where its first 0.2 s say, by three Gauss–Newton steps with the priors of its state."""
    ready = case.prepared[i]
    if not ready.initial:
        return ready.core
    time = np.asarray(case.experiments[i].time)
    num = max(8, int(np.searchsorted(time - time[0], START)))
    sd = np.asarray(ready.initial_sd)
    weight = case.noise[case.measured]
    mean = ready.initial_mean
    value = mean.copy()
    for _ in range(3):
        core = started(case, i, value.tolist()).until(num)
        run = _core.simulate(system.kind, *case.at(i, system), core, list(ready.initial), case.settings)
        r = ((run["outputs"] - ready.measured[:, :num])[case.measured] / weight[:, None]).ravel()
        j = (run["gradient"][:, case.measured] / weight[:, None]).reshape(len(value), -1).T
        there = np.isfinite(r)
        hessian = j[there].T @ j[there] + np.diag(sd**-2.0)
        value = value - np.linalg.solve(hessian, j[there].T @ r[there] + (value - mean) / sd**2)
    return started(case, i, value.tolist())


def mean_squares(case: Case, of: Replayed, experiments: Sequence[int]) -> list[np.ndarray]:
    """Mean square of each output over blocks of at least 2 s, an array (blocks, outputs) an experiment."""
    rows = []
    for residual, i in zip(of.residuals, experiments, strict=True):
        time = np.asarray(case.experiments[i].time)
        num = max(1, int((time[-1] - time[0]) / BLOCK))
        rows.append(np.array([row_mean_squares(part) for part in np.array_split(residual, num, axis=1)]))
    return rows


def row_mean_squares(residual: np.ndarray) -> np.ndarray:
    """Mean square of each output (row), NaN where it was not measured."""
    return np.array([np.nanmean(np.square(row)) if np.isfinite(row).any() else np.nan for row in residual])


def rms(of: Replayed) -> np.ndarray:
    """Plain rms error of each output over all experiments; NaN where it was not measured."""
    return np.asarray(np.sqrt(row_mean_squares(np.concatenate(of.residuals, axis=1))))


def gap(mean_square: np.ndarray, floor: np.ndarray) -> float:
    """sqrt(max(0, MSE - floor²)), pooled over outputs after dividing each by its floor."""
    measured = np.isfinite(floor)
    return float(np.sqrt(max(0.0, float(np.mean(mean_square[measured] / floor[measured] ** 2)) - 1.0)))


def shrinkage(
    case: Case, before: Replayed, after: Replayed, floor: Floor, experiments: Sequence[int], rng: np.random.Generator
) -> dict[str, object]:
    """1 - gap after / gap before, with a 95 % interval from a bootstrap over blocks; None for a gap of 0."""
    a = np.concatenate(mean_squares(case, before, experiments))
    b = np.concatenate(mean_squares(case, after, experiments))
    value = _shrinkage(a, b, floor.rms)
    if value is None:
        return {"value": None, "ci95": None}
    draws = [_shrinkage(a[k], b[k], floor.rms) for k in rng.integers(0, len(a), (NUM_BOOTSTRAP, len(a)))]
    kept = [d for d in draws if d is not None]
    low, high = np.percentile(kept, [2.5, 97.5]) if kept else (value, value)
    return {"value": value, "ci95": [float(min(low, value)), float(max(high, value))]}


def _shrinkage(before: np.ndarray, after: np.ndarray, floor: np.ndarray) -> float | None:
    first = gap(before.mean(axis=0), floor)
    return None if first == 0.0 else 1.0 - gap(after.mean(axis=0), floor) / first


def predictive_gain(
    case: Case,
    whitening: Sequence[_core.Whitening],
    floor: Floor,
    before: Replayed,
    after: Replayed,
    experiments: Sequence[int],
) -> dict[str, float]:
    """Nats of predictive log score that `after` gains over `before`, and its standard error over blocks of 2 s."""
    gains: list[float] = []
    for k, i in enumerate(experiments):
        a = whitening[i].residual(before.outputs[k])
        b = whitening[i].residual(after.outputs[k])
        gains += list(0.5 * floor.share * np.bincount(block_index(case, i, floor), a**2 - b**2))
    spread = float(np.std(gains, ddof=1) * np.sqrt(len(gains))) if len(gains) > 1 else abs(float(np.sum(gains)))
    return {"mean": float(np.sum(gains)), "se": spread}

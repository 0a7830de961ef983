"""How far: the gap on experiments that no model was fitted to, before and after. They may only refute an effect."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tendonlab import _core
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import Floor, blocks_of
from tendonlab.fitting.problem import initial_state
from tendonlab.simulation.system import System

NUM_BOOTSTRAP = 1000


@dataclass(frozen=True)
class Replayed:
    """One model on some experiments: initial state, residuals (outputs, samples) and outputs of each."""

    systems: tuple[System, ...]
    initial: tuple[tuple[float, ...], ...]
    residuals: tuple[np.ndarray, ...]
    outputs: tuple[np.ndarray, ...]


def models(case: Case, fitted: Fitted, experiments: Sequence[int]) -> list[System]:
    """The model to replay each experiment with: as fitted; where nothing is held out, without it."""
    if case.test:
        return [fitted.system] * len(experiments)
    return [fitted.leaving_out(case.train.index(i)) for i in experiments]


def replay(case: Case, systems: Sequence[System], experiments: Sequence[int]) -> Replayed:
    """Replay a model on each of some whole experiments, from an initial state estimated on its first 0.2 s."""
    initial = tuple(initial_state(case, system, i) for system, i in zip(systems, experiments, strict=True))
    runs = zip(experiments, systems, initial, strict=True)
    outputs = tuple(case.run(i, system, start)["outputs"] for i, system, start in runs)
    residuals = tuple(o - case.prepared[i].measured for o, i in zip(outputs, experiments, strict=True))
    return Replayed(tuple(systems), initial, residuals, outputs)


def replay_all(
    case: Case, models: Sequence[Sequence[System]], experiments: Sequence[int]
) -> tuple[list[Replayed], list[int], dict[str, str]]:
    """Each of `models`, its systems for each of `experiments`, replayed on the experiments that all of them can
    simulate; which these are; and why another one could not be simulated, by its name. Raises NumericalError without
    any left."""
    able, failed = [], {}
    for k, i in enumerate(experiments):
        try:
            able.append((i, [replay(case, [of[k]], [i]) for of in models]))
        except NumericalError as error:
            failed[case.experiments[i].name] = str(error)
    if not able:
        raise NumericalError(f"no experiment to judge by can be simulated: {next(iter(failed.values()), 'none given')}")
    return [_joined([each[m] for _, each in able]) for m in range(len(models))], [i for i, _ in able], failed


def _joined(parts: Sequence[Replayed]) -> Replayed:
    return Replayed(
        tuple(system for of in parts for system in of.systems),
        tuple(start for of in parts for start in of.initial),
        tuple(residual for of in parts for residual in of.residuals),
        tuple(outputs for of in parts for outputs in of.outputs),
    )


def mean_squares(case: Case, of: Replayed, experiments: Sequence[int]) -> list[np.ndarray]:
    """Mean square of each output over blocks of at least 2 s, an array (blocks, outputs) an experiment."""
    rows = []
    for residual, i in zip(of.residuals, experiments, strict=True):
        block = blocks_of(case.experiments[i].time)
        rows.append(np.array([row_mean_squares(residual[:, block == b]) for b in range(int(block.max()) + 1)]))
    return rows


def row_mean_squares(residual: np.ndarray) -> np.ndarray:
    """Mean square of each output (row), NaN where it was not measured."""
    return np.array([np.nanmean(np.square(row)) if np.isfinite(row).any() else np.nan for row in residual])


def rms(of: Replayed) -> np.ndarray:
    """Plain rms error of each output over all experiments; NaN where it was not measured."""
    return np.asarray(np.sqrt(row_mean_squares(np.concatenate(of.residuals, axis=1))))


def level(of: Replayed, floor: Floor) -> float:
    """Mean square error over the plain floor, averaged over the outputs: 1 at the floor."""
    error, there = rms(of), np.isfinite(floor.rms)
    return float(np.mean(np.square(error[there] / floor.rms[there])))


def explained(before: Replayed, after: Replayed, floor: Floor, *, least: float = 1.0) -> float | None:
    """Share of the mean square above the floor that a change of model removes; None where nothing lies above it.
    `least`: that square, over the floor, which no model need remove."""
    first, last = level(before, floor) - least, level(after, floor) - least
    return None if first <= 0 else float(np.clip(1.0 - max(0.0, last) / first, 0.0, 1.0))


def gap(mean_square: np.ndarray, floor: np.ndarray) -> float:
    """sqrt(max(0, MSE - floor²)), pooled over the measured outputs, each over its floor; NaN without any."""
    return float(_gaps(mean_square, floor))


def _gaps(mean_square: np.ndarray, floor: np.ndarray) -> np.ndarray:
    """The gap of each row of mean squares (..., outputs), over the outputs measured there; NaN without any."""
    excess = _mean_of_measured(mean_square / np.square(floor), axis=-1) - 1.0
    return np.asarray(np.sqrt(np.maximum(0.0, excess)))


def _mean_of_measured(values: np.ndarray, axis: int) -> np.ndarray:
    """Mean of what is finite; NaN where nothing is."""
    there = np.isfinite(values)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.sum(values, axis=axis, where=there) / np.sum(there, axis=axis))


def shrinkage(
    case: Case, before: Replayed, after: Replayed, floor: Floor, experiments: Sequence[int], rng: np.random.Generator
) -> dict[str, object]:
    """1 - gap after / gap before, with a 95 % interval from a bootstrap over blocks; None for a gap of 0."""
    a = np.concatenate(mean_squares(case, before, experiments))
    b = np.concatenate(mean_squares(case, after, experiments))
    all_blocks = np.arange(len(a))[None]
    value = _shrinkages(a, b, floor.rms, all_blocks)
    if not len(value):
        return {"value": None, "ci95": None}
    draws = _shrinkages(a, b, floor.rms, rng.integers(0, len(a), (NUM_BOOTSTRAP, len(a))))
    low, high = np.percentile(draws if len(draws) else value, [2.5, 97.5])
    return {"value": float(value[0]), "ci95": [float(min(low, value[0])), float(max(high, value[0]))]}


def _shrinkages(before: np.ndarray, after: np.ndarray, floor: np.ndarray, draws: np.ndarray) -> np.ndarray:
    """Shrinkage over each row of blocks in `draws`, of those with a gap before."""
    first, last = (_gaps(_mean_of_measured(of[draws], axis=1), floor) for of in (before, after))
    there = first > 0.0
    return np.asarray(1.0 - last[there] / first[there])


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
        outputs, samples = whitening[i].cells()
        share = np.array(floor.shares)[outputs] if floor.shares else 1.0
        block = blocks_of(case.experiments[i].time)[samples]
        gains += list(0.5 * np.bincount(block, share * (a**2 - b**2)))
    spread = float(np.std(gains, ddof=1) * np.sqrt(len(gains))) if len(gains) > 1 else abs(float(np.sum(gains)))
    return {"mean": float(np.sum(gains)), "se": spread}

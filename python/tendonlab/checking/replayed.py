"""Late experiments of a rig whose simulation needs no output: one simulation of each experiment is compared with its
outputs as they were logged, and earlier or later. Friction with memory, which looks like a lag, is part of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tendonlab import _core
from tendonlab.checking.aligned import MENDED
from tendonlab.checking.clocks import LONG, one_late
from tendonlab.checking.finding import Finding
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.rough import rough_fit

STEP = 0.0025  # s, between lags that are tried, or a step of the logs
LEAST = 3.0  # of these, by which an experiment must lag the others
SHORTEST = 4 * LONG  # s: of an experiment, of which both ends are left out
FEWEST = 3  # other experiments, which show the common clock
NOBODY = 0.25  # share of what the late one gains by its lag that any other may gain by one


def late_by_replay(case: Case | None) -> list[Finding]:
    """The one experiment of a rig (`free_case`) that the simulator, fitted roughly to all, follows much better with its
    outputs earlier or later, where it does not follow any other so; nothing where that cannot be simulated, or where an
    experiment is too short."""
    if case is None or len(case.experiments) <= FEWEST or min(e.duration for e in case.experiments) < SHORTEST:
        return []
    tried = _tried(case)
    try:
        fit = rough_fit(case, _core.Cancel())
        left = np.array([_errors(case, fit, i, tried) for i in range(len(case.experiments))])
    except (NumericalError, ParameterError):
        return []
    return _standing_out(case, tried, left) if np.isfinite(left).all() else []


def _tried(case: Case) -> np.ndarray:
    """Lags from minus to plus `LONG`, s."""
    step = max(STEP, max(float(np.median(np.diff(e.time))) for e in case.experiments))
    num = int(LONG / step)
    return step * np.arange(-num, num + 1)


def _errors(case: Case, fit: Fitted, i: int, tried: np.ndarray) -> np.ndarray:
    """Mean square error of the model over the sensors' noise in experiment i, by how much its outputs are late."""
    time, measured = np.asarray(case.experiments[i].time), case.prepared[i].measured
    outputs = np.asarray(case.run(i, fit.system, fit.initial[i])["outputs"])
    inside = (time >= time[0] + LONG) & (time <= time[-1] - LONG)

    def error(lag: float) -> float:
        away = [
            (np.interp(time[inside] + lag, time, measured[c]) - outputs[c, inside]) / case.noise[c]
            for c in case.measured
        ]
        return float(np.nanmean(np.square(away)))

    return np.array([error(lag) for lag in tried.tolist()])


def _standing_out(case: Case, tried: np.ndarray, left: np.ndarray) -> list[Finding]:
    """The finding where one experiment alone is far better at a lag of its own. `left` (experiments, lags)."""
    common = int(np.median(np.argmin(left, axis=1)))
    saved = 1.0 - left.min(axis=1) / np.fmax(left[:, common], np.finfo(float).tiny)
    late, best = int(np.argmax(saved)), np.argmin(left, axis=1)
    ends = best[late] in (0, len(tried) - 1)
    if ends or abs(best[late] - common) < LEAST or saved[late] < 1.0 - MENDED:
        return []
    if np.delete(saved, late).max() > NOBODY * saved[late]:
        return []
    seconds = _least(tried, left[late], int(best[late])) - tried[common]
    channels = [case.outputs[c] for c in case.measured]
    inputs: Sequence[str] = case.dataset.inputs
    away, all_late = np.full(len(channels), seconds), np.ones(len(channels), dtype=bool)
    return list(one_late(channels, inputs, away, all_late, case.experiments[late].name))


def _least(tried: np.ndarray, left: np.ndarray, k: int) -> float:
    """Where the parabola through the least of `left`, at k, and its neighbours has its least."""
    before, here, after = left[k - 1 : k + 2]
    bend = before - 2.0 * here + after
    return float(tried[k] + (0.5 * (before - after) / bend if bend > 0.0 else 0.0) * (tried[1] - tried[0]))

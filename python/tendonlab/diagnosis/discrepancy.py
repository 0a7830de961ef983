"""Whether what a model leaves follows the motion, drifts along every run, or rings: noise of a sensor does none of
these, and what the model lacks often does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import RUN_TO_RUN_UNKNOWN

NUM_KNOTS = 9  # of the map over the position, at quantiles
NUM_TIMES = 3  # of the map over the time since a run began: a drift, not how it starts
SLOW = 0.03  # of the velocity's rms: neither forwards nor backwards
RIDGE = 0.02  # prior weight of each cell, of an even share of the samples


FAR_TRAINED = 8.0  # mean square over what the sensors and run-to-run friction may leave, beyond which it is no noise
BEYOND_SENSORS = 12.0  # mean square over what sensors leave, beyond which it is no noise where it is also
BEYOND_SCATTER = 2.0  # over what these and that friction leave; of 209 rigs that lack nothing none passed 9.9 and 0.3
FAR_SCATTERED = 4.0  # mean square of run-to-run factors over what is plausible: beyond twice that they are no noise
FOLLOWED = 0.2  # share of the residual that follows the motion or drifts, beyond which it is no noise
FOLLOWED_REPEATED = 0.06  # the same where repeats tell the noise: 77 rigs that lack nothing left 0.03 at most
FOLLOWED_BESIDE = 0.4  # the same beside effects, whose form may differ: right ones not at the floor left 0.3 at most
RINGS = 0.2  # the same of one narrow band of frequencies: models without a resonance to find left 0.11 at most
ENOUGH = 5  # experiments to learn from where some repeat: a motion's repeats share what happens by chance
BAND, NUM_BANDS = 0.2, 60  # half width of a band of frequencies, of its middle, and how many are looked at
LEAST_PERIODS = 10.0  # of the lowest band in the shortest run: fewer hardly fill a band
DRIVEN = 0.02  # share of the motion, or of its sign, in such a band, beyond which friction alone fills it


def may_be_noise(case: Case, model: Fitted) -> bool:
    """Whether nothing in what a model leaves tells that anything is missing, where nothing repeats."""
    if model.over_scatter(len(case.scatter)) >= FAR_TRAINED or scattered(case, model) >= FAR_SCATTERED:
        return False
    found = patterns(case, model)
    return found.followed < FOLLOWED and found.ringing < RINGS


class Patterns(NamedTuple):
    """Largest shares of the mean square residual of an output: that which a map over the motion or the time since a run
    began predicts (`followed`), and that of one narrow band (`ringing`) about a `frequency`, Hz."""

    followed: float = 0.0
    ringing: float = 0.0
    frequency: float = 0.0


NO_PATTERNS = Patterns()


def patterns(case: Case, model: Fitted) -> Patterns:
    """What patterns there are in what a model leaves."""
    runs = [case.run(i, model.system, own, ports=True) for i, own in zip(case.train, model.initial, strict=True)]
    residuals = [run["outputs"] - case.prepared[i].measured for i, run in zip(case.train, runs, strict=True)]
    return Patterns(_followed(case, runs, residuals), *_ringing(case, runs, residuals))


def scattered(case: Case, model: Fitted) -> float:
    """Mean square of the logarithms of the factors that a model needs on friction from run to run, of the element where
    it is largest, over what is plausible; 0 where there are none."""
    if not case.scatter:
        return 0.0
    factors = np.array([own[len(own) - len(case.scatter) :] for own in model.initial])
    return float(np.max(np.mean(np.square(factors / RUN_TO_RUN_UNKNOWN), axis=0)))


def _followed(case: Case, runs: Sequence[Mapping[str, np.ndarray]], residuals: Sequence[np.ndarray]) -> float:
    """Largest share of the mean square residual of an output that a map over direction and position of a port, or over
    its direction and the time since the run began, predicts in experiments other than those that it was learnt from; 0
    where maps mislead, and of a single experiment."""
    if len(runs) < 2:
        return 0.0
    times = [np.asarray(case.prepared[i].core.time) for i in case.train]
    times = [time - time[0] for time in times]
    shares = [0.0]
    for port in range(len(case.system.info.ports)):
        velocities, positions = ([np.asarray(run["ports"])[port][k] for run in runs] for k in (0, 1))
        if np.ptp(np.concatenate(positions)) == 0.0:
            continue
        over_time = [] if case.system.info.steady else [_cells(velocities, times, NUM_TIMES)]
        for cells in (_cells(velocities, positions, NUM_KNOTS), *over_time):
            shares += [share_predicted(cells, [r[c] for r in residuals]) for c in case.measured]
    return max(shares)


def _ringing(
    case: Case, runs: Sequence[Mapping[str, np.ndarray]], residuals: Sequence[np.ndarray]
) -> tuple[float, float]:
    """Largest share of the mean square residual of an output in one narrow band of frequencies beyond what the bands
    beside it hold, in most experiments, where neither the motion nor its sign has such a band: a resonance that the
    model lacks, whatever excites it. And the middle of that band, Hz. Steady points have no frequencies."""
    if case.system.info.steady:
        return 0.0, 0.0
    times = [np.asarray(case.prepared[i].core.time) for i in case.train]
    lowest = LEAST_PERIODS / min(time[-1] - time[0] for time in times)
    highest = 0.5 / max(np.median(np.diff(time)) for time in times) / (1.0 + 3.0 * BAND)
    if lowest >= highest:
        return 0.0, 0.0
    middle = np.geomspace(lowest, highest, NUM_BANDS)

    def beyond(signals: Sequence[np.ndarray]) -> np.ndarray:
        return _beyond_neighbours(middle, times, signals)

    shares = np.max([beyond([r[c] for r in residuals]) for c in case.measured], axis=0)
    for port in range(len(case.system.info.ports)):
        velocities = [np.asarray(run["ports"])[port][0] for run in runs]
        driven = np.maximum(beyond(velocities), beyond([np.sign(v) for v in velocities]))
        shares = np.where(driven > DRIVEN, 0.0, shares)
    best = int(np.argmax(shares))
    return max(float(shares[best]), 0.0), float(middle[best])


def _beyond_neighbours(middle: np.ndarray, times: Sequence[np.ndarray], signals: Sequence[np.ndarray]) -> np.ndarray:
    """Share of the power of signals, one of each experiment, in the band about each frequency, beyond the fuller one of
    its neighbours: the median over experiments, or their mean if that is less."""
    edges = middle * (1.0 + BAND * np.array([[-3.0], [-1.0], [1.0], [3.0]]))
    power = [_power_below(edges, time, signal) for time, signal in zip(times, signals, strict=True)]
    below, within, above = np.moveaxis(np.diff(power, axis=1), 1, 0)
    more = within - np.maximum(below, above)
    return np.asarray(np.minimum(np.median(more, axis=0), np.mean(more, axis=0)))


def _power_below(frequencies: np.ndarray, time: np.ndarray, signal: np.ndarray) -> np.ndarray:
    """Share of the power of a signal below each of the frequencies, Hz; 0 of one that was not measured."""
    there = np.isfinite(signal)
    if not there.any():
        return np.zeros_like(frequencies)
    even = np.linspace(time[0], time[-1], len(time))
    filled = np.interp(even, time[there], signal[there])
    power = np.square(np.abs(np.fft.rfft((filled - filled.mean()) * np.hanning(len(even)))))
    total = max(float(power.sum()), np.finfo(float).tiny)
    return np.asarray(np.interp(frequencies, np.fft.rfftfreq(len(even), even[1] - even[0]), np.cumsum(power) / total))


@dataclass(frozen=True)
class Cells:
    """Of a map over a direction of motion and over one quantity, which has `knots`. Slower than `slow` is neither
    forwards nor backwards."""

    knots: np.ndarray
    slow: float

    @classmethod
    def spanning(cls, velocities: Sequence[np.ndarray], over: Sequence[np.ndarray], num_knots: int) -> Cells:
        """With knots at quantiles of what the map is `over`."""
        knots = np.unique(np.quantile(np.concatenate(over), np.linspace(0.0, 1.0, num_knots)))
        return cls(knots, SLOW * float(np.sqrt(np.mean(np.square(np.concatenate(velocities))))))

    def at(self, velocity: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Weights of the cells at each sample, (samples, cells)."""
        direction = np.sign(velocity) * (np.abs(velocity) > self.slow)
        near = np.array([np.interp(place, self.knots, row) for row in np.eye(len(self.knots))]).T
        return np.concatenate([near * (direction == d)[:, None] for d in (-1.0, 0.0, 1.0)], axis=1)


def _cells(velocities: list[np.ndarray], over: list[np.ndarray], num_knots: int) -> list[np.ndarray]:
    """Weights of the cells of a map at each sample of each experiment."""
    cells = Cells.spanning(velocities, over, num_knots)
    return [cells.at(velocity, place) for velocity, place in zip(velocities, over, strict=True)]


def ridge(inner: np.ndarray) -> np.ndarray:
    """Precision of the cells of a map beside that of the samples, `inner`: a little of an even share of these."""
    return np.asarray(RIDGE * np.trace(inner) / len(inner) * np.eye(len(inner)))


def share_predicted(cells: Sequence[np.ndarray], residuals: Sequence[np.ndarray]) -> float:
    """Share of the mean square of all residuals that maps learnt from all other experiments predict."""
    there = [np.isfinite(r) for r in residuals]
    pairs = [(a[ok], r[ok]) for a, r, ok in zip(cells, residuals, there, strict=True) if ok.any()]
    if len(pairs) < 2:
        return 0.0
    inner, along = [a.T @ a for a, _ in pairs], [a.T @ r for a, r in pairs]
    total, left = sum(float(r @ r) for _, r in pairs), 0.0
    for k, (a, r) in enumerate(pairs):
        others = sum(inner) - inner[k]
        learnt = np.linalg.solve(others + ridge(others), sum(along) - along[k])
        left += float(np.sum(np.square(r - a @ learnt)))
    return 1.0 - left / total if total > 0 else 0.0

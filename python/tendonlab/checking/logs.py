"""The smoothed logs of all experiments, end to end: what moves, what drives, what else was measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.checking import smoothing
from tendonlab.checking.moving import whole_around
from tendonlab.checking.spikes import Marks, marks
from tendonlab.data import Dataset, Experiment
from tendonlab.simulation.catalog import SystemInfo
from tendonlab.simulation.reading import noise_sd

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

CLEAR = 3.0  # sd of its noise that a velocity must exceed for its direction to be known
SLIDING = 0.3  # of its rms that a velocity must exceed, of systems that are told velocities
OTHER_UNIT = 10.0  # times the noise of the next noisiest experiment, above which an experiment is in another unit
GAP = 3.0  # median steps between two samples that make a gap
ENDS = 4.0  # sd of the Gaussian at each end of a record where it looks beyond the record
TIME = "time"
VELOCITIES = ("flow", "angular_speed")


@dataclass(frozen=True)
class Logs:
    """Arrays (channels, samples) by name of the signal, all experiments end to end.

    `moving`: position, velocity and acceleration of each measured axis; `driving`: each input, its rate and its
    integral; `others`: the other outputs. `run`: which experiment a sample is of; `time`: from the start of its
    experiment, s; `step`: s from one to the next; `clear`: whether the equation can be judged there; `changing`: the
    rate of the last row of each output, once these are thinned."""

    moving: dict[str, np.ndarray]
    driving: dict[str, np.ndarray]
    others: dict[str, np.ndarray]
    run: np.ndarray
    time: np.ndarray
    step: float
    clear: np.ndarray
    changing: dict[str, np.ndarray] = field(default_factory=dict)

    def scaled(self, signals: Sequence[str], factor: float, run: int | None = None) -> Logs:
        """The logs with `signals` divided by a factor, in one experiment or in all; "time" is the clock of all."""
        if TIME in signals:
            rates = float(factor) ** np.array([0.0, 1.0, 2.0, -1.0])[:, None]
            moving = {name: rows * rates[:3] for name, rows in self.moving.items()}
            driving = {name: rows * rates[[0, 1, 3]] for name, rows in self.driving.items()}
            return replace(self, moving=moving, driving=driving, changing={})
        by = factor if run is None else np.where(self.run == run, factor, 1.0)
        return self._each(lambda name, rows: rows / by if name in signals else rows)

    def earlier(self, by: Mapping[str, np.ndarray]) -> Logs:
        """The logs with outputs moved by so much, s, one number per experiment, towards the past."""
        changed = {name: np.array((self.moving | self.others)[name]) for name in by}
        for name, each in by.items():
            for i in np.flatnonzero(each):
                own = self.run == i
                time = self.time[own]
                at = np.clip(time + float(each[i]), time[0], time[-1])
                changed[name][:, own] = self._paths[name, int(i)](at)
        return self._each(lambda name, rows: changed.get(name, rows))

    @cached_property
    def _paths(self) -> dict[tuple[str, int], CubicSpline]:
        """What runs through the samples of each output in each experiment."""
        from scipy.interpolate import CubicSpline

        paths = {}
        for i in np.unique(self.run):
            own = self.run == i
            for name, rows in (self.moving | self.others).items():
                paths[name, int(i)] = CubicSpline(self.time[own], rows[:, own], axis=1)
        return paths

    def rolled(self, signals: Sequence[str], steps: int) -> Logs:
        """The logs with outputs moved by whole steps towards the past; what passes an end comes from next to it."""
        at = np.clip(np.arange(len(self.run)) + steps, 0, len(self.run) - 1)
        return self._each(lambda name, rows: rows[:, at] if name in signals else rows)

    def nudged(self, signal: str, by: float) -> Logs:
        """The logs with an output moved by a small part of a step, s, towards the past."""
        still = (self.moving | self.others)[signal]
        last = self.changing[signal] if self.changing else self._rate(still)
        rates = np.concatenate([still[1:], last])
        return self._each(lambda name, rows: rows + by * rates if name == signal else rows)

    def thinned(self, most: int) -> Logs:
        """The logs at `regular` samples alone."""
        kept = self.regular(most)
        rates = {name: self._rate(rows)[:, kept] for name, rows in (self.moving | self.others).items()}
        return replace(self.at(kept), changing=rates)

    def _rate(self, rows: np.ndarray) -> np.ndarray:
        """How fast the last row changes, per s (1, samples)."""
        return np.asarray(np.gradient(rows[-1:], self.step, axis=1))

    def regular(self, most: int) -> np.ndarray:
        """Every so many samples, at most `most`, of those that are clear. An experiment of which one alone is left has
        no time to go through: that sample is left out."""
        kept = np.flatnonzero(self.clear)
        kept = kept[:: max(1, -(-len(kept) // most))]
        own = self.run[kept]
        return np.asarray(kept[np.bincount(own, minlength=1)[own] > 1])

    def at(self, kept: np.ndarray) -> Logs:
        """These samples alone."""
        chosen = self._each(lambda _, rows: rows[:, kept])
        return replace(chosen, run=self.run[kept], time=self.time[kept], clear=self.clear[kept])

    def _each(self, change: Callable[[str, np.ndarray], np.ndarray]) -> Logs:
        """The logs with every channel changed."""
        moving, driving, others, changing = (
            {name: change(name, rows) for name, rows in channels.items()}
            for channels in (self.moving, self.driving, self.others, self.changing)
        )
        return replace(self, moving=moving, driving=driving, others=others, changing=changing)


def read_logs(dataset: Dataset, info: SystemInfo, marked: Marks | None = None) -> Logs | None:
    """The logs on a common grid; None where no axis of those that the system has was measured, or nothing moves.
    `marked`: their outliers where these are known already."""
    axes = [s.name for s in info.outputs if s.axis is not None and s.name in dataset.signals]
    if (info.dof and not axes) or min(len(e.data) for e in dataset.experiments) < 8 * smoothing.BLOCK:
        return None
    step = float(np.median(np.concatenate([np.diff(e.time) for e in dataset.experiments])))
    marked = marks(dataset) if marked is None else marked
    records = [_Record.of(info, e, step, marked) for e in dataset.experiments]
    positions = [r.values[name] for r in records for name in axes]
    noise = [noise_sd(_despiked(e, name, marked)) for e in dataset.experiments for name in axes]
    if axes and not any(np.ptp(y) > 10 * s for y, s in zip(positions, noise, strict=True)):
        return None
    total = sum(len(r.whole) for r in records)
    sd = smoothing.width(positions, noise, total)
    quiet = {name: _quiet(noise[k :: len(axes)]) for k, name in enumerate(axes)}
    return _joined([r.smoothed(info, axes, quiet, sd, step) for r in records], step * smoothing.stride(sd))


def _quiet(noise: Sequence[float]) -> float:
    """The noise of a channel: that of its noisiest experiment, unless this one must be in another unit."""
    *_, second, most = (0.0, *sorted(noise))
    return second if 0.0 < OTHER_UNIT * second < most else most


@dataclass(frozen=True)
class _Record:
    """An experiment on an even grid; `whole`: whether samples are there."""

    values: dict[str, np.ndarray]
    whole: np.ndarray

    @classmethod
    def of(cls, info: SystemInfo, experiment: Experiment, step: float, marked: Marks) -> _Record:
        held = {s.name: experiment.holds.get(s.name, s.between == "hold") for s in info.inputs}
        known = {s.name for s in info.signals}
        names = [name for name in experiment.data.columns if name in known]
        time = experiment.time
        clean = {name: _despiked(experiment, name, marked) for name in names}
        values = {n: smoothing.even(time, y, step, held=held.get(n, False)) for n, y in clean.items()}
        whole = np.ones(len(next(iter(values.values()))), dtype=bool)
        for k in np.flatnonzero(np.diff(time) > GAP * step):
            first, last = (round((time[j] - time[0]) / step) for j in (k, k + 1))
            whole[first : last + 1] = False
        return cls(values, whole)

    def smoothed(self, info: SystemInfo, axes: Sequence[str], noise: dict[str, float], sd: float, step: float) -> Logs:
        """The logs of this experiment alone. `noise`: of each axis."""
        rate = step ** -np.arange(3.0)[:, None]
        moving = {name: rate * self._derivatives(name, sd, 3) for name in axes}
        inputs = [s.name for s in info.inputs if s.name in self.values]
        driving = {
            name: np.vstack([rate[:2] * self._derivatives(name, sd, 2), self._travel(name, sd, step)])
            for name in inputs
        }
        rest = [s.name for s in info.outputs if s.name in self.values and s.name not in axes]
        others = {name: self._derivatives(name, sd, 1) for name in rest}
        clear = self._clear(sd)
        for name in axes:
            clear &= _slides(moving[name], noise[name], sd, step)
        for signal in info.inputs:
            if not info.dof and signal.name in driving and signal.dimension in VELOCITIES:
                speed = np.abs(driving[signal.name][0])
                clear &= speed >= SLIDING * np.sqrt(np.mean(np.square(speed)))
        time = step * smoothing.stride(sd) * np.arange(len(clear))
        return Logs(moving, driving, others, np.zeros(len(time), dtype=int), time, 0.0, clear)

    def _derivatives(self, name: str, sd: float, num: int) -> np.ndarray:
        return np.array([smoothing.smooth(self.values[name], sd, order=order) for order in range(num)])

    def _travel(self, name: str, sd: float, step: float) -> np.ndarray:
        """The integral of a channel since the record began."""
        values = self.values[name]
        travel = np.concatenate([[0.0], np.cumsum(0.5 * step * (values[1:] + values[:-1]))])
        return smoothing.smooth(travel, sd)

    def _clear(self, sd: float) -> np.ndarray:
        """Away from gaps and ends."""
        inside = whole_around(self.whole, int(2 * ENDS * sd) + 1)
        block = max(1, int(sd / smoothing.BLOCK))
        kept = inside[: len(inside) // block * block : block]
        return np.asarray(kept[:: smoothing.stride(sd) // block], dtype=bool)


def _slides(rows: np.ndarray, noise: float, sd: float, step: float) -> np.ndarray:
    """Where the direction of motion is known, and stays for as long as the Gaussian looks."""
    speed = np.abs(rows[1])
    return np.asarray((speed > CLEAR * noise * smoothing.spread(sd, 1) / step) & (speed > np.abs(rows[2]) * sd * step))


def _despiked(experiment: Experiment, name: str, marked: Marks) -> np.ndarray:
    values = experiment.data[name].to_numpy(dtype=float)
    return np.where(marked.get((experiment.name, name), False), np.nan, values)


def _joined(parts: Sequence[Logs], step: float) -> Logs:
    def join(channels: Sequence[dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
        return {name: np.concatenate([c[name] for c in channels], axis=1) for name in channels[0]}

    run = np.concatenate([np.full(len(p.time), i) for i, p in enumerate(parts)])
    time, clear = np.concatenate([p.time for p in parts]), np.concatenate([p.clear for p in parts])
    moving, driving, others = (join([getattr(p, kind) for p in parts]) for kind in ("moving", "driving", "others"))
    return Logs(moving, driving, others, run, time, step, clear)

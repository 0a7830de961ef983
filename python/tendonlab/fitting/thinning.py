"""Fewer samples that say the same: logs taken far above the bandwidth of the motion, thinned before they are fitted.

Outputs become local parabolas' values: motion stays, white noise falls. Inputs become means over the samples left out,
so that every impulse stays what it was."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from tendonlab import _core
from tendonlab.data import Dataset
from tendonlab.fitting.noise import noise_of, without_rounding
from tendonlab.fitting.replay import is_slower, opened
from tendonlab.simulation.catalog import InputInfo
from tendonlab.simulation.prepare import is_held
from tendonlab.simulation.reading import noise_sd
from tendonlab.simulation.records import Experiment, SignalSpec
from tendonlab.simulation.rests import settled
from tendonlab.simulation.system import System

RATE = 100.0  # Hz: logs are thinned to no less
LOST = 1.15  # residual of the parabolas over the sensors' noise: more, and they would smooth motion away
JUMPS = 5.0  # the same around one sample: more, and an output jumps there, which parabolas tell early and late
MOST_LOST = 0.2  # rms of an input's noise over that of the input: more shakes a rig, which eases its friction
MOST_LOST_OF_A_LOOP = 0.05  # the same where a simulated controller would make that noise again
MOST_SHIFTED, SETTLES = 1.0, 4  # sd of a sensor by which a command that is smoothed may shift it, and within how many
# samples that are kept: a joint that stops then stays off for as long as friction holds it
SMALL = 1e-3  # change of a target that no drive answers with all that it can
THINNED = (
    "The logs were thinned from {:.0f} to {:.0f} samples per second; errors and noise floors are those of the smoothed "
    "signals."
)
GAP = 5.0  # usual steps between two samples: where more is missing, a log is not thinned


@dataclass(frozen=True)
class Thinned:
    """A column after thinning: `values`, by how much its white noise fell (`gain`, rms), what was smoothed away
    (`removed`), and the `largest` rms of that around one sample."""

    values: np.ndarray
    gain: float
    removed: np.ndarray
    largest: float


def thinned(dataset: Dataset, system: System | None = None) -> Dataset:
    """The dataset with as few samples as hold what the logs say, at least `RATE` a second; without its controller where
    that saves steps, and the logs hold the command. As it is where the logs do not hold the command of a known
    controller, whose every tick counts; where nothing moves by an equation, so that there is no step to save; where a
    log has gaps; or where any smoothing would take motion away. `system`: default the dataset's own."""
    system = dataset.system() if system is None else system
    steps = [float(np.median(np.diff(e.time))) for e in dataset if len(e.time) > 1]
    closed, dataset = dataset, opened(dataset, system)
    if dataset.controller is not None or system.info.sampled or not steps or any(_has_gaps(e.time) for e in dataset):
        return closed
    outputs = [s.name for s in system.info.outputs if s.name in dataset.signals]
    records = {name: [(e.time, _column(e, name)) for e in dataset if name in e.data.columns] for name in outputs}
    noise = {name: noise_of(dataset.signals[name], [row for _, row in of]) for name, of in records.items() if of}
    factor = int(1.0 / (RATE * max(steps)) + 1e-6)
    most = MOST_LOST if closed.controller is None else MOST_LOST_OF_A_LOOP
    while factor > 1:
        smooth = {name: [local_parabolas(*of, factor) for of in records[name]] for name in noise}
        lost = max((_lost_of(e, given, factor) for e in dataset for given in _inputs_of(e, system)), default=0.0)
        kept = all(_keeps_samples(records[name], smooth[name]) for name in noise)
        kept = kept and all(_keeps_switches(e, given, factor) for e in dataset for given in _inputs_of(e, system))
        kept = kept and lost <= most and _shifted(dataset, system, noise, factor) <= MOST_SHIFTED
        if kept and all(_keeps_motion(smooth[name], noise[name]) for name in noise):
            signals = {name: _smoothed(dataset.signals[name], noise[name], _gain(smooth[name])) for name in noise}
            few = tuple(_thin(e, system, list(noise), factor) for e in dataset)
            said = (*dataset.warnings, THINNED.format(1.0 / max(steps), 1.0 / (max(steps) * factor)))
            return replace(dataset, signals={**dataset.signals, **signals}, experiments=few, warnings=said)
        factor //= 2
    ticks = closed.controller is not None and all(is_slower(e, closed.controller) for e in dataset)
    return dataset if ticks else closed


def local_parabolas(time: np.ndarray, values: np.ndarray, factor: int) -> Thinned:
    """Every `factor`-th value, from a parabola fitted to the samples up to the next ones on both sides. NaN where fewer
    than two in five of those were measured, or fewer than three."""
    rows, times = _windows(values, factor), _windows(time, factor)
    enough = np.isfinite(rows).sum(axis=1) >= max(3.0, 0.8 * factor)
    rows, times = rows[enough], times[enough]
    there = np.isfinite(rows)
    place = np.where(there, times - time[::factor][enough, None], 0.0) / (time[-1] - time[0])
    place *= (len(time) - 1) / factor
    powers = there[:, :, None] * place[:, :, None] ** np.arange(3)
    inverse = np.linalg.inv(np.einsum("nwi,nwj->nij", powers, powers))
    fitted = np.einsum("nij,nwj,nw->ni", inverse, powers, np.where(there, rows, 0.0), optimize=True)
    out = np.full(len(enough), np.nan)
    out[enough] = fitted[:, 0]
    near = np.abs(np.arange(-factor, factor + 1)) <= factor // 2
    rest = (rows - np.einsum("nwi,ni->nw", powers, fitted))[:, near]
    gain = float(np.sqrt(np.mean(inverse[:, 0, 0]))) if enough.any() else 1.0
    known = np.isfinite(rest)
    around = np.sum(np.square(rest), axis=1, where=known) / np.maximum(known.sum(axis=1), 1)
    return Thinned(out, gain, rest[known], float(np.sqrt(np.max(around, initial=0.0))))


def _smoothed(signal: SignalSpec, noise: float, gain: float) -> SignalSpec:
    """The signal whose `noise`, rounding included, fell by `gain`."""
    resolution = signal.resolution and gain * signal.resolution
    return replace(signal, noise_sd=gain * without_rounding(noise, signal), resolution=resolution)


def _windows(row: np.ndarray, factor: int) -> np.ndarray:
    padded = np.pad(np.asarray(row, dtype=float), factor, constant_values=np.nan)
    return np.lib.stride_tricks.sliding_window_view(padded, 2 * factor + 1)[::factor]


def _keeps_samples(records: Sequence[tuple[np.ndarray, np.ndarray]], smooth: Sequence[Thinned]) -> bool:
    """Whether no record that was measured is lost, as of a sensor that is read at few of the stamps."""
    return all(
        np.isfinite(of.values).sum() > 1 or np.isfinite(values).sum() < 2
        for (_, values), of in zip(records, smooth, strict=True)
    )


def _keeps_switches(experiment: Experiment, given: InputInfo, factor: int) -> bool:
    """Whether what a switch turns on or off begins at a sample that is kept: half a sample moves a release by more than
    its sensor errs."""
    if given.dimension != "ratio":
        return True
    turns = np.flatnonzero(np.diff(_column(experiment, given.name))) + 1
    return not np.any(turns % factor)


def _keeps_motion(smooth: Sequence[Thinned], noise: float) -> bool:
    removed = np.concatenate([of.removed for of in smooth])
    if not len(removed) or max(of.largest for of in smooth) > JUMPS * noise:
        return False
    return float(np.sqrt(np.mean(np.square(removed)))) < LOST * noise


def _lost_of(experiment: Experiment, given: InputInfo, factor: int) -> float:
    """Rms of what is lost of an input between its means, over that of the input."""
    values = _column(experiment, given.name)
    means = np.interp(experiment.time, *_middles(experiment.time[::factor], _means(experiment, given, factor)))
    return float(np.sqrt(np.mean(np.square(values - means)) / max(np.mean(np.square(values)), 1e-300)))


def _shifted(dataset: Dataset, system: System, noise: Mapping[str, float], factor: int) -> float:
    """How far a command between its means, instead of the logged one, moves the motor at most, in sd of its sensor. A
    step of the command keeps its impulse, and comes up to half a sample early or late."""
    motor = next((s.name for s in system.info.outputs if s.axis == 0 and s.name in noise), None)
    command = system.info.inputs[0]
    if motor is None or not (system.info.commanded or command.between == "hold"):
        return 0.0
    _, inertia, _ = _core.rigid_motion(system.kind, system.values(), system.active())
    effort = 1.0 if system.info.commanded else _effort_per_target(system)
    shifts = (_shift(e, command, factor) for e in dataset if command.name in e.data.columns)
    return effort * max(shifts, default=0.0) / (inertia * noise[motor])


def _effort_per_target(system: System) -> float:
    """Effort on the motor at rest per unit of its first input: of a servo, how hard its drive pulls."""
    kind, dof, time = system.kind, system.info.dof, np.array([0.0, 1.0])
    others = [_core.Signal()] * (len(system.info.inputs) - 1)
    still = [0.0] * dof
    effort = []
    for target in (0.0, SMALL):
        held = _core.Signal(time, np.array([[target, 0.0, 0.0, 0.0]] * 2), False)
        given = _core.Experiment(
            kind=kind, time=time.tolist(), inputs=(held, *others), loop=_core.Loop(), position=still, velocity=still
        )
        balance = _core.balance(kind, np.array([system.values()]), system.active(), given, *np.zeros((2, dof, 2)))
        effort.append(float(balance["effort"][0, 0, 0]))
    return abs(effort[1] - effort[0]) / SMALL


def _shift(experiment: Experiment, given: InputInfo, factor: int) -> float:
    """The same of an experiment, for a unit inertia: what the impulses differ by between two samples, gathered."""
    from scipy.interpolate import CubicSpline

    time, impulse = experiment.time, _impulse(experiment, given)
    kept = np.arange(0, len(time), factor)
    if len(kept) <= SETTLES:
        return 0.0
    missed = impulse - CubicSpline(time[kept], impulse[kept], bc_type="natural")(time)  # what `averaged` makes
    moved = np.concatenate([[0.0], np.cumsum(0.5 * (missed[1:] + missed[:-1]) * np.diff(time))])[kept]
    return float(np.max(np.abs(moved[SETTLES:] - moved[:-SETTLES])))


def _middles(time: np.ndarray, means: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Instants at which an input has its means, and these."""
    return 0.5 * (time[1:] + time[:-1]), means[:-1]


def _gain(smooth: Sequence[Thinned]) -> float:
    return float(np.sqrt(np.mean([of.gain**2 for of in smooth])))


def _thin(experiment: Experiment, system: System, outputs: Sequence[str], factor: int) -> Experiment:
    """The experiment at every `factor`-th sample."""
    time = experiment.time[::factor]
    inputs = {given.name: given for given in _inputs_of(experiment, system)}
    columns = {}
    for name in experiment.data.columns:
        if name in outputs:
            columns[name] = local_parabolas(experiment.time, _column(experiment, name), factor).values
        elif name in inputs:
            columns[name] = _means(experiment, inputs[name], factor)
        else:
            columns[name] = _column(experiment, name)[::factor]
    data = pd.DataFrame(columns, index=pd.Index(time, name=experiment.data.index.name))
    return replace(experiment, data=data, holds={**experiment.holds, **dict.fromkeys(inputs, True)}, averaged=True)


def _inputs_of(experiment: Experiment, system: System) -> list[InputInfo]:
    return [given for given in system.info.inputs if given.name in experiment.data.columns]


def _means(experiment: Experiment, given: InputInfo, factor: int) -> np.ndarray:
    """Mean of an input from each sample that is kept to the next."""
    time, values, gathered = experiment.time, _column(experiment, given.name), _impulse(experiment, given)
    kept = np.append(np.arange(0, len(time), factor), len(time) - 1)
    length = np.diff(time[kept])
    rise = np.diff(gathered[kept])
    return np.asarray(np.where(length > 0, rise / np.where(length > 0, length, 1.0), values[kept[:-1]]))


def _impulse(experiment: Experiment, given: InputInfo) -> np.ndarray:
    """Integral of an input up to each sample; it goes straight between samples unless held. A motion that rests is
    constant, though its reading flickers."""
    values = _column(experiment, given.name)
    if given.between == "smooth":
        values = settled(experiment.time, values, noise_sd(values))
    over = values[:-1] if is_held(experiment, given) else 0.5 * (values[1:] + values[:-1])
    return np.concatenate([[0.0], np.cumsum(over * np.diff(experiment.time))])


def _has_gaps(time: np.ndarray) -> bool:
    steps = np.diff(time)
    return bool(np.any(steps > GAP * np.median(steps)))


def _column(experiment: Experiment, name: str) -> np.ndarray:
    return experiment.data[name].to_numpy(dtype=float)

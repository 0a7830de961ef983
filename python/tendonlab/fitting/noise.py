"""Noise of the outputs: what sensors add to them, and the filter that makes independent rows of residuals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tendonlab import _core
from tendonlab.data import Dataset
from tendonlab.errors import DatasetError
from tendonlab.fitting.set_points import Points, noise_of_points, points_of
from tendonlab.simulation.prepare import Prepared
from tendonlab.simulation.reading import common_step, noise_sd
from tendonlab.simulation.records import Experiment, SignalSpec
from tendonlab.simulation.system import System

NEAR_FLOOR = 1.3  # whitened mean square below which a model is nearly at the floor
RUN_TO_RUN = 0.008  # default sd of friction from run to run
RUN_TO_RUN_UNKNOWN = 0.02  # the largest one that is plausible where nothing repeats
SMALLEST = 1e-7  # of a record's spread: what single precision resolves
FOLLOWING = 0.5  # share of the measured samples that must follow on others without a gap, to tell coloured noise
BLOCK = 2.0  # s: residuals of a mechanism stay correlated for less
BURN_IN = 2000  # samples after which noise with memory has forgotten its start


@dataclass(frozen=True)
class Floor:
    """The noise that a model's residuals are judged against.

    `rms`: plain noise floor of each output, in its unit (NaN: not measured). `ar`, `sd`: autoregression and innovation
    sd of each output (sd 0: not measured). `tau`: relative sd of friction from run to run, which repeats told by so
    many independent `differences`. `repeated`: whether there are repeats; without them `sd` is what a model leaves, of
    which `known` is due to the sensors. `shares`: share of the whitened samples of each output that count as
    independent; decisions weigh them by it. Fits count all samples, and believe in the own unknowns of each experiment
    as much more firmly."""

    rms: np.ndarray
    ar: list[list[float]]
    sd: list[float]
    tau: float
    repeated: bool
    known: tuple[float, ...] | None = None
    shares: tuple[float, ...] | None = None
    differences: int = 0

    @property
    def tau_unseen(self) -> float:
        """The same of a run that no fit saw: one pair of repeats that differ little may be chance."""
        if not self.differences:
            return self.tau
        told = self.differences * self.tau**2
        return float(np.sqrt((told + RUN_TO_RUN_UNKNOWN**2) / (self.differences + 1)))

    @property
    def levels(self) -> np.ndarray:
        """Sd of each output, 0 where it was not measured."""
        return np.array(self.sd, dtype=float)

    @property
    def share(self) -> float:
        """Share of all whitened samples that count as independent."""
        if self.shares is None:
            return 1.0
        return float(np.mean([share for share, sd in zip(self.shares, self.sd, strict=True) if sd > 0]))

    def under(self, level: float) -> Floor:
        """The same with `level` times the power of the noise."""
        return replace(self, sd=[float(np.sqrt(level)) * sd for sd in self.sd])

    def left_by(self, levels: np.ndarray, shares: np.ndarray) -> Floor:
        """The floor where a model leaves residuals of these levels."""
        return replace(self, sd=levels.tolist(), shares=tuple(shares.tolist()))

    def reached_by(self, rms: np.ndarray) -> Floor:
        """Without repeats the plain floor is assumed: an error `rms` of each output that a model reached on held-out
        experiments lowers it, to the sensors' noise at the least."""
        if self.known is None:
            return self
        return replace(self, rms=np.maximum(np.minimum(self.rms, rms), np.where(np.isfinite(self.rms), self.known, 0)))

    def whitening(
        self, measured: np.ndarray, directions: np.ndarray | None = None, spread: Sequence[float] = ()
    ) -> _core.Whitening:
        """For one experiment, `measured` (outputs, samples); see `_core.Whitening`."""
        sd = [s if s > 0 and np.isfinite(row).any() else np.inf for s, row in zip(self.sd, measured, strict=True)]
        ar = list(self.ar)
        for c, row in enumerate(measured):
            if ar[c] and sd[c] < np.inf and np.isnan(row).any() and is_sparse(np.isfinite(row), len(ar[c])):
                ar[c], sd[c] = [], float(self.rms[c])
        return _core.Whitening(ar, sd, measured, directions, list(spread))


def num_following(measured: np.ndarray, order: int) -> int:
    """How many of the samples that were `measured` (samples,) follow on `order` others without a gap."""
    return int(np.sum(np.convolve(measured, np.ones(order + 1), mode="valid") > order + 0.5))


def is_sparse(measured: np.ndarray, order: int) -> bool:
    """Whether so few of the samples that were `measured` follow on `order` others that noise is better taken as white,
    as where a sensor is read at every second stamp."""
    return num_following(measured, order) < FOLLOWING * int(np.count_nonzero(measured))


def sensor_noise(
    dataset: Dataset, system: System, prepared: Sequence[Prepared], experiments: Sequence[Experiment] | None = None
) -> np.ndarray:
    """Sd of the white noise of each output, in its unit: as stated, else from fourth differences, or of steady points
    as `noise_of_points` has it; NaN where no record measured it. `prepared` are `experiments`, by default all.

    Rounding to the resolution, stated or found, adds resolution/√12. To a stated noise it comes in squares. The fourth
    differences of a record that moves on at every sample hold its rounding already, those of one that repeats its
    readings hold none of it: there the larger of the two counts. At least 1e-7 of the record's spread, whatever its
    offset; 1 for a record that never changes. Raises DatasetError where no output was measured."""
    outputs = system.info.outputs
    noise = np.full(len(outputs), np.nan)
    runs, inputs = dataset.experiments if experiments is None else experiments, [s.name for s in system.info.inputs]
    for c, output in enumerate(outputs):
        signal = dataset.signals.get(output.name)
        measured = [
            (run, e.measured[c]) for run, e in zip(runs, prepared, strict=True) if np.isfinite(e.measured[c]).any()
        ]
        if signal is not None and measured:
            records = [record for _, record in measured]
            points = points_of([run for run, _ in measured], inputs, records) if system.info.steady else None
            noise[c] = noise_of(signal, records, points)
    if np.isnan(noise).all():
        names = ", ".join(output.name for output in outputs)
        raise DatasetError(f"{dataset.name}: no output of {system.kind} was measured; expected one of {names}")
    return noise


def noise_of(signal: SignalSpec, records: Sequence[np.ndarray], points: Sequence[Points] | None = None) -> float:
    """Sd of the white noise of one output, from its records, or from steady `points`; see `sensor_noise`."""
    rounding = rounding_of(signal)
    smallest = SMALLEST * float(np.nanstd(np.concatenate(records)))
    stated = 0.0 if signal.noise_sd is None else float(np.hypot(signal.noise_sd, rounding))
    if stated > 0.0:
        return max(stated, smallest)
    shown = float(np.median([noise_sd(r) for r in records])) if points is None else noise_of_points(points)
    return max(shown, rounding, smallest) or 1.0


def rounding_of(signal: SignalSpec) -> float:
    """Sd of rounding to the resolution of a signal, in its unit."""
    return float((signal.resolution or 0.0) / np.sqrt(12.0))


def with_found_resolutions(dataset: Dataset) -> Dataset:
    """The dataset with the steps that its readings show, where neither resolution nor noise of a sensor is stated:
    repeats are rounded alike, and do not show them."""
    found: dict[str, SignalSpec] = {}
    for name in dataset.outputs:
        spec = dataset.signals[name]
        if spec.resolution is None and spec.noise_sd is None:
            step = common_step([e.data[name].dropna().to_numpy(dtype=float) for e in dataset if name in e.data])
            if step:
                found[name] = replace(spec, resolution=step)
    return replace(dataset, signals=dataset.signals | found) if found else dataset


def without_rounding(noise: float, signal: SignalSpec) -> float:
    """The part of a signal's noise that is there before its readings are rounded."""
    return float(np.sqrt(max(0.0, noise**2 - rounding_of(signal) ** 2)))


def drawn(sd: float, memory: Sequence[float], num: int, random: np.random.Generator) -> np.ndarray:
    """Noise of `num` samples that `sd` drives through an autoregression, which has forgotten its start."""
    before = BURN_IN if len(memory) else 0
    return remembered(sd * random.normal(size=before + num), memory)[before:]


def remembered(driving: np.ndarray, memory: Sequence[float]) -> np.ndarray:
    """The autoregression x[i] = driving[i] + sum of memory[k] x[i - 1 - k], as a triangular system of equations with
    few diagonals. (scipy.signal takes a quarter of a second to import.)"""
    from scipy.linalg.lapack import dtbtrs

    if not len(memory):
        return driving
    diagonals = np.repeat(np.array([[1.0], *([-a] for a in memory)]), len(driving), axis=1)
    solved, _ = dtbtrs(diagonals, driving, uplo="L", diag="U")
    return np.asarray(solved).reshape(driving.shape)


def white(noise: np.ndarray) -> Floor:
    """The sensors' white noise alone."""
    sd = [float(s) if np.isfinite(s) else 0.0 for s in noise]
    return Floor(noise, [[] for _ in sd], sd, 0.0, repeated=False)


def integrated_time(record: np.ndarray) -> float:
    """Samples that count as one independent one: 1 + 2 sum of the autocorrelation up to its first zero."""
    if not np.any(record):
        return 1.0
    size = 1 << (2 * len(record) - 1).bit_length()  # of two: quick; twice as long: no lag wraps around
    lagged = np.fft.irfft(np.abs(np.fft.rfft(record, size)) ** 2, size)[: len(record)]
    ended = np.flatnonzero(lagged <= 0)
    return float(1.0 + 2.0 * np.sum(lagged[1 : ended[0] if len(ended) else None]) / lagged[0])


def blocks_of(time: np.ndarray) -> np.ndarray:
    """Which contiguous block of at least 2 s each sample belongs to; blocks are as long as each other."""
    passed = time - time[0]
    num = max(1, int(passed[-1] / BLOCK))
    return np.asarray(np.minimum((num * passed / max(passed[-1], 1e-300)).astype(int), num - 1))

"""A case: everything that every model of a diagnosis shares, so that only the effect differs between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tendonlab import _core
from tendonlab.data import Dataset, Experiment
from tendonlab.errors import NumericalError
from tendonlab.fitting.priors import Scale, scales
from tendonlab.fitting.replay import choose_replay
from tendonlab.simulation.prepare import Prepared, Replay, prepare
from tendonlab.simulation.signals import white_noise_sd
from tendonlab.simulation.system import System

TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
ATTEMPTS = 30  # of the stepper a sample: a candidate that needs more is stiffer than anything these data could show
NUMERICS_SHARE = 0.1  # of the sensors' noise that the simulator's own error may reach


@dataclass(frozen=True)
class Case:
    """A dataset made ready. `noise` is the sd of each output's white noise, NaN where it was not measured. `scatter`:
    groups of parameters that differ by a common factor from run to run, and the sd of its logarithm.

    Each experiment has unknowns of its own: the free parts of its initial state, then the logarithms of the factors."""

    dataset: Dataset
    system: System
    replay: Replay
    experiments: tuple[Experiment, ...]
    prepared: tuple[Prepared, ...]
    noise: np.ndarray
    scales: Mapping[str, Scale]
    settings: _core.Settings
    scatter: tuple[tuple[tuple[int, ...], float], ...] = ()

    @property
    def train(self) -> tuple[int, ...]:
        """Indices of the experiments to fit."""
        return tuple(i for i, e in enumerate(self.experiments) if e.split == "train")

    @property
    def test(self) -> tuple[int, ...]:
        """Indices of the experiments held out."""
        return tuple(i for i, e in enumerate(self.experiments) if e.split == "test")

    def training_on(self, experiments: Sequence[int]) -> Case:
        """The same case with these experiments to fit and none held out."""
        splits = ["train" if i in experiments else "unused" for i in range(len(self.experiments))]
        chosen = (replace(e, split=s) for e, s in zip(self.experiments, splits, strict=True))
        return replace(self, experiments=tuple(chosen))

    @property
    def outputs(self) -> list[str]:
        """Names of the system's outputs, measured or not."""
        return [s.name for s in self.system.info.outputs]

    @property
    def measured(self) -> list[int]:
        """Indices of the outputs that were measured."""
        return [c for c in range(len(self.noise)) if np.isfinite(self.noise[c])]

    def own_mean(self, i: int) -> np.ndarray:
        """Prior means of the unknowns of experiment i."""
        return np.concatenate([self.prepared[i].initial_mean, np.zeros(len(self.scatter))])

    def own_sd(self, i: int) -> np.ndarray:
        """Prior sd of the unknowns of experiment i."""
        return np.array([*self.prepared[i].initial_sd, *(sd for _, sd in self.scatter)])

    def at(self, i: int, system: System, own: Sequence[float] = ()) -> tuple[list[float], list[bool]]:
        """Values and flags for the core in experiment i, with its `own` unknowns (default: their means): its conditions
        hold there, its payload is added."""
        values = system.values()
        names = [p.name for p in system.info.parameters]
        for name, added in self.experiments[i].add.items():
            values[names.index(name)] += added
        for name, known in self.experiments[i].conditions.items():
            if name in system.parameters:
                values[names.index(name)] = known
        for (group, _), logarithm in zip(self.scatter, own[len(self.prepared[i].initial) :], strict=False):
            for k in group:
                values[k] *= float(np.exp(logarithm))
        return values, system.active(keep_zero=False)

    def task(self, i: int, whitening: _core.Whitening) -> _core.Task:
        """Experiment i for the compiled fit."""
        names = [p.name for p in self.system.info.parameters]
        experiment, ready = self.experiments[i], self.prepared[i]
        return _core.Task(
            ready.core, whitening,
            fixed={names.index(n): v for n, v in experiment.conditions.items() if n in self.system.parameters},
            added={names.index(n): v for n, v in experiment.add.items()},
            initial=list(ready.initial), initial_sd=list(ready.initial_sd),
            scatter=[(list(group), sd) for group, sd in self.scatter],
        )  # fmt: skip


def make_case(dataset: Dataset, system: System | None = None) -> Case:
    """Prepare every experiment of `dataset` for the simulator (the dataset's own unless given)."""
    system = dataset.system() if system is None else system
    replay = choose_replay(dataset, system)
    prepared = tuple(prepare(e, system, replay) for e in dataset.experiments)
    noise = np.array([_noise(dataset, prepared, c) for c in range(len(system.info.outputs))])
    found = scales(system, prepared)
    settings = _settings(system, prepared, 1e-4)
    case = Case(dataset, system, replay, tuple(dataset.experiments), prepared, noise, found, settings)
    return replace(case, settings=fine_enough(case, case.noise))


def _noise(dataset: Dataset, prepared: Sequence[Prepared], c: int) -> float:
    """Sd of the white noise of output c: as stated, else from fourth differences; at least its quantisation's."""
    records = [e.measured[c] for e in prepared if np.isfinite(e.measured[c]).any()]
    if not records:
        return np.nan
    spec = dataset.signals[dataset.system().info.outputs[c].name]
    found = spec.noise_sd or float(np.median([white_noise_sd(r) for r in records]))
    coarse = (spec.resolution or 0.0) / np.sqrt(12)
    smallest = 1e-9 * max(float(np.nanmax(np.abs(r))) for r in records)
    total = found if spec.noise_sd is not None else float(np.hypot(found, coarse))
    return float(max(total, coarse, smallest, 1e-300))


def _settings(system: System, prepared: Sequence[Prepared], tolerance: float) -> _core.Settings:
    longest = max(e.measured.shape[1] for e in prepared)
    return _core.Settings(
        max_attempts=ATTEMPTS * longest + 10_000,
        tolerance=tolerance,
        position_scale=min(e.position_scale for e in prepared),
        velocity_scale=min(e.velocity_scale for e in prepared),
    )


def fine_enough(case: Case, noise: np.ndarray) -> _core.Settings:
    """The loosest tolerance at which the simulator's own error stays below a tenth of `noise`, of each output."""
    sample = case.train[:3]
    kept = case.measured

    def run(tolerance: float) -> list[np.ndarray]:
        settings = _settings(case.system, case.prepared, tolerance)
        ready = [(case.at(i, case.system), case.prepared[i].core) for i in sample]
        return [_core.simulate(case.system.kind, *at, core, [], settings)["outputs"][kept] for at, core in ready]

    def error(outputs: list[np.ndarray]) -> float:
        rms = [np.sqrt(np.mean(np.square(a - b), axis=1)) for a, b in zip(outputs, best, strict=True)]
        return float(np.max(np.array(rms) / noise[kept]))

    best = _finest(run)
    enough = (t for t in TOLERANCES if error(run(t)) < NUMERICS_SHARE)
    return _settings(case.system, case.prepared, next(enough, TOLERANCES[-1]))


def _finest(run: Callable[[float], list[np.ndarray]]) -> list[np.ndarray]:
    """What comes nearest to the exact solution: kinks of inputs that go straight from sample to sample may forbid the
    finest steps."""
    for share in (100, 10):
        try:
            return run(TOLERANCES[-1] / share)
        except NumericalError:
            continue
    return run(TOLERANCES[-1])

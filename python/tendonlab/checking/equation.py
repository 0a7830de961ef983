"""The simulator's equation of motion along the logs: what is left where it should balance."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from tendonlab import _core
from tendonlab.checking.logs import VELOCITIES, Logs
from tendonlab.data import Dataset, Experiment
from tendonlab.simulation.catalog import MEMORY, SystemInfo
from tendonlab.simulation.system import System

MOST_FAILURES = 0.02  # share of the samples where the equations may have no value


@dataclass(frozen=True)
class Equation:
    """The equations of a system. The first: the balance of efforts of all parts that move together. Where every axis
    was measured, one for each further axis: its own balance. One for each other output: what it should read. A system
    without degrees of freedom, or with an input that says how a part moves, has these alone."""

    dataset: Dataset
    system: System

    @cached_property
    def axes(self) -> dict[int, str]:
        """The measured degrees of freedom and their signals."""
        known = self.dataset.signals
        return {s.axis: s.name for s in self.system.info.outputs if s.axis is not None and s.name in known}

    @cached_property
    def prescribed(self) -> tuple[str, ...]:
        """The logged inputs that say how a part moves, in place of what would drive the part."""
        others = {s.replaced_by for s in self.system.info.inputs}
        return tuple(s.name for s in self.system.info.inputs if s.name in others & set(self.dataset.signals))

    @cached_property
    def separate(self) -> tuple[int, ...]:
        """Degrees of freedom beyond the first measured one whose own balance is an equation."""
        return tuple(self.axes)[1:] if len(self.axes) == self.system.info.dof else ()

    @cached_property
    def others(self) -> tuple[str, ...]:
        """Outputs that are no position of an axis, as far as they were measured."""
        info = self.system.info
        return tuple(s.name for s in info.outputs if s.axis is None and s.name in self.dataset.signals)

    @cached_property
    def measured(self) -> tuple[str, ...]:
        """The measured outputs: those of axes first."""
        return (*self.axes.values(), *self.others)

    @cached_property
    def predicted(self) -> tuple[tuple[str, ...], ...]:
        """For each equation the signals that it predicts."""
        if not self.moved:
            return tuple((name,) for name in self.others)
        inputs = tuple(s.name for s in self.system.info.inputs if s.name in self.dataset.signals)
        return (inputs, *((self.axes[j],) for j in self.separate), *((name,) for name in self.others))

    @cached_property
    def moved(self) -> tuple[str, ...]:
        """The axis signals whose balance the first equations are."""
        if self.prescribed:
            return ()
        return (*tuple(self.axes.values())[:1], *(self.axes[j] for j in self.separate))

    def along(self, logs: Logs) -> tuple[Stretch, ...]:
        """The logs cut where conditions change, ready to be evaluated."""
        return tuple(Stretch.of(self, logs, group) for group in self._groups(logs))

    @cached_property
    def conditions(self) -> tuple[Conditions, ...]:
        """The simulator in each experiment."""
        return tuple(Conditions.of(self, e) for e in self.dataset.experiments)

    def evaluate(self, stretches: Sequence[Stretch], samples: int) -> np.ndarray:
        """Every equation (equations, samples)."""
        return np.asarray(self.nudged(stretches, samples, {})[0])

    def nudged(self, stretches: Sequence[Stretch], samples: int, nudges: Mapping[int, float]) -> np.ndarray:
        """Every equation as it is, and after each nudge, {index of a parameter: by how much} (1 + nudges, equations,
        samples)."""
        found = np.empty((1 + len(nudges), len(self.predicted), samples))
        for stretch in stretches:
            found[..., stretch.own] = stretch.missing(self, nudges)
        return _without_failures(found)

    @cached_property
    def places(self) -> tuple[int, ...]:
        """Where the system lists the outputs `others`."""
        names = [s.name for s in self.system.info.outputs]
        return tuple(names.index(name) for name in self.others)

    def _groups(self, logs: Logs) -> list[list[int]]:
        """Experiments that one call may go through: of the same conditions, with inputs that count at the instant, not
        velocities whose travel counts from the start."""
        alone = any(
            s.dimension in VELOCITIES and s.between != "hold" and s.name in logs.driving
            for s in self.system.info.inputs
        )
        groups: dict[str, list[int]] = {}
        for i in np.unique(logs.run).tolist():
            groups.setdefault(str(i) if alone else self.conditions[i].key, []).append(i)
        return list(groups.values())


@dataclass(frozen=True)
class Conditions:
    """The numbers of the simulator in an experiment; `fixed`: indices of those that it states; `shape`: how far each
    degree of freedom moves with the first measured one."""

    values: list[float]
    active: list[bool]
    fixed: frozenset[int]
    shape: np.ndarray

    @cached_property
    def key(self) -> str:
        """The same for experiments under the same conditions."""
        return repr((self.values, sorted(self.fixed)))

    @classmethod
    def of(cls, equation: Equation, experiment: Experiment) -> Conditions:
        """The conditions of `experiment`."""
        system = equation.system.under(experiment)
        values, active = system.values(), _without_memory(system)
        shape = np.array(_core.rigid_motion(system.kind, values, active)[0]) if equation.axes else np.ones(0)
        names = [p.name for p in system.info.parameters]
        fixed = frozenset(names.index(name) for name in experiment.conditions if name in names)
        return cls(values, active, fixed, shape / shape[next(iter(equation.axes))] if equation.axes else shape)


@dataclass(frozen=True)
class Stretch:
    """Samples of experiments under the same conditions: `own` marks them; `rest`: the logs of the other outputs."""

    own: np.ndarray
    time: np.ndarray
    inputs: tuple[_core.Signal, ...]
    under: Conditions
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    rest: np.ndarray

    @classmethod
    def of(cls, equation: Equation, logs: Logs, group: Sequence[int]) -> Stretch:
        """The samples of the experiments `group`."""
        own = np.isin(logs.run, group)
        under = equation.conditions[group[0]]
        time = logs.time[own] if len(group) == 1 else logs.step * np.arange(float(own.sum()))
        rest = np.array([logs.others[name][0, own] for name in equation.others]).reshape(-1, len(time))
        inputs = _inputs(equation.system, logs, own, time)
        return cls(own, time, inputs, under, *_motion(equation, logs, own, under.shape), rest)

    def without_inputs(self, system: System, given: Collection[str]) -> Stretch:
        """The same where the inputs that were `given` are 0. One that was not logged stays out: a system may be another
        one with it."""
        nothing = _core.Signal(self.time[:1], np.zeros((1, 4)), False)
        each = zip(system.info.inputs, self.inputs, strict=True)
        return replace(self, inputs=tuple(nothing if s.name in given else signal for s, signal in each))

    def shifted(self, axis: int, by: float) -> Stretch:
        """The same with a degree of freedom elsewhere."""
        position = self.position.copy()
        position[axis] += by
        return replace(self, position=position)

    def missing(self, equation: Equation, nudges: Mapping[int, float]) -> np.ndarray:
        """What the efforts lack to balance, with no nudge and with each (1 + nudges, equations, samples)."""
        values = np.tile(self.under.values, (1 + len(nudges), 1))
        for row, (parameter, by) in enumerate(nudges.items(), start=1):
            if parameter not in self.under.fixed:
                values[row, parameter] += by
        info = equation.system.info
        if not equation.axes:
            seen = np.array([self._read(info, row)[list(equation.places)] for row in values.tolist()])
            return np.asarray(self.rest - seen)
        found = _core.balance(
            info.kind, values, self.under.active, self._experiment(info), self.position, self.velocity
        )
        missing = found["inertia"] * self.acceleration - found["effort"]
        seen = found["outputs"][:, list(equation.places)]
        if not equation.moved:
            return np.asarray(self.rest - seen)
        together = np.tensordot(missing, self.under.shape, axes=(1, 0))[:, None]
        return np.concatenate([together, missing[:, list(equation.separate)], self.rest - seen], axis=1)

    def _read(self, info: SystemInfo, values: list[float]) -> np.ndarray:
        """What every output should read (outputs, samples), of a system without degrees of freedom."""
        run = _core.simulate(info.kind, values, self.under.active, self._experiment(info), [], _core.Settings())
        return np.asarray(run["outputs"])

    def _experiment(self, info: SystemInfo) -> _core.Experiment:
        """What the core is asked: these instants and inputs."""
        still = [0.0] * info.dof
        return _core.Experiment(
            kind=info.kind, time=self.time.tolist(), inputs=self.inputs, loop=_core.Loop(), position=still,
            velocity=still,
        )  # fmt: skip


def _without_failures(found: np.ndarray) -> np.ndarray:
    """The same with the valid sample before in place of the few where the equations have no value: lags that are
    tried, or noise, may slacken a cable beyond what a law is made for."""
    valid = np.isfinite(found).all(axis=(0, 1))
    if valid.all() or np.mean(~valid) > MOST_FAILURES:
        return found
    before = np.maximum.accumulate(np.where(valid, np.arange(len(valid)), int(np.argmax(valid))))
    return np.asarray(found[..., before])


def _motion(
    equation: Equation, logs: Logs, own: np.ndarray, shape: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, velocity and acceleration of every degree of freedom; what was not measured moves as if nothing
    stretched."""
    if not equation.axes:
        return tuple(np.zeros((3, 0, int(own.sum()))))  # type: ignore[return-value]
    first = logs.moving[next(iter(equation.axes.values()))][:, own]
    rows = [
        logs.moving[equation.axes[j]][:, own] if j in equation.axes else share * first for j, share in enumerate(shape)
    ]
    position, velocity, acceleration = np.array(rows).transpose(1, 0, 2)
    stated = equation.system.info.dof
    return np.ascontiguousarray(position[:stated]), np.ascontiguousarray(velocity[:stated]), acceleration


def _inputs(system: System, logs: Logs, own: np.ndarray, time: np.ndarray) -> tuple[_core.Signal, ...]:
    """The inputs, by value, rate and integral at each sample."""
    names = [s.name for s in system.info.inputs]
    return tuple(
        _signal(time, *logs.driving[name][:, own]) if name in logs.driving else _core.Signal() for name in names
    )


def _signal(time: np.ndarray, value: np.ndarray, rate: np.ndarray, travel: np.ndarray) -> _core.Signal:
    """A signal of that value and rate at each instant, and of that integral up to there."""
    step, pieces = np.diff(time), np.zeros((len(time), 4))
    pieces[:, 0], pieces[:, 1] = value, rate
    pieces[:-1, 2] = 3.0 * (np.diff(travel) - value[:-1] * step - 0.5 * rate[:-1] * step**2) / step**3
    return _core.Signal(time, pieces, False)


def _without_memory(system: System) -> list[bool]:
    """Flags of the effects. Those with a memory are off: a motion at an instant does not say what they remember."""
    return [on and not e.roles & MEMORY for on, e in zip(system.active(), system.info.effects, strict=True)]

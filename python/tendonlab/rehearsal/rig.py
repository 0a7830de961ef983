"""Simulated rigs: the user's experiments, driven and read as on the user's rig, by a simulator that is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from tendonlab.data import Dataset, Experiment
from tendonlab.fitting.case import make_case
from tendonlab.fitting.floor import friction_groups
from tendonlab.rehearsal.beliefs import Belief, beliefs_of
from tendonlab.rehearsal.drive import Drive
from tendonlab.rehearsal.sensors import Noise
from tendonlab.simulation.system import System

TOLERANCE = 1e-8  # of a step of the simulated rigs
Effects = Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class SimulatedRig:
    """What simulated rigs share. `rig`: the user's dataset, or one whose experiments are planned; `runs`: its
    experiments with what drives them; `noise`: of its sensors and of its friction from run to run; `planned`: whether
    the experiments are planned ones."""

    rig: Dataset
    drive: Drive
    runs: tuple[Experiment, ...]
    noise: Noise
    planned: bool = False

    @cached_property
    def system(self) -> System:
        """The user's simulator, in the loop that drives the simulated rigs."""
        return replace(self.rig.system(), controller=self.drive.controller)

    @cached_property
    def beliefs(self) -> tuple[Belief, ...]:
        """What is believed of the free parameters."""
        case = make_case(self.clean({}), tolerance=TOLERANCE)
        return beliefs_of(case.system, self.rig.parameters, case.scales)

    def clean(self, effects: Effects) -> Dataset:
        """Logs without noise and scatter, of a rig with the nominal parameters and `effects`, as
        `System.with_effects` takes them. The noise of the sensors is stated: estimates would find none."""
        system = self.system.with_effects(effects)
        return self._dataset([self._log(run, system, None) for run in self.runs])

    def drawn(self, random: np.random.Generator, effects: Effects) -> Dataset:
        """Logs of a rig whose parameters are drawn from the beliefs and that has `effects`."""
        values = {belief.name: belief.draw(random) for belief in self.beliefs}
        return self.noisy(random, self.system.with_parameters(values).with_effects(effects))

    def noisy(self, random: np.random.Generator, system: System) -> Dataset:
        """Logs of a rig that `system` is, with noise of the sensors and scatter of friction from run to run."""
        logs = [self._log(run, self._scattered(system, random), random) for run in self.runs]
        return replace(self.rig, experiments=tuple(logs))

    def _dataset(self, experiments: list[Experiment]) -> Dataset:
        stated = {s.name: s.noise for s in self.noise.sensors}
        signals = {name: replace(s, noise_sd=stated.get(name, s.noise_sd)) for name, s in self.rig.signals.items()}
        return replace(self.rig, experiments=tuple(experiments), signals=signals)

    def _log(self, run: Experiment, system: System, random: np.random.Generator | None) -> Experiment:
        """`run` as `system` logs it; without noise where `random` is None."""
        noise = {s.name: 0.0 if random is None else s.drawn(len(run.data), random) for s in self.noise.sensors}
        outputs, command = self.drive.driven(system, run, TOLERANCE, noise)
        logged = {}
        for sensor in self.noise.sensors:
            values = outputs[sensor.name].to_numpy() + noise[sensor.name]
            read = values if random is None else sensor.rounded(values)
            logged[sensor.name] = np.where(np.isfinite(self._pattern(run, sensor.name)), read, np.nan)
        if command is not None:
            unheard = 0.0 if random is None else self.noise.command * random.normal(size=len(command))
            logged[str(self.drive.command)] = command + unheard
        data = run.data.assign(**logged)
        return replace(run, data=data[[name for name in data.columns if name in self.rig.signals]])

    def _pattern(self, run: Experiment, name: str) -> np.ndarray:
        """NaN where the rig has no sample of an output; a planned output has all of them."""
        return run.data[name].to_numpy(dtype=float) if name in run.data.columns else np.zeros(len(run.data))

    def _scattered(self, system: System, random: np.random.Generator) -> System:
        """The friction of each element times a factor of its own, as in one run."""
        names, changed = [p.name for p in system.info.parameters], {}
        for group in friction_groups(system):
            factor = float(np.exp(self.noise.scatter * random.normal()))
            for k in group:
                row = system.info.parameters[k]
                value = system.parameters[names[k]] * factor
                changed[names[k]] = min(max(value, row.lower), row.upper)
        return system.with_parameters(changed) if changed else system

"""Small rigs that are simulated, measured with noise and fitted: everything that the fit itself is given."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.simulation.catalog import system_info
from tendonlab.simulation.signals import hold, linear
from tendonlab.simulation.system import System

TIME = np.arange(0.0, 2.0, 0.004)


@dataclass(frozen=True)
class Rig:
    """A system and its experiments, each driven by a command of its own; `noise` is the sd of every output."""

    system: System
    commands: tuple[np.ndarray, ...]
    noise: float = 1e-3
    held: bool = True
    ar: tuple[float, ...] = ()
    unmeasured: tuple[str, ...] = ()
    settings: Any = field(default_factory=lambda: _core.Settings(tolerance=1e-7))

    @property
    def kind(self) -> str:
        return self.system.kind

    def index(self, name: str) -> int:
        return [p.name for p in self.system.info.parameters].index(name)

    def experiment(self, e: int, position: list[float] | None = None) -> Any:
        dof = self.system.info.dof
        signal = (hold if self.held else linear)(TIME, self.commands[e])
        return _core.Experiment(
            kind=self.kind, time=TIME.tolist(), inputs=[signal, _core.Signal()], loop=_core.Loop(),
            position=position or [0.0] * dof, velocity=[0.0] * dof,
        )  # fmt: skip

    def simulate(self, e: int, *, seeds: Any = (), position: list[float] | None = None, **changes: float) -> Any:
        system = self.system.with_parameters(changes)
        return _core.simulate(
            self.kind, system.values(), system.active(), self.experiment(e, position), list(seeds), self.settings
        )

    def whitening(self, outputs: np.ndarray, **options: Any) -> Any:
        sd = [np.inf if s.name in self.unmeasured else self.noise for s in self.system.info.outputs]
        return _core.Whitening([list(self.ar)] * len(sd), sd, outputs, **options)

    def tasks(self, *, seed: int | None = 0, position: list[float] | None = None, **changes: float) -> list[Any]:
        """Each experiment as the system with `changes` would measure it; `seed` None: without noise."""
        tasks = []
        for e in range(len(self.commands)):
            outputs = self.simulate(e, position=position, **changes)["outputs"]
            if seed is not None:
                outputs = outputs + self.noise * np.random.default_rng([seed, e]).normal(size=outputs.shape)
            tasks.append(_core.Task(self.experiment(e), self.whitening(outputs)))
        return tasks

    def free(self, *names: str, **changes: Any) -> list[Any]:
        rows = []
        for name in names:
            value = self.system.values()[self.index(name)]
            default = {"index": self.index(name), "log": value > 0, "scale": abs(value) or 1.0, "start": value}
            rows.append(_core.Free(name=name, **{**default, **changes}))
        return rows

    def fit(self, tasks: list[Any], free: list[Any], **options: Any) -> dict[str, Any]:
        return _core.fit(self.kind, self.system.values(), self.system.active(), tasks, free, self.settings, **options)

    def linearise(self, tasks: list[Any], free: list[Any], **options: Any) -> dict[str, Any]:
        return _core.linearise(
            self.kind, self.system.values(), self.system.active(), tasks, free, self.settings, **options
        )


def _commands(amplitudes: tuple[float, ...]) -> tuple[np.ndarray, ...]:
    return tuple(
        a * np.sin(2 * np.pi * (0.8 + 0.5 * k) * TIME) * (1 + 0.5 * np.sin(3.1 * TIME))
        for k, a in enumerate(amplitudes)
    )


def make_joint() -> Rig:
    """A joint that reverses and sticks."""
    values = {"inertia": 0.5, "gravity_torque": 1.0, "torque_constant": 1.0, "coulomb": 0.3, "viscous": 0.4}
    system = System(kind="rigid_joint", parameters=values, effects=("joint:coulomb", "joint:viscous"))
    return Rig(system, _commands((1.5, 2.5)))


def make_drive() -> Rig:
    """Motor, elastic cable and joint; the joint sticks while the motor winds the cable up."""
    values = {
        "motor_inertia": 0.05, "joint_inertia": 0.3, "gear_ratio": 2.0, "cable_stiffness": 80.0, "cable_damping": 0.3,
        "gravity_torque": 1.0, "motor_viscous": 0.02, "motor_coulomb": 0.05, "joint_viscous": 0.2, "joint_coulomb": 0.4,
    }  # fmt: skip
    info = system_info("two_inertia")
    system = System(kind="two_inertia", parameters=values, effects=info.default_nominal_effects)
    return Rig(system, _commands((0.9, 1.4)), held=False)


@pytest.fixture
def joint() -> Rig:
    return make_joint()


@pytest.fixture
def drive() -> Rig:
    return make_drive()

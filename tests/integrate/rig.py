"""What the tests of stepper and systems share: a simulator run straight through the core, with exact derivatives, and
central differences of the same run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tendonlab import _core
from tendonlab.simulation.catalog import PORT_QUANTITIES
from tendonlab.simulation.signals import hold, linear, smooth
from tendonlab.simulation.system import System

MAKE = {"hold": hold, "linear": linear, "smooth": smooth}
INERTIAS: dict[str, float] = {
    "motor_inertia": 1.2e-4,
    "joint_inertia": 0.02,
    "gear_ratio": 10.0,
    "gravity_torque": 0.0,
    "cable_stiffness": 50.0,
    "cable_damping": 0.05,
}
NOMINAL = ("motor:coulomb", "motor:viscous", "joint:coulomb", "joint:viscous")
FRICTION: dict[str, float] = {
    "motor_viscous": 2e-4,
    "motor_coulomb": 3e-3,
    "joint_viscous": 0.02,
    "joint_coulomb": 0.05,
}


@dataclass(frozen=True, kw_only=True)
class Run:
    """`outputs`: by name, (samples,). `gradient`: by parameter, (outputs, samples). `ports`: by port, velocity,
    position, load and force as rows (4, samples)."""

    outputs: dict[str, np.ndarray]
    gradient: dict[str, np.ndarray]
    ports: dict[str, np.ndarray]
    attempts: int
    rejected: int
    events: int

    def __getitem__(self, output: str) -> np.ndarray:
        return self.outputs[output]

    @property
    def table(self) -> np.ndarray:
        """All outputs, (outputs, samples)."""
        return np.array(list(self.outputs.values()))


def joint(effects: Sequence[str] = (), **parameters: float) -> System:
    """A rigid joint; names of sensors' parameters may be written with __ for the dot."""
    values = {"inertia": 1.0, "gravity_torque": 0.0, "torque_constant": 1.0, **parameters}
    return System(kind="rigid_joint", parameters=_dotted(values), effects=tuple(effects))


def pair(effects: Sequence[str] = (), **parameters: float) -> System:
    """Two inertias with a cable between them, without friction unless asked for."""
    return System(kind="two_inertia", parameters=_dotted({**INERTIAS, **parameters}), effects=tuple(effects))


def _dotted(values: Mapping[str, float]) -> dict[str, float]:
    return {name.replace("__", "."): value for name, value in values.items()}


def run(
    system: System,
    time: np.ndarray,
    command: np.ndarray | float | Mapping[str, np.ndarray] = 0.0,
    *,
    known: np.ndarray | float | None = None,
    kind: str = "smooth",
    by: Sequence[str] = (),
    tolerance: float = 1e-9,
    loop: Any = None,
    position: Sequence[float] | None = None,
    velocity: Sequence[float] | None = None,
    ports: bool = False,
    scales: tuple[float, float] = (1e-2, 1e-2),
    max_attempts: int = 200_000,
    keep_zero: bool = False,
) -> Run:
    """Simulate `system` under a command (and a known torque), or inputs by name, given at `time`, `kind` "hold",
    "linear" or "smooth" between them."""
    info = system.info
    given = command if isinstance(command, Mapping) else _commanded(system, command, known)
    experiment = _experiment(system, time, given, kind=kind, loop=loop, position=position, velocity=velocity)
    names = [p.name for p in info.parameters]
    seeds = [("parameter", names.index(n)) if n in names else (n[:8], int(n[8:])) for n in by]
    settings = _core.Settings(
        tolerance=tolerance,
        position_scale=scales[0],
        velocity_scale=scales[1],
        max_attempts=max_attempts,
        ports=PORT_QUANTITIES if ports else (),
    )
    done = _core.simulate(system.kind, system.values(), system.active(keep_zero=keep_zero), experiment, seeds, settings)
    return Run(
        outputs=dict(zip([s.name for s in info.outputs], done["outputs"], strict=True)),
        gradient=dict(zip(by, done["gradient"], strict=True)) if by else {},
        ports=dict(zip([p.name for p in info.ports], done["ports"], strict=True)) if ports else {},
        attempts=done["attempts"],
        rejected=done["rejected"],
        events=done["events"],
    )


def run_many(
    systems: Sequence[System],
    time: np.ndarray,
    inputs: Mapping[str, np.ndarray | float],
    *,
    kind: str = "smooth",
    tolerance: float = 1e-9,
    outputs: Sequence[int] | None = None,
    **how: Any,
) -> np.ndarray:
    """Outputs, all by default, of several systems of one kind, (systems, outputs, samples), as points of a sweep get
    them: steps of eight are taken together. `how`: loop, position, velocity, as in `run`."""
    first = systems[0]
    dof, channels = first.info.dof, list(range(len(first.info.outputs)) if outputs is None else outputs)
    start = [np.tile(how.get(name) or [0.0] * dof, (len(systems), 1)) for name in ("position", "velocity")]
    out = np.empty((len(systems), len(channels), time.size))
    messages = _core.simulate_many(
        first.kind,
        np.array([s.values() for s in systems]),
        np.array([s.active() for s in systems]),
        _experiment(first, time, inputs, kind=kind, **how),
        *start,
        _core.Settings(tolerance=tolerance),
        channels,
        out,
    )
    assert messages == [""] * len(systems)
    return out


def _commanded(
    system: System, command: np.ndarray | float, known: np.ndarray | float | None
) -> dict[str, np.ndarray | float]:
    inputs = system.info.inputs
    return {inputs[0].name: command} | ({} if known is None else {inputs[1].name: known})


def _experiment(
    system: System,
    time: np.ndarray,
    given: Mapping[str, np.ndarray | float],
    *,
    kind: str,
    loop: Any = None,
    position: Sequence[float] | None = None,
    velocity: Sequence[float] | None = None,
) -> Any:
    info = system.info
    return _core.Experiment(
        kind=system.kind,
        time=time.tolist(),
        inputs=[_signal(time, given[s.name], kind) if s.name in given else _core.Signal() for s in info.inputs],
        loop=_core.Loop() if loop is None else loop,
        position=list(position or [0.0] * info.dof),
        velocity=list(velocity or [0.0] * info.dof),
    )


def _signal(time: np.ndarray, values: np.ndarray | float, kind: str) -> Any:
    return MAKE[kind](time, np.broadcast_to(np.asarray(values, dtype=float), time.shape).copy())


def controller(reference: Any, **changes: Any) -> Any:
    """A loop on the first degree of freedom: u = P (r - y) + D (w r' - y')."""
    settings: dict[str, Any] = {
        "kind": "controller",
        "axis": 0,
        "output": 0,
        "proportional": 0.05,
        "derivative": 0.002,
        "reference_weight": 1.0,
        "limit": np.inf,
        "sample_time": 0.0,
        "reference": reference,
        "disturbance": _core.Signal(),
    }
    return _core.Loop(**{**settings, **changes})


def differences(system: System, name: str, time: np.ndarray, *args: Any, step: float, **options: Any) -> np.ndarray:
    """Central differences, of order four, of all outputs by a parameter or part of the initial state, shape (outputs,
    samples): the error of the stepper, 1e-12, divided by the step stays well below 1e-5 of the derivative."""

    def at(shift: float) -> np.ndarray:
        if name.startswith(("position", "velocity")):
            axis = int(name[8:])
            start = list(options.get(name[:8]) or [0.0] * system.info.dof)
            start[axis] += shift
            return run(system, time, *args, **{**options, name[:8]: start}).table
        value = system.parameters.get(name, 1.0 if name.endswith("presliding_share") else 0.0)
        return run(system.with_parameters({name: value + shift}), time, *args, **options).table

    return (8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) / (12.0 * step)


def relative(value: np.ndarray, reference: np.ndarray) -> float:
    """Root mean square of the error over that of the reference (the error itself where that is 0)."""
    scale = float(np.sqrt(np.mean(reference**2)))
    return float(np.sqrt(np.mean((value - reference) ** 2))) / (scale or 1.0)

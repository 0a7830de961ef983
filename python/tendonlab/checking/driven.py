"""Experiments in which the motor is off: what moves freely moves alike at any time, and tells no lag."""

from __future__ import annotations

from tendonlab import _core
from tendonlab.checking.equation import Equation
from tendonlab.checking.logs import Logs
from tendonlab.checking.terms import rms
from tendonlab.simulation.motor import is_next_to_0, is_pushed


def free_runs(equation: Equation, logs: Logs) -> frozenset[int]:
    """Indices of the experiments whose logged command is next to 0 beside what accelerates the motor there."""
    system, dataset = equation.system, equation.dataset
    command = system.info.command
    first = next((s.name for s in system.info.outputs if s.axis == 0 and s.name in logs.moving), None)
    if command is None or command.name not in dataset.signals or first is None:
        return frozenset()
    _, inertia, _ = _core.rigid_motion(system.kind, system.values(), system.active())
    logged = [e.data[command.name].to_numpy(dtype=float) for e in dataset]
    taken = [inertia * rms(logs.moving[first][2, logs.run == k]) for k in range(len(logged))]
    runs = enumerate(zip(dataset, logged, taken, strict=True))
    return frozenset(
        k for k, (e, log, most) in runs if not is_pushed(system, e) and is_next_to_0(system, log, float(most))
    )

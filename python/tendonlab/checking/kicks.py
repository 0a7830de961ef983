"""Spikes of a command that moved the rig: kicks of a controller, not errors of a log.

A controller that differentiates its reference kicks where that jumps. A kick changes the momentum of the motor by its
torque times a sample; an error of the log changes nothing."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tendonlab import _core
from tendonlab.data import Dataset, Experiment
from tendonlab.simulation.motor import effort_per_command

BESIDE = 4  # samples on either side, whose line tells the velocity
ANSWERED = 0.3  # of the momentum of a spike that must be seen: the inertia may be wrong, or part of it decoupled
SURE = 5.0  # standard errors of that share, from 0


def moves_the_rig(dataset: Dataset, name: str, found: Mapping[tuple[str, str], np.ndarray]) -> bool:
    """Whether the measured motion answers the spikes `found` in an input; False where it cannot tell."""
    system = dataset.system()
    command = system.info.command
    first = next((s.name for s in system.info.outputs if s.axis == 0 and s.name in dataset.outputs), None)
    if command is None or name != command.name or first is None:
        return False
    per = effort_per_command(system)
    _, inertia, _ = _core.rigid_motion(system.kind, system.values(), system.active())
    pairs = [pair for e in dataset for pair in _momenta(e, name, first, found.get((e.name, name)))]
    given, seen = (per * np.array([p[0] for p in pairs]), np.array([inertia * p[1] - per * p[2] for p in pairs]))
    if not len(pairs) or not given.any():
        return False
    share = float(given @ seen / (given @ given))
    rest = seen - share * given
    error = 1.4826 * float(np.median(np.abs(rest))) / float(np.sqrt(given @ given)) if len(pairs) > 1 else 0.0
    return share > max(ANSWERED, SURE * error)


def _momenta(experiment: Experiment, name: str, position: str, at: np.ndarray | None) -> list[tuple[float, ...]]:
    """Of each spike: what it adds to the momentum, the change of velocity across it, and what the command beside it
    adds, over that before it."""
    if at is None or not at.any():
        return []
    u, q, time = (
        np.asarray(x, dtype=float) for x in (experiment.data[name], experiment.data[position], experiment.time)
    )
    line = np.arange(BESIDE + 1) - 0.5 * BESIDE
    line = line / (line @ line)
    rows = []
    for k in np.flatnonzero(at):
        if k - BESIDE < 0 or k + 2 + BESIDE > len(u):
            continue
        step = (time[k + 1 + BESIDE] - time[k - BESIDE]) / (2 * BESIDE + 1)
        before, after = line @ q[k - BESIDE : k + 1] / step, line @ q[k + 1 : k + 2 + BESIDE] / step
        plain = u[k - BESIDE // 2 : k + 1 + BESIDE // 2].copy()
        plain[BESIDE // 2] = u[k + 1]  # a step of the reference drives the motor from here on as well
        beside = float(np.sum(plain - np.mean(u[k - BESIDE : k]))) * step
        rows.append((float(u[k] - plain[BESIDE // 2]) * step, float(after - before), beside))
    return [row for row in rows if np.isfinite(row).all()]

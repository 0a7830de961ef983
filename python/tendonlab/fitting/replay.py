"""Which loop the simulator is replayed in: the same for every model that is compared."""

from __future__ import annotations

import numpy as np

from tendonlab import _core
from tendonlab.data import Dataset
from tendonlab.simulation.prepare import Replay
from tendonlab.simulation.system import System


def choose_replay(dataset: Dataset, system: System) -> Replay:
    """Free run with the known controller; else injection at a bandwidth half of the one that holds 95 % of the measured
    motion's power (the same for every model); else, without a measured motor, the logged command alone."""
    controller = dataset.controller
    if controller is not None:
        return Replay("controller", controller.kp, controller.kd, controller.measured)
    first = next((s.name for s in system.info.outputs if s.axis == 0), None)
    command = system.info.inputs[0].name if system.info.commanded else None  # another input may stand in for it
    if first is None or first not in dataset.outputs or command not in dataset.inputs:
        return Replay("free")
    _, inertia, _ = _core.rigid_motion(system.kind, system.values(), system.active())
    moved = [(e.time, e.data[first].to_numpy(dtype=float)) for e in dataset.train if first in e.data.columns]
    rates = [2 * np.pi * _frequency_below(time, values) for time, values in moved if np.isfinite(values).any()]
    if not rates:
        return Replay("free")
    omega = 0.5 * float(np.median(rates))
    return Replay("injection", float(inertia * omega**2), float(1.4 * inertia * omega), first)


def _frequency_below(time: np.ndarray, values: np.ndarray, share: float = 0.95) -> float:
    """Frequency, Hz, below which `share` of the power of the moving part of a signal lies."""
    kept = np.isfinite(values)
    steady = np.linspace(time[0], time[-1], len(time))
    centred = np.interp(steady, time[kept], values[kept])
    centred = (centred - centred.mean()) * np.hanning(len(centred))
    power = np.abs(np.fft.rfft(centred)) ** 2
    total = np.cumsum(power[1:])
    k = int(np.searchsorted(total, share * total[-1])) + 1
    return float(k / (time[-1] - time[0]))

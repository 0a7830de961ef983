"""In which sense what rests at the start of an experiment has moved last. Friction that follows the last motion keeps
its sign at rest; no sensor tells it, but the forces do, as soon as the motion begins."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tendonlab.errors import NumericalError

if TYPE_CHECKING:
    from collections.abc import Callable

    from tendonlab.simulation.catalog import SystemInfo
    from tendonlab.simulation.records import Experiment

STILL = 1e-6  # of its largest velocity, up to which a drive rests
FEWEST = 4  # samples of a rest that tell its forces
EXACT = 1e-6  # tolerance of the simulations that are compared: a loose one may step over the first motion


def last_sense(
    experiment: Experiment, info: SystemInfo, measured: np.ndarray, simulate: Callable[[float, int], np.ndarray]
) -> float:
    """-1 where a drive whose velocity is prescribed rests at first, and what was `measured` until the rest has lasted
    twice as long is likelier if the joint has moved backwards last; else 1. Constants of the sensors do not count.

    `measured`: (outputs, samples). `simulate(sense, num)`: the first outputs, (outputs, num), after such a motion."""
    rest = _rest(experiment, info)
    if rest < FEWEST:
        return 1.0
    first = measured[:, : 2 * rest]
    forwards, backwards = (_unlikely(first, simulate, sense) for sense in (1.0, -1.0))
    return -1.0 if backwards < forwards else 1.0


def _rest(experiment: Experiment, info: SystemInfo) -> int:
    """Samples before a drive whose velocity is prescribed moves; 0 where there is none, or where it never moves."""
    for name in {given.replaced_by for given in info.inputs} & set(experiment.data.columns):
        speed = np.abs(experiment.data[name].to_numpy(dtype=float))
        return int(np.argmax(speed > STILL * speed.max()))
    return 0


def _unlikely(first: np.ndarray, simulate: Callable[[float, int], np.ndarray], sense: float) -> float:
    """Minus the logarithm of the likelihood of the first samples, but for a constant: each output has its own noise."""
    try:
        left = first - simulate(sense, first.shape[1])
    except NumericalError:
        return np.inf
    seen = np.isfinite(left).sum(axis=1)
    told = seen > 1
    return float(0.5 * np.sum(seen[told] * np.log(np.nanvar(left[told], axis=1) + np.finfo(float).tiny)))

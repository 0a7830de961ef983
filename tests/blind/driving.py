"""Rigs of the generator with stated parameters, and a constant push."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tendonlab.blind.description import Lanes, Run, Scene, System
from tendonlab.blind.plant import simulate

Values = Mapping[str, float | np.ndarray]


def rigs(system: System, values: Values, *, num_lanes: int = 1, form: int = 0) -> Lanes:
    """As many rigs of a system, one value for all of them or one for each."""
    return Lanes(
        system=system,
        parameters={name: np.broadcast_to(np.asarray(value, float), (num_lanes,)) for name, value in values.items()},
        scale=np.ones((len(system.slots), num_lanes)),
        form=np.full(num_lanes, form),
    )


def push(rig: Lanes, torque: float | np.ndarray, *, seconds: float, step: float, **scene: np.ndarray) -> Run:
    """Open loop: a constant command, N*m."""
    command = np.broadcast_to(np.asarray(torque, float), (round(seconds / 0.002), rig.size))
    return simulate(rig, Scene(reference=command, **scene), step=step)

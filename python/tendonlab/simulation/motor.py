"""Whether a motor drives its rig at all, and what its command is worth."""

from __future__ import annotations

import numpy as np

from tendonlab.simulation.records import Experiment
from tendonlab.simulation.system import System

NEXT_TO_0 = 0.02  # of the effort that a motion takes: a command no larger is that of a motor that is off


def effort_per_command(system: System) -> float:
    """Effort per unit of the command: the torque constant, where the system has one."""
    gain = system.info.with_role("command_gain")
    return 1.0 if gain is None else system.parameters[gain.name]


def is_next_to_0(system: System, command: np.ndarray, taken: float) -> bool:
    """Whether a logged command is next to nothing beside the effort that the motion of the motor takes (rms)."""
    return effort_per_command(system) * float(np.sqrt(np.nanmean(np.square(command)))) <= NEXT_TO_0 * taken


def is_pushed(system: System, experiment: Experiment) -> bool:
    """Whether a logged effort other than the motor's drives the rig in an experiment."""
    efforts = (s.name for s in system.info.inputs if s.dimension == "effort")
    return any(name in experiment.data and experiment.data[name].any() for name in efforts)

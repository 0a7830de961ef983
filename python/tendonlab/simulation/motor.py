"""Whether a motor drives its rig at all."""

from __future__ import annotations

import numpy as np

from tendonlab.simulation.system import System

NEXT_TO_0 = 0.02  # of the effort that a motion takes: a command no larger is that of a motor that is off


def is_next_to_0(system: System, command: np.ndarray, taken: float) -> bool:
    """Whether a logged command is next to nothing beside the effort that the motion of the motor takes (rms)."""
    gain = system.info.with_role("command_gain")
    per = 1.0 if gain is None else system.parameters[gain.name]
    return per * float(np.sqrt(np.nanmean(np.square(command)))) <= NEXT_TO_0 * taken

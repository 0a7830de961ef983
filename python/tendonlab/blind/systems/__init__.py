"""The kinds of rigs that the protocol draws, by name."""

from .rigid_joint import RIGID_JOINT
from .system import System
from .two_inertia import TWO_INERTIA

SYSTEMS: dict[str, System] = {system.kind: system for system in (TWO_INERTIA, RIGID_JOINT)}

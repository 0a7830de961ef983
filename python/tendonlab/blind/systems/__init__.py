"""The kinds of rigs that the protocol draws, by name."""

from .bowden_pair import BOWDEN_PAIR
from .cable_joint import CABLE_JOINT
from .ccsrm import CCSRM
from .rigid_joint import RIGID_JOINT
from .servo_pendulum import SERVO_PENDULUM
from .two_inertia import TWO_INERTIA

__all__ = ["BOWDEN_PAIR", "CABLE_JOINT", "CCSRM", "RIGID_JOINT", "SERVO_PENDULUM", "SYSTEMS", "TWO_INERTIA"]

SYSTEMS = {
    system.kind: system for system in (TWO_INERTIA, RIGID_JOINT, SERVO_PENDULUM, CCSRM, BOWDEN_PAIR, CABLE_JOINT)
}

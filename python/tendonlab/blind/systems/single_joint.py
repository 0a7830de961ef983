"""What rigs of one joint share, whatever drives them: sensors, the load of the joint's friction, what looks alike."""

from __future__ import annotations

import numpy as np

from tendonlab.blind.description import Array, Lanes, Mechanics, Push

CONSTANTS = ("load:offset", "actuation:offset", "joint:asymmetry", "sensor.joint_angle:bias")  # torque or angle
DELAYS = ("actuation:delay", "sensor.joint_angle:delay", "sensor.joint_velocity:delay")
RIVALS = {name: tuple(other for other in group if other != name) for group in (CONSTANTS, DELAYS) for name in group}
RIVALS |= {
    "joint:stribeck": ("joint:presliding", "joint:load_dependence"),
    "joint:presliding": ("joint:stribeck",),
    "joint:load_dependence": ("joint:stribeck",),
}


def twins(effect: str, outputs: tuple[str, ...]) -> tuple[str, ...]:
    """Constant torques add up wherever they act; a late command moves like a late angle, if no speed was measured."""
    pairs = [("actuation:offset", "load:offset")]
    if "joint_velocity" not in outputs:
        pairs.append(("actuation:delay", "sensor.joint_angle:delay"))
    return tuple(other for pair in pairs if effect in pair for other in pair if other != effect)


class SingleJoint(Mechanics):
    """The bodies of n lanes: one row, a pendulum."""

    def __init__(self, lanes: Lanes, step: float) -> None:
        self.lanes, self.step = lanes, step
        self.gravity, self.pull = lanes.get("gravity_torque"), lanes.get("load_offset")

    def push(self, q: Array, v: Array, drive: Array, known: Array | None) -> Push:
        weight = self.gravity * np.sin(q[0]) - self.pull
        if known is not None:
            weight = weight - known
        return Push((drive - weight)[None, :], drive, drive, v[0], weight)

    def load(self, push: Push) -> Array:
        return np.asarray(0.5 * (push.drive + push.weight))[None, :]

    def measure(self, q: Array, v: Array) -> list[Array]:
        return [q[0], v[0]]

    def within(self, q: Array, old: Array, new: Array, push: Push) -> tuple[list[Array], list[Array]]:
        return [q[0], 0.5 * (old[0] + new[0])], [self.step * 0.5 * (old[0] + new[0]), new[0] - old[0]]

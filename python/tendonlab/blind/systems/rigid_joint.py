"""One inertia on a rigid transmission, a pendulum:

J q'' = tau - friction - g sin q + known       (load_offset is a constant part of `known`)
tau = deadzone(u(t - delay)) (1 + gain_error) + offset
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tendonlab.blind.description import Array, Lanes, Output, Scene, Slot, System
from tendonlab.blind.excitation import session
from tendonlab.blind.unknown import OF_JOINTS

from . import single_joint
from .effects import FRICTION, position_loop
from .single_joint import SingleJoint

OUTPUTS = (
    Output("joint_angle", "q", "rad", "%.7f", 5e-5, 2e-4, 0.99, 2 * np.pi / 131072),
    Output("joint_velocity", "w", "rad/s", "%.5f", 5e-3, 3e-3, 0.97, 1e-3),
)
TYPICAL = {
    "joint_inertia": 0.05,
    "gravity_torque": 1.8,
    "joint_viscous": 0.08,
    "joint_coulomb": 0.15,
}
RIVALS = single_joint.RIVALS | {
    "joint:load_dependence": ("actuation:gain_error", "joint:stribeck"),
    "actuation:gain_error": ("joint:load_dependence",),
}


def sizes(truth: Mapping[str, float]) -> dict[str, float]:
    constant = 0.05 * truth["gravity_torque"]
    return {
        "load:offset": constant,
        "actuation:offset": constant,
        "actuation:gain_error": 0.08,
        "actuation:deadband": 0.3 * truth["joint_coulomb"],
        "sensor.joint_angle:bias": 0.02,
        "sensor.joint_velocity:bias": 0.02,
    } | dict.fromkeys(single_joint.DELAYS, 0.003)


class RigidJoint(SingleJoint):
    """The bodies of n lanes: one row."""

    def __init__(self, lanes: Lanes, step: float) -> None:
        super().__init__(lanes, step)
        self.inertia = lanes.get("joint_inertia")[None, :]

    def rest(self, scene: Scene) -> Array:
        """Static equilibrium under the controller's first reference, frictionless; zeros without a controller."""
        lanes, state = self.lanes, np.zeros((2, self.lanes.size))
        if scene.controller is None:
            return state
        for _ in range(30):  # contracts by g/kp, at most a third
            torque = self.gravity * np.sin(state[0]) - self.pull - lanes.get("actuation_offset")
            wanted = torque / (1.0 + lanes.get("actuation_gain_error"))
            state[0] = scene.reference[0] - lanes.get("sensor.joint_angle_bias") - wanted / scene.controller.kp
        return state


RIGID_JOINT = System(
    kind="rigid_joint",
    title="Synthetic rigid joint with gravity under a sampled position loop",
    slots=(Slot("joint", 1.0, 1.0),),
    outputs=OUTPUTS,
    optional=("joint_velocity", 0.5, ("sensor.joint_velocity:bias", "sensor.joint_velocity:delay")),
    effects=(
        *(f"joint:{effect}" for effect in FRICTION),
        "load:offset",
        *(f"actuation:{effect}" for effect in ("offset", "gain_error", "deadband", "delay")),
        *(f"sensor.{output.name}:{effect}" for effect in ("bias", "delay") for output in OUTPUTS),
    ),
    nominal_effects=("joint:viscous", "joint:coulomb"),
    typical=TYPICAL,
    contract={"joint_inertia": "inertia", "joint_coulomb": "coulomb", "joint_viscous": "viscous"},
    sizes=sizes,
    rivals=RIVALS,
    twins=single_joint.twins,
    causes=OF_JOINTS,
    loop=lambda truth, draw: position_loop(draw, inertia=truth["joint_inertia"], bandwidth=(12.0, 18.0), limit=8.0),
    session=session,
    reference="reference_angle",
    sample_times=(0.01, 0.004, 0.001),
    duration=5.0,
    coarse_step=5e-4,
    fine_step=5e-5,
    mechanics=RigidJoint,
)

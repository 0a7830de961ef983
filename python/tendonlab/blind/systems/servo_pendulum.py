"""A pendulum that a servo turns under its own position control, a small one with a coarse encoder:

(J + J_a) q'' = tau - friction - g sin q + known     (load_offset is a constant part of `known`)
tau = deadzone(k_t (V - k_t q') / R) (1 + gain_error) + offset,   V = clip(k_p (target(t - delay) - q), supply voltage)
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tendonlab.blind.description import Array, Experiment, Input, Lanes, Output, Push, Scene, Slot, System
from tendonlab.blind.excitation import session
from tendonlab.blind.plant import beyond_deadband
from tendonlab.blind.unknown import OF_JOINTS, fade, heating

from . import single_joint
from .effects import FRICTION
from .single_joint import SingleJoint

INPUTS = (
    Input("target_angle", "goal", "rad", "%.6f", True),
    Input("supply_voltage", "volts", "V", "%.3f", False),
)
OUTPUTS = (
    Output("joint_angle", "q", "rad", "%.6f", 2e-4, 3e-4, 0.99, 2 * np.pi / 4096),
    Output("joint_velocity", "w", "rad/s", "%.5f", 1e-2, 5e-3, 0.97, 0.024),
)
TYPICAL = {
    "joint_inertia": 0.005,
    "armature": 0.003,
    "gravity_torque": 0.4,
    "torque_constant": 0.37,
    "resistance": 3.6,
    "proportional_gain": 10.0,
    "voltage_limit": 8.0,
    "joint_viscous": 0.015,
    "joint_coulomb": 0.03,
}
ARM = 0.08  # m, from the axis to the payload


def sizes(truth: Mapping[str, float]) -> dict[str, float]:
    """Of a constant torque, a deadband, a bias and a delay of amplitude 1."""
    constant = 0.05 * truth["gravity_torque"]
    return {
        "load:offset": constant,
        "actuation:offset": constant,
        "actuation:deadband": 0.3 * truth["joint_coulomb"],
        "sensor.joint_angle:bias": 0.02,
        "sensor.joint_velocity:bias": 0.05,
    } | dict.fromkeys(single_joint.DELAYS, 0.005)


def servo_session(
    draw: np.random.Generator, *, excitation: str, sample_time: float, num_samples: int, has_repeats: bool = True
) -> list[Experiment]:
    """Ten experiments with a supply that sags a little, each with a voltage of its own."""
    runs = session(
        draw, excitation=excitation, sample_time=sample_time, num_samples=num_samples, has_repeats=has_repeats, arm=ARM
    )
    time = sample_time * np.arange(num_samples)
    for run in runs:
        slow = 0.05 * np.sin(2 * np.pi * draw.uniform(0.1, 0.4) * time + draw.uniform(0, 6.28))
        run.others["supply_voltage"] = np.round(draw.uniform(7.2, 7.6) + slow, 2)
    return runs


class ServoPendulum(SingleJoint):
    """The bodies of n lanes: one row. `drive` is the target angle, rad."""

    def __init__(self, lanes: Lanes, step: float) -> None:
        super().__init__(lanes, step)
        self.inertia = (lanes.get("joint_inertia") + lanes.get("armature"))[None, :]
        self.constant, self.resistance = lanes.get("torque_constant"), lanes.get("resistance")
        self.gain, self.most = lanes.get("proportional_gain"), lanes.get("voltage_limit")
        self.strength, self.offset = 1.0 + lanes.get("actuation_gain_error"), lanes.get("actuation_offset")
        self.deadband, self.rounded = lanes.get("actuation_deadband"), lanes.form != 0
        self.weak = lanes.get("fade")
        usual, time = lanes.get("fade_torque"), lanes.get("fade_time")
        self.usual, self.fade_time = np.where(usual > 0, usual, 1.0), np.where(time > 0, time, 1.0)
        self.heat = np.zeros(lanes.size)

    def rest(self, scene: Scene) -> Array:
        """Static equilibrium under the first target, frictionless."""
        state, stiffness = np.zeros((2, self.lanes.size)), self.gain * self.constant / self.resistance * self.strength
        for _ in range(30):  # Newton: gravity is weaker than the servo, or its slope helps
            torque = stiffness * (scene.reference[0] - state[0]) + self.offset + self.pull
            slope = stiffness + self.gravity * np.cos(state[0])
            state[0] += (torque - self.gravity * np.sin(state[0])) / np.maximum(slope, 0.3 * stiffness)
        return state

    def take(self, others: Mapping[str, Array]) -> None:
        """The supply voltage of the next sample is the limit."""
        self.most = others["supply_voltage"]

    def push(self, q: Array, v: Array, drive: Array, known: Array | None) -> Push:
        voltage = np.clip(self.gain * (drive - q[0]), -self.most, self.most)
        torque = self.constant * (voltage - self.constant * v[0]) / self.resistance
        if self.deadband.any():
            torque = beyond_deadband(torque, self.deadband, rounded=self.rounded)
        torque = torque * self.strength + self.offset
        if self.weak.any():
            fresh, torque = torque, fade(torque, self.heat, share=self.weak)
            self.heat = heating(self.heat, fresh, usual=self.usual, time=self.fade_time, step=self.step)
        return super().push(q, v, torque, known)


SERVO_PENDULUM = System(
    kind="servo_pendulum",
    title="Synthetic pendulum on a small servo under its own position control",
    slots=(Slot("joint", 1.0, 0.2),),
    inputs=INPUTS,
    outputs=OUTPUTS,
    optional=("joint_velocity", 0.5, ("sensor.joint_velocity:bias", "sensor.joint_velocity:delay")),
    effects=(
        *(f"joint:{effect}" for effect in FRICTION),
        "load:offset",
        *(f"actuation:{effect}" for effect in ("offset", "deadband", "delay")),
        *(f"sensor.{output.name}:{effect}" for effect in ("bias", "delay") for output in OUTPUTS),
    ),
    nominal_effects=("joint:viscous", "joint:coulomb"),
    typical=TYPICAL,
    exact=("armature", "proportional_gain", "voltage_limit"),
    contract={"joint_inertia": "inertia", "joint_coulomb": "coulomb", "joint_viscous": "viscous"},
    sizes=sizes,
    rivals=single_joint.RIVALS,
    twins=single_joint.twins,
    causes=OF_JOINTS,
    session=servo_session,
    sample_times=(0.01, 0.005),
    duration=6.0,
    coarse_step=5e-4,
    fine_step=1e-4,
    mechanics=ServoPendulum,
)

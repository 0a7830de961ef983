"""Two inertias on an elastic cable:

J_m qm'' = tau - friction_m - f/N              tau = u(t - delay) (1 + gain_error) + offset
J_l ql'' = f - friction_l - friction_contact - g sin ql + known          (load_offset is a constant part of `known`)
f = k deadzone(qm/N - ql, backlash/2) + c d/dt(qm/N - ql), c only while a flank touches
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tendonlab.blind.description import Array, Lanes, Mechanics, Output, Push, Scene, Slot, System
from tendonlab.blind.excitation import session
from tendonlab.blind.unknown import OF_JOINTS, creep

from .effects import FRICTION, position_loop

OUTPUTS = (
    Output("motor_angle", "qm", "rad", "%.6f", 2e-4, 8e-4, 0.995, 2 * np.pi / 16384),
    Output("joint_angle", "ql", "rad", "%.7f", 3e-4, 3e-4, 0.99, 2 * np.pi / 32768),
    Output("cable_torque", "fc", "N*m", "%.4f", 0.012, 0.012, 0.97, 0.002),
)
SLOTS = (Slot("motor", 10.0, 0.1), Slot("joint", 1.0, 1.0))
TYPICAL = {  # SI, joint side where not a motor's
    "motor_inertia": 1.2e-4,
    "joint_inertia": 0.02,
    "gear_ratio": 10.0,
    "cable_stiffness": 50.0,
    "cable_damping": 0.05,
    "gravity_torque": 1.1,
    "motor_viscous": 2e-4,
    "motor_coulomb": 3e-3,
    "joint_viscous": 0.02,
    "joint_coulomb": 0.05,
}
RIVALS = {
    "sensor.motor_angle:bias": ("sensor.joint_angle:bias",),
    "sensor.joint_angle:bias": ("sensor.motor_angle:bias",),
    "actuation:offset": ("load:offset", "motor:asymmetry"),
    "motor:asymmetry": ("actuation:offset", "joint:asymmetry"),
    "joint:asymmetry": ("load:offset", "motor:asymmetry"),
    "actuation:delay": ("sensor.motor_angle:delay",),
    "sensor.motor_angle:delay": ("actuation:delay",),
    "motor:load_dependence": ("contact:load_dependence", "joint:load_dependence"),
    "joint:load_dependence": ("contact:load_dependence", "motor:load_dependence"),
    "contact:load_dependence": ("joint:load_dependence", "motor:load_dependence"),
    "motor:stribeck": ("joint:stribeck",),
    "joint:stribeck": ("motor:stribeck",),
    "motor:presliding": ("joint:presliding",),
    "joint:presliding": ("motor:presliding",),
}


def sizes(_: Mapping[str, float]) -> dict[str, float]:
    delays = {f"sensor.{output.name}:delay": 0.002 for output in OUTPUTS}
    return delays | {
        "cable:backlash": 0.01,
        "load:offset": 0.1,
        "actuation:offset": 0.01,
        "actuation:gain_error": 0.08,
        "actuation:delay": 0.002,
        "sensor.motor_angle:bias": 0.03,
        "sensor.joint_angle:bias": 0.01,
        "sensor.cable_torque:bias": 0.05,
    }


def reflected_inertia(truth: Mapping[str, float]) -> float:
    """Inertia that the motor moves, kg*m^2, the cable taken as rigid."""
    return truth["motor_inertia"] + truth["joint_inertia"] / truth["gear_ratio"] ** 2


class TwoInertia(Mechanics):
    """The bodies of n lanes: row 0 the motor, row 1 the joint."""

    def __init__(self, lanes: Lanes, step: float) -> None:
        self.lanes, self.step = lanes, step
        self.inertia = np.stack([lanes.get("motor_inertia"), lanes.get("joint_inertia")])
        self.per_ratio = 1.0 / lanes.get("gear_ratio")
        self.stiffness, self.damping = lanes.get("cable_stiffness"), lanes.get("cable_damping")
        self.gravity, self.half_gap = lanes.get("gravity_torque"), lanes.get("cable_backlash") / 2.0
        self.pull = lanes.get("load_offset")
        self.rounded = lanes.form != 0
        self.creep_share, time = lanes.get("creep"), lanes.get("creep_time")
        self.creep_time = np.where(time > 0, time, 1.0)
        self.crept: Array | None = None

    def rest(self, scene: Scene) -> Array:
        """Static equilibrium under the controller's first reference, frictionless; zeros without a controller."""
        lanes, state = self.lanes, np.zeros((4, self.lanes.size))
        if scene.controller is None:
            return state
        ratio, torque = lanes.get("gear_ratio"), np.zeros(lanes.size)
        for _ in range(30):  # contracts by about g/(kp N^2) + g/k, some 5 % a turn
            wanted = (torque / ratio - lanes.get("actuation_offset")) / (1.0 + lanes.get("actuation_gain_error"))
            state[0] = scene.reference[0] - lanes.get("sensor.motor_angle_bias") - wanted / scene.controller.kp
            slack = np.sign(torque) * lanes.get("cable_backlash") / 2.0
            state[1] = state[0] / ratio - torque / self.stiffness - slack
            torque = 0.7 * (self.gravity * np.sin(state[1]) - self.pull) + 0.3 * torque
        return state

    def _cable(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Cable torque at the joint, N*m, and the rate of its stretch, rad/s."""
        stretch, rate = q[0] * self.per_ratio - q[1], v[0] * self.per_ratio - v[1]
        if self.crept is not None:
            stretch = stretch - self.crept
        if not self.half_gap.any():
            return self.stiffness * stretch + self.damping * rate, rate
        gap = np.where(self.half_gap > 0, self.half_gap, 1.0)
        sharp = stretch - np.clip(stretch, -self.half_gap, self.half_gap)
        touches = np.where(self.half_gap > 0, sharp != 0.0, True).astype(float)
        bend = np.where(self.half_gap > 0, np.tanh(stretch / gap), 0.0)
        soft, slope = stretch - self.half_gap * bend, np.where(self.half_gap > 0, bend * bend, 1.0)
        sharp, touches = np.where(self.rounded, soft, sharp), np.where(self.rounded, slope, touches)
        return self.stiffness * sharp + self.damping * touches * rate, rate

    def _creep(self, stretch: Array) -> None:
        before = self.creep_share * stretch if self.crept is None else self.crept  # starts settled
        self.crept = creep(before, stretch, share=self.creep_share, time=self.creep_time, step=self.step)

    def push(self, q: Array, v: Array, drive: Array, known: Array | None) -> Push:
        if self.creep_share.any():
            self._creep(q[0] * self.per_ratio - q[1])
        cable, rate = self._cable(q, v)
        weight = self.gravity * np.sin(q[1]) - self.pull
        if known is not None:
            weight = weight - known
        force = np.empty_like(v)
        np.multiply(cable, self.per_ratio, out=force[0])
        np.subtract(drive, force[0], out=force[0])
        np.subtract(cable, weight, out=force[1])
        return Push(force, drive, cable, rate, weight)

    def load(self, push: Push) -> Array:
        return np.stack([push.drive, 0.5 * (push.cable + push.weight)])

    def measure(self, q: Array, v: Array) -> list[Array]:
        return [q[0], q[1], self._cable(q, v)[0]]

    def within(self, q: Array, old: Array, new: Array, push: Push) -> tuple[list[Array], list[Array]]:
        slopes = [old[0], old[1], self.stiffness * push.rate]
        return [q[0], q[1], push.cable], [self.step * slope for slope in slopes]


TWO_INERTIA = System(
    kind="two_inertia",
    title="Synthetic two-inertia cable rig under a sampled position loop",
    slots=SLOTS,
    outputs=OUTPUTS,
    optional=("cable_torque", 0.2, ("sensor.cable_torque:bias", "sensor.cable_torque:delay", "actuation:gain_error")),
    effects=(
        *(f"{slot.name}:{effect}" for effect in FRICTION for slot in SLOTS),
        "contact:load_dependence",
        "cable:backlash",
        *(f"actuation:{effect}" for effect in ("offset", "gain_error", "delay")),
        *(f"sensor.{output.name}:{effect}" for effect in ("bias", "delay") for output in OUTPUTS),
    ),
    nominal_effects=("motor:viscous", "motor:coulomb", "joint:viscous", "joint:coulomb"),
    typical=TYPICAL,
    exact=("gear_ratio",),
    contract={},
    sizes=sizes,
    rivals=RIVALS,
    causes=(*OF_JOINTS, "creep"),
    loop=lambda truth, draw: position_loop(draw, inertia=reflected_inertia(truth), bandwidth=(32.0, 45.0), limit=0.8),
    turns="gear_ratio",
    session=session,
    reference="reference_angle",
    sample_times=(0.002,),
    duration=4.0,
    coarse_step=2e-4,
    fine_step=2e-5,
    mechanics=TwoInertia,
)

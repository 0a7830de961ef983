"""The force display of fig. 6: a proxy that stays outside the virtual object pulls the handle by a spring and a damper,
friction and texture act along the surface, and feed-forward carries the force through the transmission (S1 eq. 23)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from tendonlab.mechanics.tendons import TendonTransmission
from tendonlab.papers.s1.arm import Arm
from tendonlab.papers.s1.compensation import FeedForward


@dataclass(frozen=True, kw_only=True)
class Wall:
    """A plane that the handle may not pass [reconstructed]. `normal` points to the free side, `offset` m along it.
    `stiffness` K_st N/m and `damping` K_d N·s/m pull to the proxy. `friction`: force along the surface per normal
    force, 1, smoothed over `friction_speed` m/s. `texture`: N per N of normal force, a wave of `texture_length` m along
    the surface. Source: S1 eq. 23."""

    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
    offset: float = -0.27
    stiffness: float = 1500.0
    damping: float = 8.0
    friction: float = 0.3
    friction_speed: float = 0.01
    texture: float = 0.15
    texture_length: float = 0.02

    def proxy(self, position: np.ndarray) -> np.ndarray:
        """The nearest point to the handle outside the object (3,), m: X_god."""
        n = np.asarray(self.normal)
        return np.asarray(position + max(0.0, self.offset - float(position @ n)) * n)

    def surface_force(
        self, position: np.ndarray, velocity: np.ndarray, pressed: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Friction F_fr and texture F_T (3,), N, where the object is `pressed` with so many N."""
        n = np.asarray(self.normal)
        along = velocity - (velocity @ n) * n
        speed = float(np.linalg.norm(along))
        direction = along / speed if speed > 0 else np.zeros(3)
        phase = 2 * np.pi * float(position @ _tangent(n)) / self.texture_length
        friction = -self.friction * pressed * np.tanh(speed / self.friction_speed) * direction
        return friction, self.texture * pressed * np.sin(phase) * n


def _tangent(normal: np.ndarray) -> np.ndarray:
    """A unit vector along the surface: forwards (x) as far as the surface allows."""
    along = np.array([1.0, 0.0, 0.0]) - normal[0] * normal
    return np.asarray(along / np.linalg.norm(along))


@dataclass(frozen=True, kw_only=True)
class Hand:
    """The user: a spring and damper that lead the handle to where the user wants it [reconstructed]."""

    stiffness: float = 600.0  # N/m
    damping: float = 30.0  # N·s/m

    def target(self, time: float) -> np.ndarray:
        """Where the user wants the handle (3,), m: down on the object in half a second, then to and fro along it."""
        down = 0.05 * min(time / 0.5, 1.0)
        along = np.sin(2 * np.pi * 0.5 * max(time - 0.7, 0.0))
        return np.array([0.294 + 0.04 * along, 0.03 * along, -0.24 - down])

    def force(self, time: float, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Force of the hand on the handle (3,), N."""
        ahead = (self.target(time + 1e-4) - self.target(time - 1e-4)) / 2e-4
        return np.asarray(self.stiffness * (self.target(time) - position) + self.damping * (ahead - velocity))


@dataclass(frozen=True, kw_only=True)
class ForceDisplay:
    """The loop of fig. 6 on the example device. At each `control_time`, s: joint angles from motor angles (direct
    kinematics), the handle and the proxy, the force to display, gravity and feed-forward of the losses, motor torques.
    In between the device, with all its losses, moves in `substeps` steps. `inertia` (4,), kg·m² [reconstructed], stands
    for that of the arm. Velocities come from a filtered derivative with `filter_time`, s. `sign_velocity`, m/s, smooths
    the sign of the device's branch velocities so that these steps need not find where it sticks."""

    device: TendonTransmission
    compensator: FeedForward
    arm: Arm = field(default_factory=Arm)
    wall: Wall = field(default_factory=Wall)
    hand: Hand = field(default_factory=Hand)
    inertia: tuple[float, ...] = (0.25, 0.25, 0.05, 0.08)
    start: tuple[float, ...] = (0.0, 0.0, 0.0, 0.2)
    control_time: float = 1e-3
    substeps: int = 4
    filter_time: float = 4e-3
    sign_velocity: float = 0.01

    def run(self, *, duration: float = 3.0) -> pd.DataFrame:
        """Indexed by time, s: handle `x`, `y`, `z`, m; `displayed_…` and `felt_…`, force of the device on the hand
        along the axes, N; `depth` behind the surface, m."""
        q, v, filtered = np.array(self.start), np.zeros(4), np.zeros(4)
        before = self.device.kinematics.joint_to_motor(q)
        rows = []
        for time in self.control_time * np.arange(round(duration / self.control_time)):
            motor = self.device.kinematics.joint_to_motor(q)
            rate = (motor - before) / self.control_time
            filtered += (rate - filtered) * self.control_time / (self.filter_time + self.control_time)
            before = motor
            command, wanted = self.command(motor, filtered)
            at, jacobian = self.arm.pose(q)
            q, v, felt = self._move(time, q, v, at, jacobian, command)
            rows.append([time, *at, *wanted, *felt])
        columns = ["t", "x", "y", "z", *(f"{name}_{axis}" for name in ("displayed", "felt") for axis in "xyz")]
        frame = pd.DataFrame(rows, columns=columns).set_index("t")
        height = frame[["x", "y", "z"]].to_numpy() @ np.asarray(self.wall.normal)
        return frame.assign(depth=np.maximum(0.0, self.wall.offset - height))

    def command(self, motor_angle: np.ndarray, motor_velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """One pass through the blocks of fig. 6: motor torques (4,), N·m, and the force F_d to display (3,), N."""
        joint, velocity = self.device.kinematics.motor_to_joint(np.stack([motor_angle, motor_velocity]))
        position, jacobian = self.arm.pose(joint)
        force = self.display_force(position, jacobian @ velocity)
        return self.compensator.motor_torque(joint, velocity, displayed=jacobian.T @ force), force

    def display_force(self, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """F_d (3,), N, at the handle's position, m, and filtered velocity, m/s. Source: S1 eq. 23."""
        n, gap = np.asarray(self.wall.normal), self.wall.proxy(position) - position
        if not np.any(gap):
            return np.zeros(3)
        approach = -(velocity @ n) * n  # the proxy slides along with the handle, so only the normal part is damped
        pull = self.wall.stiffness * gap + self.wall.damping * approach
        pressed = max(0.0, float(pull @ n))
        friction, texture = self.wall.surface_force(position, velocity, pressed)
        return np.asarray(pressed * n + friction + texture)

    def _move(
        self,
        time: float,
        q: np.ndarray,
        v: np.ndarray,
        position: np.ndarray,
        jacobian: np.ndarray,
        command: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The device and the hand over one period of control; also the mean force of the device on the hand."""
        h, load, felt = self.control_time / self.substeps, self.compensator.gravity(q), np.zeros(3)
        for s in range(self.substeps):
            given = self.device.statics.direct(command, v, sign_velocity=self.sign_velocity).torque
            hand = self.hand.force(time + s * h, position, jacobian @ v)
            v = v + h * (given - load + jacobian.T @ hand) / np.asarray(self.inertia)
            q, position = q + h * v, position + h * jacobian @ v
            felt -= hand / self.substeps
        return q, v, felt

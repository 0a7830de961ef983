"""Feed-forward of the identified losses, and the torque that a user needs to move the device (S1 sec. IV, fig. 7)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from tendonlab.arguments import positive
from tendonlab.errors import ParameterError
from tendonlab.mechanics.tendons import Model, Propagation, TendonTransmission
from tendonlab.papers.s1.device import gravity

AMPLITUDE = np.array([0.5, 0.35, 0.4, 0.5])  # rad [reconstructed]
FREQUENCY = np.array([0.25, 0.2, 0.3, 0.35])  # Hz [reconstructed]
Torque = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True, kw_only=True)
class Trajectory:
    """Prescribed motion: `time` (m,), s; `joint_angle`, rad, and `joint_velocity`, rad/s, (m, n)."""

    time: np.ndarray
    joint_angle: np.ndarray
    joint_velocity: np.ndarray


def free_motion(*, duration: float = 12.0, sample_time: float = 0.002) -> Trajectory:
    """Sinusoids in all four joints [reconstructed]; S1 shows a free motion without saying which."""
    positive("duration", duration, "s"), positive("sample_time", sample_time, "s")
    time = sample_time * np.arange(round(duration / sample_time))
    phase = 2 * np.pi * FREQUENCY * time[:, None]
    velocity = AMPLITUDE * 2 * np.pi * FREQUENCY * np.cos(phase)
    return Trajectory(time=time, joint_angle=AMPLITUDE * np.sin(phase), joint_velocity=velocity)


@dataclass(frozen=True, kw_only=True)
class FeedForward:
    """Motor torques that hold gravity, and what else is asked for, against the losses as far as they are known.

    `transmission`: the identified one. `sign_velocity`, m/s: the sign of a branch's velocity is tanh(S'/sign_velocity),
    which does not chatter at rest. `scale_constant`: static friction cannot be compensated from rest with position
    sensors, hence 0.8 [reconstructed]; `scale_viscous`. The tension-proportional loss is left out, as in S1 eq. 12,
    unless `with_tension_loss`. Source: S1 sec. IV-B and fig. 4."""

    transmission: TendonTransmission
    gravity: Torque = gravity
    sign_velocity: float = 0.002
    scale_constant: float = 0.8
    scale_viscous: float = 1.0
    with_tension_loss: bool = False
    scaled: TendonTransmission = field(init=False, repr=False)

    def __post_init__(self) -> None:
        of = self.transmission.losses.scaled(constant=self.scale_constant, viscous=self.scale_viscous)
        object.__setattr__(self, "scaled", replace(self.transmission, losses=of))

    def motor_torque(
        self, joint_angle: np.ndarray, joint_velocity: np.ndarray, *, displayed: np.ndarray | float = 0.0
    ) -> np.ndarray:
        """Motor torques (…, n), N·m, at angles, rad, and velocities, rad/s; `displayed`: joint torque to give beside
        gravity, N·m."""
        model: Model = "full" if self.with_tension_loss else "eq12"
        wanted = self.gravity(joint_angle) + displayed
        statics = self.scaled.statics
        return statics.inverse(wanted, joint_velocity, model=model, sign_velocity=self.sign_velocity).torque


@dataclass(frozen=True, kw_only=True)
class FreeMotion:
    """Effort of the user. `without`, `compensated` (m, n): torque that the user gives to each joint, N·m, with gravity
    alone held by the motors and with feed-forward."""

    trajectory: Trajectory
    without: np.ndarray
    compensated: np.ndarray

    @property
    def power(self) -> np.ndarray:
        """Power that the user gives while compensated (m,), W; negative: the device drives the user."""
        return np.asarray(np.sum(self.compensated * self.trajectory.joint_velocity, axis=-1))

    @property
    def active_share(self) -> float:
        """Share of the samples in which the device drives the user: above 0 the losses are over-compensated."""
        return float(np.mean(self.power < 0))

    @property
    def table(self) -> pd.DataFrame:
        """RMS torques, N·m, and the reduction, 1, one row per joint. Read `active_share` with it: a reduction alone
        rewards over-compensation."""
        rms = {name: np.sqrt(np.mean(np.square(of), axis=0)) for name, of in self._both.items()}
        joints = pd.Index(range(1, len(rms["without"]) + 1), name="joint")
        return pd.DataFrame({**rms, "reduction": 1 - rms["compensated"] / rms["without"]}, index=joints)

    @property
    def _both(self) -> dict[str, np.ndarray]:
        return {"without": self.without, "compensated": self.compensated}


def user_torque(device: TendonTransmission, motor_torque: np.ndarray, at: Trajectory, needed: np.ndarray) -> np.ndarray:
    """Torque of the user (m, n), N·m: `needed` at the joints minus the torque of the transmissions. The paper's fig. 7
    leaves open which torque it shows; this is the reconstruction used here. Source: S1 fig. 7."""
    given: Propagation = device.statics.direct(motor_torque, at.joint_velocity)
    return np.asarray(needed - given.torque)


def evaluate_free_motion(
    device: TendonTransmission, compensator: FeedForward, trajectory: Trajectory | None = None
) -> FreeMotion:
    """Move `device` along `trajectory` (default `free_motion`), with and without `compensator`. Without it the motors
    hold gravity as if nothing were lost. Inertia is left out [reconstructed]. Source: S1 sec. IV-C, fig. 7."""
    at = free_motion() if trajectory is None else trajectory
    if at.joint_angle.shape[-1] != device.num_joints:
        raise ParameterError(f"trajectory of {at.joint_angle.shape[-1]} joints: expected {device.num_joints}")
    needed = compensator.gravity(at.joint_angle)
    plain = device.statics.inverse(needed, at.joint_velocity, model="ideal").torque
    helped = compensator.motor_torque(at.joint_angle, at.joint_velocity)
    torques = (user_torque(device, motor, at, needed) for motor in (plain, helped))
    without, compensated = torques
    return FreeMotion(trajectory=at, without=without, compensated=compensated)

"""Differential kinematics of the arm that the transmissions move (S1 eq. 22). RECONSTRUCTED: a shoulder of three axes
that meet in a point and an elbow; lengths and directions of the axes are chosen here."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tendonlab.errors import ParameterError


@dataclass(frozen=True, kw_only=True)
class Arm:
    """Four revolute joints: abduction about x, flexion about y, rotation about the upper arm, then the elbow about -y.
    At 0 the upper arm hangs down (-z) and the forearm points forwards (x). Lengths in m, to the elbow and from there to
    the handle. Raises ParameterError."""

    upper_arm: float = 0.30
    forearm: float = 0.30

    def __post_init__(self) -> None:
        for name in ("upper_arm", "forearm"):
            if not getattr(self, name) > 0:
                raise ParameterError(f"{name} = {getattr(self, name)}: expected a length above 0, m")

    def position(self, joint_angle: ArrayLike) -> np.ndarray:
        """Position of the handle (…, 3), m, from the shoulder, at joint angles (…, 4), rad."""
        return self.pose(joint_angle)[0]

    def jacobian(self, joint_angle: ArrayLike) -> np.ndarray:
        """J (…, 3, 4), m: velocity of the handle is J times the joint velocities, joint torques are its transpose times
        a force at the handle. Source: S1 eq. 22."""
        return self.pose(joint_angle)[1]

    def pose(self, joint_angle: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Position and Jacobian at once."""
        q = np.asarray(joint_angle, dtype=float)
        if q.ndim < 1 or q.shape[-1] != 4:
            raise ParameterError(f"joint_angle of shape {q.shape}: expected (…, 4)")
        turned, axes = np.broadcast_to(np.eye(3), (*q.shape[:-1], 3, 3)), []
        for k, direction in enumerate(_AXES):
            axes.append(turned @ direction)
            turned = turned @ _rotation(direction, q[..., k])
            if k == 2:
                elbow = turned @ np.array([0.0, 0.0, -self.upper_arm])
        forearm = turned @ np.array([self.forearm, 0.0, 0.0])
        handle = elbow + forearm
        arms = np.stack([handle, handle, handle, forearm], axis=-2)  # from a point on each axis to the handle
        return handle, np.swapaxes(np.cross(np.stack(axes, axis=-2), arms), -1, -2)


_AXES = (np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0]), np.array([0.0, -1.0, 0.0]))


def _rotation(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Rotation matrices (…, 3, 3) about a unit axis (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angle)[..., None, None], np.cos(angle)[..., None, None]
    return np.asarray(np.eye(3) + sine * cross + (1 - cosine) * cross @ cross)

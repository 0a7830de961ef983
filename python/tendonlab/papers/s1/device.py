"""The example device: four coupled transmissions with reducers in joints 1, 2 and 4. RECONSTRUCTED: the paper prints no
radii, ratios or coefficients, and none of these numbers was measured."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from tendonlab.arguments import whole
from tendonlab.errors import ParameterError
from tendonlab.mechanics.tendons import BranchLosses, Reducer, TendonTransmission
from tendonlab.papers.tables import table

NUM_JOINTS = 4
LOAD_LEVELS = (0.2, 1.0, 5.0)  # of gravity [reconstructed]


def example_device(*, reducers: bool = True) -> TendonTransmission:
    """The example device [reconstructed]; without `reducers` their ratios stay in the radii and nothing is lost there.
    Source: S1 sec. IV for what is where."""
    rows = table("S1_example_device")
    radius, losses = _triangle(rows, "r", "joint ", 1), {name: _triangle(rows, name, "link ", 0) for name in _LOSSES}
    motor, ratio, efficiency = (_column(rows, name) for name in ("r_m", "kappa", "eta_d"))
    fitted = [
        Reducer(efficiency=float(e), ratio=float(k)) if e < 1 else None for e, k in zip(efficiency, ratio, strict=True)
    ]
    return TendonTransmission(
        radius=radius,
        motor_radius=motor,
        losses=BranchLosses(constant=losses["tau0"], tension=losses["beta"], viscous=losses["nu"]),
        reducers=fitted if reducers else (),
    )


def first_joints(device: TendonTransmission, num_joints: int) -> TendonTransmission:
    """The first `num_joints` transmissions alone, as the paper's figures of three joints show them."""
    if (n := whole("num_joints", num_joints, 1)) > device.num_joints:
        raise ParameterError(f"num_joints = {n}: expected 1 to {device.num_joints}, as many as the device has")
    kept = {name: getattr(device.losses, name)[:n, :n] for name in ("constant", "tension", "viscous")}
    return replace(
        device,
        radius=device.radius[:n, :n],
        motor_radius=device.motor_radius[:n],
        losses=BranchLosses(**kept),
        reducers=device.reducers[:n],
        motor_reducers=device.motor_reducers[:n],
    )


def without_tension_loss(device: TendonTransmission) -> TendonTransmission:
    """The same device without loss in proportion to tension, as an identification of (12) sees it."""
    return replace(device, losses=device.losses.scaled(tension=0.0))


def gravity(joint_angle: np.ndarray) -> np.ndarray:
    """Gravity torque that the transmissions must hold (…, 4), N·m [reconstructed]."""
    q = np.asarray(joint_angle, dtype=float)
    turned = np.stack([np.sin(q[..., 0]), np.cos(q[..., 1]), np.sin(q[..., 2]), np.cos(q[..., 3])], axis=-1)
    return np.asarray(turned * GRAVITY)


GRAVITY = np.array([6.0, 4.0, 0.8, 1.5])  # N·m [reconstructed]
_LOSSES = ("tau0", "beta", "nu")


def _column(rows: pd.DataFrame, name: str) -> np.ndarray:
    return rows[rows["parameter"] == name].sort_values("transmission")["value"].to_numpy(dtype=float)


def _triangle(rows: pd.DataFrame, name: str, prefix: str, first: int) -> np.ndarray:
    values = np.zeros((NUM_JOINTS, NUM_JOINTS))
    chosen = rows[rows["parameter"] == name]
    column = chosen["index"].str.removeprefix(prefix).astype(int) - first
    values[chosen["transmission"] - 1, column] = chosen["value"]
    return values

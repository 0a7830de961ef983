"""The paper's forward model (S3 eq. 18-21): input torque and velocity to output torque, with a memory at low speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.arguments import samples, within
from tendonlab.errors import ParameterError
from tendonlab.papers.s3.rig import FrictionParameters, Rig, assumed_rig
from tendonlab.papers.s3.shapes import BumpShape
from tendonlab.papers.s3.statics import sheaths
from tendonlab.procedures.sheath_shape import Shape

if TYPE_CHECKING:
    import pandas as pd

GATE_PERIOD = 1e-3  # s, of the paper's control loop: the sample period that its gate of eq. 21 means


@dataclass(frozen=True, eq=False)
class Prediction:
    """tau_out, N·m, the gate h of eq. 20, and the friction coefficient of eq. 19, each (n,)."""

    tau_out: np.ndarray
    gate: np.ndarray
    mu: np.ndarray

    @property
    def jumps(self) -> np.ndarray:
        """By how much the output starts to move where the gate opens, N·m: a rig, whose velocity and torque are
        linked, has no such jumps, so they measure how far the gate is from one."""
        opens = np.flatnonzero((self.gate[1:] >= 0.5) & (self.gate[:-1] < 0.5)) + 1
        return np.asarray(np.abs(self.tau_out[opens] - self.tau_out[opens - 1]))


def predict(
    tau_in: np.ndarray,
    v: np.ndarray,
    *,
    shape: Shape | BumpShape,
    T_s: float,
    p: FrictionParameters,
    dt: float,
    y0: float = 0.0,
    rig: Rig | None = None,
    velocity_unit: str = "deg/s",
    gate_period: float = GATE_PERIOD,
    pretension_profile: str = "decaying",
    release: float = 1.0,
) -> Prediction:
    """Output torque of the pair under `tau_in`, N·m, (n,), and velocity `v` of motor A in `velocity_unit`, (n,).

    `shape` of the sheaths, `T_s` N per cable, `p` the friction law, `dt` s between samples, `y0` N·m the output before
    the first. `gate_period`, s: the sample period for which the gate's share of eq. 21 is meant; over another one it is
    raised to the power dt/gate_period. `release` < 1: an open gate shuts only at that share of its threshold, against
    chatter by noise of the velocity (better still, low-pass it: `tendonlab.procedures.lowpass`).
    Raises ParameterError for unequal lengths or numbers out of their bounds."""
    if not (dt > 0 and gate_period > 0):
        raise ParameterError(f"dt = {dt}, gate_period = {gate_period}: expected positive periods, s")
    rig = assumed_rig() if rig is None else rig
    law = p.in_unit(velocity_unit)
    run = sheaths(shape, T_s, rig.r_in, rig.r_out, pretension_profile).transmit(
        input_torque=samples("tau_in", tau_in), velocity=samples("v", v),
        friction=[law.mu_d, law.mu_s, law.v_s, law.v_thres, law.s_v], periods=periods(dt, gate_period),
        start=within("y0", y0, -math.inf, math.inf, "N*m"), release=release,
    )  # fmt: skip
    return Prediction(run["output_torque"], run["gate"], run["friction_coefficient"])


def periods(dt: float, gate_period: float) -> float:
    """How many periods of the gate a sample takes; a whole number exactly where rounding alone keeps it from one."""
    ratio = dt / gate_period
    return float(round(ratio)) if abs(ratio - round(ratio)) < 1e-9 * ratio else ratio


def predict_log(
    log: pd.DataFrame,
    *,
    shape: Shape | BumpShape,
    T_s: float,
    p: FrictionParameters,
    y0: float = 0.0,
    rig: Rig | None = None,
    gate_period: float = GATE_PERIOD,
) -> Prediction:
    """The same for a log by time with columns `tau_in`, N·m, and `v`, deg/s, at even steps."""
    time = log.index.to_numpy(dtype=float)
    dt = float((time[-1] - time[0]) / (len(time) - 1))
    return predict(
        log["tau_in"].to_numpy(), log["v"].to_numpy(), shape=shape, T_s=T_s, p=p, dt=dt, y0=y0, rig=rig,
        gate_period=gate_period,
    )  # fmt: skip


def mean_squared_error(measured: np.ndarray, predicted: np.ndarray) -> float:
    """The paper's objective, unit of the signal squared. Raises ParameterError for rows unequal, empty or with NaN."""
    y, y_hat = samples("measured", measured), samples("predicted", predicted)
    if len(y) != len(y_hat):
        raise ParameterError(f"predicted has {len(y_hat)} samples: expected {len(y)}, as many as measured")
    return float(np.mean((y - y_hat) ** 2))

"""The experiments of S2 sections IV-B and V on twins: what logs would look like (reconstructed)."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tendonlab.arguments import positive, whole
from tendonlab.errors import ParameterError
from tendonlab.papers.s2 import equations
from tendonlab.papers.s2.trapezoids import reference
from tendonlab.papers.s2.values import Constants

TORQUE_SD, FORCE_SD = 4e-3, 1.5  # N*m, N
RAMPS = (2e-5, -5e-5, 5e-5, -1e-4, 1e-4)  # m/s, of the elongation between 200 and 500 N
LOWEST, HIGHEST = 200.0, 500.0  # N
SAMPLE_TIME = 0.01  # s


def gear_points(of: Constants, *, num_points: int = 30, fastest: float = 150.0, seed: int = 0) -> pd.DataFrame:
    """Fig. 9: mean and spread of the motor torque at set points of its speed, viscous part taken off.

    Columns speed, rad/s, torque_mean, torque_std, N*m. Range and spread are reconstructed.
    Raises ParameterError for a `fastest` speed that is not positive."""
    positive("fastest", fastest, "rad/s")
    whole("num_points", num_points, 1)
    random = np.random.default_rng(seed)
    speed = np.linspace(-fastest, fastest, num_points)
    mean = equations.gear_torque(of, speed) + TORQUE_SD * random.normal(size=num_points)
    return pd.DataFrame({"speed": speed, "torque_mean": mean, "torque_std": TORQUE_SD})


def cable_ramps(of: Constants, *, seed: int = 0) -> pd.DataFrame:
    """Fig. 10: one cable stretched and released between 200 and 500 N at three speeds, 100 Hz, by time "t", s.

    Columns elongation, m, rate, m/s, force, N."""
    random = np.random.default_rng(seed)
    reach = (HIGHEST - LOWEST) / of.K
    pieces = []
    for rate in RAMPS:
        count = int(reach / abs(rate) / SAMPLE_TIME)
        way = abs(rate) * SAMPLE_TIME * np.arange(count)
        pieces.append(np.stack([way if rate > 0 else reach - way, np.full(count, rate)]))
    elongation, rates = np.concatenate(pieces, axis=1)
    force = LOWEST + of.K * elongation + of.c * rates + FORCE_SD * random.normal(size=len(elongation))
    index = pd.Index(SAMPLE_TIME * np.arange(len(elongation)), name="t")
    return pd.DataFrame({"elongation": elongation, "rate": rates, "force": force}, index=index)


def bushing_loop(of: Constants, *, cable: int = 1, seed: int = 0, quantize: float | None = None) -> pd.DataFrame:
    """Fig. 11: the joint sweeps 0, 0.7, -0.7, 0 rad at 0.04 rad/s; 7225 samples at 100 Hz, by time "t", s.

    Columns theta, rad, velocity, rad/s, force of that cable in its bushing, N. `quantize`: resolution, N (5 on the
    rig); range, speed and noise are reconstructed. Raises ParameterError for a cable that is neither 1 nor 2."""
    if cable not in (1, 2):
        raise ParameterError(f"cable = {cable!r}: expected 1 or 2")
    random = np.random.default_rng(seed)
    sweep = reference((0.0, 0.7, -0.7, 0.0), speed=0.04, dwell=0.0, step=SAMPLE_TIME, end=72.24)
    force = equations.bushing_force(of.bushings[cable - 1], sweep.angle, sweep.velocity, of.T)
    force = force + FORCE_SD * random.normal(size=len(force))
    if quantize is not None:
        force = quantize * np.round(force / quantize)
    index = pd.Index(sweep.time, name="t")
    return pd.DataFrame({"theta": sweep.angle, "velocity": sweep.velocity, "force": force}, index=index)

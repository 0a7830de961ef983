"""The experiments of S2 sections IV-B and V on twins: what logs would look like (reconstructed)."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tendonlab.arguments import positive, whole
from tendonlab.errors import ParameterError
from tendonlab.papers.s2 import equations
from tendonlab.papers.s2.trapezoids import reference
from tendonlab.papers.s2.twin import PID, simulate
from tendonlab.papers.s2.values import Constants
from tendonlab.procedures import lowpass, remove_mean

TORQUE_SD, FORCE_SD = 4e-3, 1.5  # N*m, N
RAMPS = (2e-5, -5e-5, 5e-5, -1e-4, 1e-4)  # m/s, of the elongation between 200 and 500 N
LOWEST, HIGHEST = 200.0, 500.0  # N
SAMPLE_TIME = 0.01  # s
RESOLUTION, CUTOFF = 5.0, 1.0  # N, Hz: force sensors and low-pass filter, as printed
KEPT_EVERY = 50  # samples: at 2 Hz what a filter of 1 Hz leaves is nearly independent
TURN = 1.0  # s about each reversal that are left out: the filter smears the jump of the force


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


def bushing_bench(of: Constants, *, seed: int = 0, every: int = KEPT_EVERY) -> dict[int, pd.DataFrame]:
    """Fig. 11 by the whole procedure of the bench, by cable: theta, rad, velocity, rad/s, and force, N, at 2 Hz.

    `every`: of 100 samples a second, the one in so many that is kept. Behind the filter, closer ones repeat each other.

    A PID controller sweeps the twin's joint, laid flat, over 0, 0.7, -0.7, 0 rad at 0.04 rad/s. Sensors of 5 N read the
    forces at the nuts, preload, damping and friction together; all signals pass the same filter of 1 Hz; the force
    loses its mean, and a second about each reversal is left out. Joint, range, speed and gains are reconstructed."""
    random = np.random.default_rng(seed)
    plan = reference((0.0, 0.7, -0.7, 0.0), speed=0.04, dwell=0.0)
    run = simulate(of.with_(g=0.0), plan, controller=PID(), sense="hold").iloc[:: round(SAMPLE_TIME / plan.step)]
    time = run.index.to_numpy()
    apart = np.min([np.abs(time - turn) for move in plan.moves for turn in move], axis=0) > TURN

    def filtered(values: np.ndarray) -> np.ndarray:
        return lowpass(values, cutoff=CUTOFF, sample_rate=1.0 / SAMPLE_TIME)

    found = {}
    for cable in (1, 2):
        read = run[f"F_act_{cable}"].to_numpy() + FORCE_SD * random.normal(size=len(run))
        force = remove_mean(filtered(RESOLUTION * np.round(read / RESOLUTION)))
        signals = {"theta": filtered(run["theta"].to_numpy()), "velocity": filtered(run["theta_rate"].to_numpy())}
        found[cable] = pd.DataFrame({**signals, "force": force}, index=run.index)[apart].iloc[::every]
    return found


def bushing_loop(of: Constants, *, cable: int = 1, seed: int = 0, quantize: float | None = None) -> pd.DataFrame:
    """Eq. 11 and noise, without a bench: the joint sweeps 0, 0.7, -0.7, 0 rad at 0.04 rad/s; 7225 samples at 100 Hz, by
    time "t", s. A fit to it recovers the formula that made it; `bushing_bench` is the experiment of Fig. 11.

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

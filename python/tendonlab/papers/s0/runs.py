"""Runs of the bench as the twin gives them: a trapezoid of speed, the input angle, and two load cells (S0 section 2.3).

Readings are raw: with the cells' gain, offset and creep still in them. Lever, ramps, travel and noise are not printed:
reconstructed."""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy.signal import lfilter

from tendonlab.errors import ParameterError
from tendonlab.papers.s0 import twin
from tendonlab.papers.s0.bench import NUM_RUNS, SAMPLE_RATE, Configuration
from tendonlab.procedures import LoadCell, MapPoint, friction_map, map_point, reactive_torque
from tendonlab.seed import generator

LEVER = 0.06  # m, load cell to shaft axis: L of S0 eq. 6, whose value is not printed
TRAVEL = 200.0  # rad of the input in every run: from the same position over the same cable
ACCELERATION = 500.0  # rad/s²
MOTOR_INERTIA = 1e-4  # kg·m²
REST = 0.1  # s, before and after the ramps
ANGLE_NOISE, FORCE_NOISE = 2e-4, 0.05  # rad and N, sd of a sample
CELLS = (
    LoadCell(gain=0.98, offset=0.15, creep=5e-3, creep_time=20.0),  # N per unit of the reading, its unit, 1, s
    LoadCell(gain=1.03, offset=-0.08, creep=5e-3, creep_time=20.0),
)


def trapezoid(speed: float, *, travel: float = TRAVEL) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time s, speed rad/s and acceleration rad/s² of a run at `speed` over `travel` rad, sampled at 1 kHz.

    Raises ParameterError where the ramps alone need more travel."""
    ramp = abs(speed) / ACCELERATION
    if not (speed != 0 and abs(speed) * ramp < travel):
        raise ParameterError(f"travel = {travel}: expected more than {abs(speed) * ramp} rad, which the ramps take")
    steady = travel / abs(speed) - ramp
    time = np.arange(0.0, 2 * REST + 2 * ramp + steady, 1 / SAMPLE_RATE)
    edges = REST + np.array([0.0, ramp, ramp + steady, 2 * ramp + steady])
    share = np.interp(time, edges, [0.0, 1.0, 1.0, 0.0])
    slope = np.select([(time >= edges[0]) & (time < edges[1]), (time >= edges[2]) & (time < edges[3])], [1.0, -1.0])
    return time, speed * share, np.sign(speed) * ACCELERATION * slope


def simulate_run(
    of: Configuration, *, speed: float, travel: float = TRAVEL, seed: int | np.random.Generator = 0
) -> pd.DataFrame:
    """One run of the twin at input `speed`, rad/s: indexed by time "t", s, with `input_angle` rad and the readings of
    both cells, `reading_1` and `reading_2`, N.

    The friction of a run differs from that of the next by 3 % and 1 mN·m (sd). Raises ParameterError as `trapezoid`."""
    rng = generator(seed)
    time, velocity, acceleration = trapezoid(speed, travel=travel)
    inertia = MOTOR_INERTIA + of.capstan.inertia + (of.pulley.inertia + of.external.inertia) / of.ratio() ** 2
    friction = twin.friction(of, velocity)
    friction = friction + np.sign(velocity) * twin.noise_sd(friction) * rng.normal()
    force = (inertia * acceleration + friction) / (2 * LEVER)  # one cell pulls, the other pushes: half the couple each
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time))])
    frame = {"input_angle": angle + ANGLE_NOISE * rng.normal(size=len(time))}
    for k, cell in enumerate(CELLS, start=1):
        apparent = force + _creep(time, force, cell) + FORCE_NOISE * rng.normal(size=len(time))
        frame[f"reading_{k}"] = apparent / cell.gain + cell.offset
    return pd.DataFrame(frame, index=pd.Index(time, name="t"))


def schedule(speeds: np.ndarray, *, num_runs: int, seed: int | np.random.Generator = 0) -> np.ndarray:
    """Order of the runs: each speed `num_runs` times, shape (num_runs · n,), never twice in a row (S0 section 2.3)."""
    rng = generator(seed)
    order: list[float] = []
    for _ in range(num_runs):
        turn = rng.permutation(speeds)
        while order and len(speeds) > 1 and turn[0] == order[-1]:
            turn = rng.permutation(speeds)
        order.extend(float(v) for v in turn)
    return np.array(order)


def torque_of(run: pd.DataFrame, *, cells: tuple[LoadCell, LoadCell] = CELLS) -> np.ndarray:
    """Torque of the motor, N·m, shape (n,), from the raw readings of a run (S0 eq. 6): calibrated, without creep."""
    return reactive_torque(
        run["reading_1"], run["reading_2"], lever=LEVER, calibration=cells, time=run.index.to_numpy(dtype=float)
    )


def point_of(run: pd.DataFrame) -> MapPoint:
    """The map point of a run: speed and mean torque of its steady part."""
    return map_point(run.index.to_numpy(dtype=float), run["input_angle"].to_numpy(), torque_of(run))


def bench_map(
    of: Configuration,
    speeds: np.ndarray,
    *,
    num_runs: int = NUM_RUNS,
    travel: float = TRAVEL,
    seed: int | np.random.Generator = 0,
) -> pd.DataFrame:
    """The friction map of a configuration by `num_runs` runs of the bench at each of `speeds`, rad/s of the input, both
    signs: every run through its cells, its denoised angle and its steady part. Columns as `friction_map` has them.

    Raises ParameterError as `trapezoid`."""
    rng = generator(seed)
    order = schedule(np.asarray(speeds, dtype=float), num_runs=num_runs, seed=rng)
    runs = (simulate_run(of, speed=float(v), travel=travel, seed=rng) for v in order)
    return friction_map([point_of(run) for run in runs])


def _creep(time: np.ndarray, force: np.ndarray, cell: LoadCell) -> np.ndarray:
    """Creep of a cell, N: a first-order lag of a small share of the force."""
    share = (time[1] - time[0]) / cell.creep_time
    decay = np.exp(-share)
    late = 1 - (1 - decay) / share  # of the later of two samples that a straight line joins
    return np.asarray(cell.creep * lfilter([late, 1 - decay - late], [1.0, -decay], force))

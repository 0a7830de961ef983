"""The twin of S0's bench, reconstructed: friction of four loads whose static LuGre fit is S0 Tables 6 and 7, whose
peaks are the measured ones of Table 8, and whose features lie where the text has them. It shares no law with the
library. Nothing here was measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from tendonlab.arguments import whole
from tendonlab.errors import ParameterError
from tendonlab.papers.s0.bearings import relative_load
from tendonlab.papers.s0.bench import Configuration, loaded
from tendonlab.papers.tables import table
from tendonlab.seed import generator

SPEEDS = np.concatenate([[1.0], np.arange(5.0, 106.0, 5.0)])  # rad/s, of the input; reconstructed grid
PARALLEL_BUMP = 0.93  # peak of the parallel threading over the crossed one; reconstructed
RELATIVE_NOISE, ABSOLUTE_NOISE = 0.03, 1e-3  # 1 and N·m, sd of a run's mean torque; reconstructed
_PEAKS = {("C35P75GX", "D"): 17.25, ("C35P75GX", "D2M"): 16.25, ("C35P75GX", "D4M"): 16.25}
_PEAK_OF_C25 = 16.1


@dataclass(frozen=True, kw_only=True)
class TwinParameters:
    """What the twin's friction is made of: T_b, t_1 N·m (base, and its rise with load), omega_r, omega_d rad/s, v
    N·m·s/rad, n and q 1."""

    T_b: float
    t_1: float
    omega_r: float
    n: float
    v: float
    omega_d: float
    q: float


@cache
def parameters(transmission: str) -> TwinParameters:
    """The reconstructed parameters of a transmission; both threadings share them except for the bump."""
    rows = table("S0_reconstructed_parameters")
    crossed = transmission.replace("GP", "GX")
    of = rows[(rows["transmission"] == crossed) & (rows["set"] == "twin")].set_index("symbol")["value"]
    if of.empty:
        raise ParameterError(f"transmission = {transmission!r}: the twin has {', '.join(sorted(set(rows.iloc[:, 0])))}")
    return TwinParameters(**{str(symbol): float(value) for symbol, value in of.items()})


def peak_speed(transmission: str, load: str) -> float:
    """Input speed of the friction peak, rad/s: where the printed LuGre values of S0 Table 8 put it."""
    return _PEAKS.get((transmission, load), _PEAK_OF_C25)


def measured_peak(transmission: str, load: str) -> float:
    """Peak torque as S0 Table 8 has it, N·m, of a crossed threading with a disc."""
    of = table("S0_table8_errors").set_index("configuration")["measured_Nm"]
    return float(of[f"{transmission}-{load}"])


def friction(of: Configuration, speed: np.ndarray | float) -> np.ndarray:
    """Friction torque of the twin, N·m, shape of `speed`, at input speed rad/s; odd in speed.

    T = [T_b + t_1 (L_r - 1)] (1 - exp(-(w/w_r)²)) + v w / (1 + (w/w_d)^q) + p (x exp(1 - x))^n, x = (w/w_p)², without
    preload; p = 0 without a disc."""
    p = parameters(of.transmission)
    w = np.abs(np.asarray(speed, dtype=float))
    torque = _base(p, relative_load(of), w)
    if of.load != "none":
        crossed = of.transmission.replace("GP", "GX")
        at_peak = peak_speed(crossed, of.load)
        bump = measured_peak(crossed, of.load) - float(_base(p, relative_load(of), np.array(at_peak)))
        x = (w / at_peak) ** 2
        torque = torque + bump * (1.0 if of.crossed else PARALLEL_BUMP) * (x * np.exp(1 - x)) ** p.n
    return np.asarray(np.sign(speed) * torque)


def proposed_friction(of: Configuration, speed: np.ndarray | float) -> np.ndarray:
    """Friction torque, N·m, of a second twin, whose friction is S0 eq. 11 itself, with the set drawn from Table 8
    (reconstructed); odd in speed. Like the first it shares no law with the library."""
    rows = table("S0_reconstructed_parameters")
    own = rows[(rows["transmission"] == of.transmission) & (rows["set"] == "table8_set")].set_index("symbol")["value"]
    if own.empty:
        raise ParameterError(f"transmission = {of.transmission!r}: Table 8 has C25P104GX and C35P75GX")
    w, load, n = np.abs(np.asarray(speed, dtype=float)), relative_load(of), of.ratio()
    level = own["F_c"] * (1 + load)
    peak = (own["F_s"] + level * w ** own["beta"]) * np.exp(-((w / own["theta_s"]) ** own["alpha"]))
    viscous = own["F_v"] * ((n**2 + 1) / n**2 * w + (w / load) ** own["gamma"])
    return np.asarray(np.sign(speed) * (level * w ** own["delta"] + peak + viscous))


def noise_sd(torque: np.ndarray | float) -> np.ndarray:
    """Sd of one run's mean torque about the map, N·m: 3 % and 1 mN·m (reconstructed)."""
    return np.asarray(RELATIVE_NOISE * np.abs(torque) + ABSOLUTE_NOISE)


def measured(
    of: Configuration,
    speed: np.ndarray,
    *,
    num_runs: int,
    seed: int | np.random.Generator = 0,
    law: Callable[[Configuration, np.ndarray], np.ndarray] = friction,
) -> tuple[np.ndarray, np.ndarray]:
    """Mean torque over `num_runs` runs at each speed, N·m, and the sd of one run, shape of `speed`. `law`: friction.

    Raises ParameterError for less than one run."""
    whole("num_runs", num_runs, 1)
    rng = generator(seed)
    true = law(of, speed)
    runs = true + noise_sd(true) * rng.normal(size=(num_runs, *np.shape(speed)))
    sd = runs.std(axis=0, ddof=1) if num_runs > 1 else noise_sd(true)
    return runs.mean(axis=0), sd


def points(transmission: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speed rad/s, relative load 1 and noiseless torque N·m of the 88 points (22 speeds, four loads) of a transmission,
    each of shape (88,), load by load."""
    of = [loaded(transmission, load) for load in ("none", "D", "D2M", "D4M")]
    speed = np.tile(SPEEDS, len(of))
    load = np.repeat([relative_load(c) for c in of], len(SPEEDS))
    return speed, load, np.concatenate([friction(c, SPEEDS) for c in of])


def _base(p: TwinParameters, load: float, w: np.ndarray) -> np.ndarray:
    level = p.T_b + p.t_1 * (load - 1)
    return np.asarray(level * (1 - np.exp(-((w / p.omega_r) ** 2))) + p.v * w / (1 + (w / p.omega_d) ** p.q))

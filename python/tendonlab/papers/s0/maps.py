"""Friction maps (S0 Figs 10 to 18): mean torque against mean speed of a configuration, and their features."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd

from tendonlab.arguments import samples
from tendonlab.errors import ParameterError
from tendonlab.papers.s0 import twin
from tendonlab.papers.s0.bearings import relative_load
from tendonlab.papers.s0.bench import LOADS, NUM_RUNS, TRANSMISSIONS, Configuration, loaded
from tendonlab.papers.tables import table

LOADED = LOADS[1:]
FINE = np.arange(1.0, 105.01, 0.25)  # rad/s, on which peaks and valleys are sought


def twin_map(
    of: Configuration,
    *,
    num_runs: int = NUM_RUNS,
    both_signs: bool = True,
    seed: int | np.random.Generator = 0,
    law: Callable[[Configuration, np.ndarray], np.ndarray] = twin.friction,
) -> pd.DataFrame:
    """The twin's friction map of a configuration: `speed` rad/s, `torque` N·m (mean of `num_runs` runs), `sd` N·m of
    one run, `num_runs`; one row per point, in order of speed. `law`: the friction of the twin.

    Raises ParameterError for less than one run."""
    speed = np.concatenate([-twin.SPEEDS[::-1], twin.SPEEDS]) if both_signs else twin.SPEEDS
    torque, sd = twin.measured(of, speed, num_runs=num_runs, seed=seed, law=law)
    return pd.DataFrame({"speed": speed, "torque": torque, "sd": sd, "num_runs": num_runs})


def features(speed: np.ndarray, torque: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Speeds of the inner local maxima and minima of a sampled curve, rad/s.

    Raises ParameterError for samples that are missing or not finite."""
    count = len(samples("speed", speed))
    if len(samples("torque", torque)) != count:
        raise ParameterError(f"torque has {len(torque)} samples: expected {count}, as many as speed")
    rise = np.diff(torque)
    peaks = (rise[:-1] > 0) & (rise[1:] <= 0)
    valleys = (rise[:-1] < 0) & (rise[1:] >= 0)
    return speed[1:-1][peaks], speed[1:-1][valleys]


def reference_points(transmission: str) -> tuple[np.ndarray, np.ndarray]:
    """Peak speeds, rad/s, and relative loads, 1, of the three loaded configurations of S0 Table 8."""
    speed = np.array([twin.peak_speed(transmission, load) for load in LOADED])
    return speed, np.array([relative_load(loaded(transmission, load)) for load in LOADED])


def printed_peaks() -> pd.DataFrame:
    """S0 Table 8 as printed, by configuration: torques N·m, errors per cent of the measured torque."""
    rows = table("S0_table8_errors").set_index("configuration")
    names = {
        "measured_Nm": "measured",
        "proposed_Nm": "proposed",
        "proposed_error_pct": "proposed_error",
        "lugre_Nm": "lugre",
        "lugre_error_pct": "lugre_error",
    }
    return rows[list(names)].rename(columns=names)


def reference_torques(transmission: str, column: str = "proposed") -> np.ndarray:
    """A column of S0 Table 8 for the three loads of a transmission, N·m."""
    return printed_peaks().loc[[loaded(transmission, load).name for load in LOADED], column].to_numpy(dtype=float)


def peak_errors(model: Callable[[Configuration, float], float]) -> pd.DataFrame:
    """S0 Table 8 for any model: `measured` and `model` torque N·m at the peak, `error` in per cent of the measured, by
    configuration. `model` gives the torque of a configuration at a speed, rad/s."""
    rows = {}
    for transmission in TRANSMISSIONS:
        for load in LOADED:
            of = loaded(transmission, load)
            measured = twin.measured_peak(transmission, load)
            found = float(model(of, twin.peak_speed(transmission, load)))
            rows[of.name] = {"measured": measured, "model": found, "error": 100 * abs(found - measured) / measured}
    return pd.DataFrame.from_dict(rows, orient="index")


def absolute_error(
    of: Configuration, model: Callable[[Configuration, np.ndarray], np.ndarray], measured: pd.DataFrame
) -> pd.Series[float]:
    """|model - map| N·m by speed rad/s (S0 Figs 20, 21, 23, 24)."""
    found = model(of, measured["speed"].to_numpy())
    return pd.Series(np.abs(found - measured["torque"].to_numpy()), index=measured["speed"])

"""Bounds from S0's own numbers: how large the preload can be, and how little bearing friction explains."""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from tendonlab.arguments import choice
from tendonlab.papers.s0.bearings import pulley_reactions, relative_load
from tendonlab.papers.s0.bench import TRANSMISSIONS, configuration, loaded
from tendonlab.papers.s0.maps import LOADED, printed_peaks

BORE_RADIUS = 0.0125  # m, of the bearing 61905
CATALOGUE_COEFFICIENT = 0.0015  # 1, friction of a deep groove ball bearing at its bore


def peaks_and_loads() -> pd.DataFrame:
    """The six loaded configurations of Table 8: `carried`, sum of the pulley's bearing reactions without preload, N,
    and the measured `peak`, N·m, in order of `carried`."""
    measured = printed_peaks()["measured"]
    rows = {
        of.name: {"carried": pulley_reactions(of).total, "peak": float(measured[of.name])}
        for of in (loaded(transmission, load) for transmission in TRANSMISSIONS for load in LOADED)
    }
    return pd.DataFrame.from_dict(rows, orient="index").sort_values("carried")


def largest_preload(transmission: str) -> float:
    """Preload of each cable side, N, above which eq. 11 could not give the paper's own proposed torques.

    No part of eq. 11 grows faster with load than 1 + L_r, so (1 + L_r) must rise from D to D4M at least as the printed
    torques do; preload, which L_r counts as well, flattens that rise. Raises ParameterError for a transmission that
    Table 8 has not."""
    choice("transmission", transmission, TRANSMISSIONS)
    torque = printed_peaks()["proposed"]
    light, heavy = loaded(transmission, "D"), loaded(transmission, "D4M")
    needed = float(torque[heavy.name] / torque[light.name])

    def surplus(pretension: float) -> float:
        top, bottom = (1 + relative_load(of, pretension=pretension) for of in (heavy, light))
        return top / bottom - needed

    return float(brentq(surplus, 0.0, 200.0))


def bearing_coefficient(transmission: str) -> float:
    """Friction coefficient at the bore, 1, that the bearings of the pulley would need to make the measured peaks rise
    with load as they do. A catalogue has 0.0015: pure bearing friction does not explain the load effect.

    Raises ParameterError for a transmission that Table 8 has not."""
    choice("transmission", transmission, TRANSMISSIONS)
    rows = peaks_and_loads()
    own = rows[rows.index.str.startswith(transmission)]
    slope = float(np.polyfit(own["carried"], own["peak"], 1)[0])  # N·m at the input per N
    return slope * configuration(transmission).ratio() / BORE_RADIUS

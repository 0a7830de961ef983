"""Friction against speed: one point per run, a map of many runs (S0 Figs. 10-18)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from tendonlab.arguments import along, times, whole, within
from tendonlab.errors import ParameterError
from tendonlab.procedures.steady import steady_segment

SAME_SPEED = 0.02  # share by which speeds of one set point may differ from one to the next


@dataclass(frozen=True)
class MapPoint:
    """A run at steady speed: `speed`, rad/s or m/s, and mean `torque`, N·m or N, both with their signs; `sd` of the
    torque's samples about their mean (ripple and noise, not the uncertainty of the mean); `num_samples` of them.

    Raises ParameterError for numbers that are not finite, a negative sd, fewer than 1 sample."""

    speed: float
    torque: float
    sd: float
    num_samples: int

    def __post_init__(self) -> None:
        within("speed", self.speed, -math.inf, math.inf, "rad/s or m/s")
        within("torque", self.torque, -math.inf, math.inf, "N·m or N")
        within("sd", self.sd, 0.0, math.inf, "N·m or N")
        whole("num_samples", self.num_samples, 1)

    def to_dict(self) -> dict[str, float]:
        """The same as plain numbers."""
        return asdict(self)


def map_point(time: ArrayLike, position: ArrayLike, torque: ArrayLike, *, segment: slice | None = None) -> MapPoint:
    """The point that one run gives: speed as slope of a straight line through the positions of the steady `segment`,
    torque as mean over it.

    `time`, s, `position`, rad or m, `torque`, N·m or N: shapes (n,). `segment`: None takes `steady_segment`.

    Raises ParameterError as `steady_segment`, and for a segment of fewer than 2 samples. Source: S0 section 2.3."""
    t = times(time)
    y, load = along(t, "position", position), along(t, "torque", torque)
    kept = steady_segment(t, y) if segment is None else segment
    if not isinstance(kept, slice):
        raise ParameterError(f"segment = {segment!r}: expected a slice of the samples or None")
    if len(t[kept]) < 2:
        raise ParameterError(f"segment = {segment}: expected at least 2 of the {len(t)} samples")
    since = t[kept] - t[kept].mean()
    speed = float(since @ (y[kept] - y[kept].mean()) / (since @ since))
    return MapPoint(speed, float(load[kept].mean()), float(load[kept].std(ddof=1)), len(since))


def friction_map(
    runs: Iterable[MapPoint] | Mapping[str, Iterable[MapPoint]], *, tolerance: float = SAME_SPEED
) -> pd.DataFrame:
    """Runs gathered by speed: one row per configuration and speed, in order of speed.

    `runs`: points of one configuration, in any order, or of several by name. Speeds belong together where each differs
    from the next by a share of at most `tolerance`; directions stay apart. Columns: `configuration` ("" where there is
    but one), `speed` and `torque` (means of the runs), `sd` (of the runs' torques about their mean; NaN for a single
    run), `sd_of_mean` = sd / sqrt(num_runs), `num_runs`. S0 takes 20 runs per point.

    Raises ParameterError: no runs, something else among them, `tolerance` not in [0, 1)."""
    within("tolerance", tolerance, 0.0, 1.0, open_upper=True)
    named = runs if isinstance(runs, Mapping) else {"": runs}
    rows = [row for name, points in named.items() for row in _rows(str(name), _points(points), tolerance)]
    if not rows:
        raise ParameterError("runs is empty: expected at least one MapPoint")
    return pd.DataFrame(rows, columns=["configuration", "speed", "torque", "sd", "sd_of_mean", "num_runs"])


def _points(runs: Iterable[MapPoint]) -> list[MapPoint]:
    points = list(runs) if isinstance(runs, Iterable) else [runs]
    if not isinstance(runs, Iterable) or not all(isinstance(point, MapPoint) for point in points):
        raise ParameterError(f"runs = {runs!r}: expected MapPoints, or MapPoints by configuration")
    return points


def _rows(name: str, points: list[MapPoint], tolerance: float) -> list[tuple[str, float, float, float, float, int]]:
    points = sorted(points, key=lambda p: p.speed)
    speed = np.array([p.speed for p in points], dtype=float)
    torque = np.array([p.torque for p in points], dtype=float)
    apart = np.diff(speed) > tolerance * np.minimum(np.abs(speed[:-1]), np.abs(speed[1:]))
    rows = []
    for group in np.split(np.arange(len(points)), np.flatnonzero(apart) + 1):
        if not group.size:
            continue
        sd = float(torque[group].std(ddof=1)) if len(group) > 1 else float("nan")
        mean_speed, mean_torque = float(speed[group].mean()), float(torque[group].mean())
        rows.append((name, mean_speed, mean_torque, sd, sd / np.sqrt(len(group)), len(group)))
    return rows

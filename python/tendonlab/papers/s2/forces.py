"""Forces at the nuts: 95 % bands and feed-forward by eq. 11, shifts of their jumps (S2 Fig. 12)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy.stats import norm

from tendonlab.papers.s2.equations import Array
from tendonlab.papers.s2.identify import bushing_law
from tendonlab.papers.s2.trapezoids import Reference
from tendonlab.papers.s2.twin import last_sense
from tendonlab.papers.s2.values import BRANCHES, Constants
from tendonlab.procedures import time_shift

JUMP = 15.0  # N, from which on a change of force is a jump


def force_band(
    branches: Mapping[str, float],
    covariance: ArrayLike,
    theta: ArrayLike,
    sense: ArrayLike,
    *,
    tension: float,
    noise_sd: float = 0.0,
    confidence: float = 0.95,
) -> tuple[Array, Array]:
    """Lower and upper edge of the band of a bushing's force, N, shape (n,), from the covariance of its eight parameters
    (order a1, a2, b11 … c2) by the delta method.

    `theta`, rad, `sense` of the motion, +1 or -1, shape (n,); `tension`: T, N; `noise_sd` of the sensor, N, widens the
    band to where a sample is expected. Source: S2 Fig. 12a, b."""
    angle, way = np.asarray(theta, dtype=float), np.asarray(sense, dtype=float)

    def force(values: Mapping[str, float]) -> Array:
        return np.asarray(bushing_law(values).force(velocity=way, wrap_angle=angle, load=tension))

    centre = force(branches)
    slopes = []
    for name in BRANCHES:
        step = 1e-6 * max(1.0, abs(branches[name]))
        up, down = ({**branches, name: branches[name] + s * step} for s in (1.0, -1.0))
        slopes.append((force(up) - force(down)) / (2.0 * step))
    jacobian = np.stack(slopes, axis=1)
    variance = np.einsum("ij,jk,ik->i", jacobian, np.asarray(covariance, dtype=float), jacobian) + noise_sd**2
    half = float(norm.ppf(0.5 + confidence / 2.0)) * np.sqrt(variance)
    return centre - half, centre + half


def covariance_of(half_widths: Mapping[str, float], *, confidence: float = 0.95) -> Array:
    """Covariance of independent parameters from half widths of their intervals, as Table II prints them."""
    quantile = float(norm.ppf(0.5 + confidence / 2.0))
    return np.asarray(np.diag([(half_widths[name] / quantile) ** 2 for name in BRANCHES]))


def feedforward(of: Constants, reference: Reference) -> pd.DataFrame:
    """Forces of both bushings that a controller may expect: eq. 11 in the sense of the *reference*, which keeps its
    last sense at rest, so that no jump is early. Columns F_a_1, F_a_2, N, by time "t", s. Source: S2 sec. V."""
    sense = last_sense(reference.velocity)
    found = {
        f"F_a_{i}": bushing_law(branches).force(velocity=sense, wrap_angle=reference.angle, load=of.T)
        for i, branches in enumerate(of.bushings, start=1)
    }
    return pd.DataFrame(found, index=pd.Index(reference.time, name="t"))


def force_shift(time: ArrayLike, simulated: ArrayLike, measured: ArrayLike, *, threshold: float = JUMP) -> pd.DataFrame:
    """T_shift of every jump of a force above `threshold`, N: `tendonlab.procedures.time_shift` with the paper's."""
    found: pd.DataFrame = time_shift(time, simulated, measured, threshold=threshold)
    return found


def shifted(reference: Reference) -> np.ndarray:
    """True from the end of each move to the start of the next, where the sense of friction is in doubt; shape (n,)."""
    time = reference.time
    ends = [end for _, end in reference.moves]
    starts = [start for start, _ in reference.moves[1:]] + [np.inf]
    return np.asarray(
        np.logical_or.reduce([(time > end) & (time <= start) for end, start in zip(ends, starts, strict=True)])
    )

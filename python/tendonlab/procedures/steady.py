"""The steady part of one run (S0: the box on the straight part of Fig. 7)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import savgol_coeffs, savgol_filter

from tendonlab.errors import ParameterError
from tendonlab.procedures.check import along, interval, positive, times, within
from tendonlab.procedures.runs import stretches, trimmed
from tendonlab.signals import white_noise_sd

FEWEST = 20  # samples of a record
WINDOW = 0.05  # share of the record over which the acceleration is taken
DRIFT = 0.1  # share of the greatest speed by which a steady speed may change, were it to last the whole record
NOISE = 5.0  # sd of noise that still count as none
MOVING = 0.1  # share of the greatest speed from which on something moves


def steady_segment(time: ArrayLike, position: ArrayLike, *, tolerance: float | None = None, trim: float = 0.1) -> slice:
    """The longest stretch of steady motion of one run: where |acceleration| stays below `tolerance`, less a share
    `trim` of its samples at each end.

    `time`, s, evenly sampled, and `position`, rad or m: shapes (n,). The acceleration comes from parabolas over 5 % of
    the record, so noise hardly matters. `tolerance` in rad/s^2 or m/s^2; None allows the greatest speed to change by a
    tenth over the whole record, and five sd of the acceleration's noise. Rest (below a tenth of the greatest speed) is
    no steady motion. For records with several speeds see `steady_averages`. S0 section 2.3; the rule is reconstructed.

    Raises ParameterError: fewer than 20 samples, uneven sampling, `tolerance` not above 0, `trim` not in [0, 0.5),
    a position that does not move or no steady stretch of at least 5 samples."""
    within("trim", trim, 0.0, 0.5, open_upper=True)
    t = times(time, fewest=FEWEST)
    y = along(t, "position", position)
    dt = interval(t)
    num = max(7, 2 * int(0.5 * WINDOW * len(t)) + 1)
    speed = np.abs(savgol_filter(y, num, 2, deriv=1, delta=dt))
    acceleration = np.abs(savgol_filter(y, num, 2, deriv=2, delta=dt))
    fastest = float(speed.max())
    if fastest * (t[-1] - t[0]) <= 1e-12 * float(np.max(np.abs(y))):
        raise ParameterError(f"position = {y[0]} throughout: expected a position that moves")
    if tolerance is None:
        noise = white_noise_sd(y) * float(np.linalg.norm(savgol_coeffs(num, 2, deriv=2, delta=dt)))
        tolerance = max(DRIFT * fastest / (t[-1] - t[0]), NOISE * noise)
    positive("tolerance", tolerance, "1/s^2 times the unit of position")
    found = stretches((acceleration < tolerance) & (speed > MOVING * fastest))
    longest = max(found, key=lambda s: s.stop - s.start, default=slice(0, 0))
    kept = trimmed(longest, trim)
    if kept.stop - kept.start < 5:
        least = float(acceleration[speed > MOVING * fastest].min())
        raise ParameterError(
            f"tolerance = {tolerance:.3g}: expected one that leaves 5 samples of steady motion; the least "
            f"|acceleration| in motion is {least:.3g}"
        )
    return kept

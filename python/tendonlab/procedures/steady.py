"""The steady part of one run (S0: the box on the straight part of Fig. 7)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import savgol_coeffs, savgol_filter

from tendonlab.arguments import along, interval, positive, times, within
from tendonlab.errors import ParameterError
from tendonlab.procedures.runs import blocks, of_samples, stretches, trimmed
from tendonlab.simulation.reading import white_noise_sd

FEWEST = 20  # samples of a record
MOST = 2000  # samples that are looked at: a longer record is averaged in blocks
WINDOW = 0.05  # share of the record over which the acceleration is taken; a steady part is no shorter
DRIFT = 0.1  # share of the greatest speed by which a steady speed may change, were it to last the whole record
NOISE = 5.0  # sd of noise that still count as none
MOVING = 0.1  # share of the greatest speed from which on something moves


def steady_segment(time: ArrayLike, position: ArrayLike, *, tolerance: float | None = None, trim: float = 0.1) -> slice:
    """The longest stretch of steady motion of one run: where |acceleration| stays below `tolerance`, less a share
    `trim` of its samples at each end.

    `time`, s, evenly sampled, and `position`, rad or m: shapes (n,). The acceleration comes from parabolas over 5 % of
    the record, so noise has little influence. `tolerance` in rad/s^2 or m/s^2; None allows the greatest speed to change
    by a tenth over the whole record, and five sd of the acceleration's noise. Rest (below a tenth of the greatest
    speed) is no steady motion. For records with several speeds see `steady_averages`. S0 section 2.3; the rule is
    reconstructed.

    Raises ParameterError: fewer than 20 samples, uneven sampling, `tolerance` not above 0, `trim` not in [0, 0.5),
    a position that does not move, or is steady for less than 5 % of the record."""
    within("trim", trim, 0.0, 0.5, open_upper=True)
    t = times(time, fewest=FEWEST)
    y = along(t, "position", position)
    if tolerance is not None:
        positive("tolerance", tolerance, "1/s^2 times the unit of position")
    size = max(1, len(t) // MOST)
    found = stretches(_steady(blocks(y, size), interval(t) * size, tolerance))
    longest = max((of_samples(s, size, len(t)) for s in found), key=lambda s: s.stop - s.start, default=slice(0, 0))
    if longest.stop - longest.start < WINDOW * len(t):
        raise ParameterError(
            f"position is steady for {longest.stop - longest.start} samples at most: expected at least {WINDOW:.0%} of "
            f"{len(t)}; a tolerance above {'the default' if tolerance is None else f'{tolerance:g}'} would find more"
        )
    return trimmed(longest, trim)


def _steady(position: np.ndarray, dt: float, tolerance: float | None) -> np.ndarray:
    """Which samples are of steady motion."""
    num = max(7, 2 * int(0.5 * WINDOW * len(position)) + 1)
    smooth, velocity, acceleration = (savgol_filter(position, num, 2, deriv=d, delta=dt) for d in range(3))
    speed, duration, noise = np.abs(velocity), dt * (len(position) - 1), white_noise_sd(position)
    rounding = 1e-12 * float(np.max(np.abs(position)))
    if np.ptp(smooth) <= max(NOISE * noise, rounding):
        raise ParameterError(f"position stays within {np.ptp(smooth):.3g} of {smooth[0]:.6g}: expected one that moves")
    if tolerance is None:
        unsure = noise * float(np.linalg.norm(savgol_coeffs(num, 2, deriv=2, delta=dt)))
        tolerance = max(DRIFT * float(speed.max()) / duration, NOISE * unsure)
    return np.asarray((np.abs(acceleration) < tolerance) & (speed > MOVING * speed.max()))

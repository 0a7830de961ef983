"""Torque and pretension from load cells (S0 eq. 5-6, S3 eq. 3)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import lfilter

from tendonlab.arguments import along, interval, positive, reals, samples, times, within
from tendonlab.errors import ParameterError

STANDARD_GRAVITY = 9.80665  # m/s^2


@dataclass(frozen=True)
class LoadCell:
    """Calibration of a load cell: force = `gain` (reading - `offset`), less its creep.

    `gain`: N per unit of the reading, not 0 (negative where the cell counts the other way). `offset`: reading without
    load. `creep`: share of a lasting load by which the reading still grows; it does so with the time constant
    `creep_time`, s: after a step of the load the reading shows 1 + creep (1 - exp(-t / creep_time)) of it. 0: no creep.
    The correction is reconstructed (S0 prints none).

    Raises ParameterError: a gain of 0, creep outside [0, 1), a time that is not above 0, values that are not finite."""

    gain: float = 1.0
    offset: float = 0.0
    creep: float = 0.0
    creep_time: float = 60.0

    def __post_init__(self) -> None:
        within("gain", self.gain, -math.inf, math.inf, "N per unit of the reading")
        if self.gain == 0.0:
            raise ParameterError("gain = 0: expected a gain other than 0")
        within("offset", self.offset, -math.inf, math.inf, "in the unit of the reading")
        within("creep", self.creep, 0.0, 1.0, open_upper=True)
        positive("creep_time", self.creep_time, "s")

    def force(self, reading: ArrayLike, *, time: ArrayLike | None = None) -> np.ndarray:
        """Force, N, shape (n,), from the readings, shape (n,).

        `time`, s, evenly sampled, is needed where `creep` is not 0; the cell was without load before the first sample.
        Raises ParameterError where it is missing or uneven, or where numbers are not finite."""
        apparent = self.gain * (samples("reading", reading) - self.offset)
        if self.creep == 0.0:
            return np.asarray(apparent)
        if time is None:
            raise ParameterError(f"time = None: expected sampling times, since creep = {self.creep} is corrected")
        t = times(time)
        return self._without_creep(along(t, "reading", apparent), interval(t))

    def _without_creep(self, apparent: np.ndarray, dt: float) -> np.ndarray:
        """apparent = force + creep x, x' = (force - x) / creep_time, x(0) = 0; exact where straight between samples."""
        rate = (1.0 + self.creep) / self.creep_time
        decay = math.exp(-rate * dt)
        whole = -math.expm1(-rate * dt) / rate  # integral of the decay over an interval
        late = (1.0 - whole / dt) / rate  # the part of it that weighs the later sample
        gains = np.array([late, whole - late]) / self.creep_time
        lagging, _ = lfilter(gains, [1.0, -decay], apparent, zi=np.array([-gains[0] * apparent[0]]))
        return np.asarray(apparent - self.creep * lagging)


def reactive_torque(
    force_1: ArrayLike,
    force_2: ArrayLike,
    *,
    lever: float,
    calibration: LoadCell | tuple[LoadCell, LoadCell] = LoadCell(),  # frozen
    time: ArrayLike | None = None,
) -> np.ndarray:
    """Motor torque, N·m, shape (n,), that the reaction of two load cells shows: (F1 + F2) lever  (S0 eq. 6).

    `force_1`, `force_2`: readings, shape (n,), both positive in the sense of the couple, in the unit that `calibration`
    expects (N by default); a pair of calibrations gives one to each cell. `lever`, m: from either cell to the shaft's
    axis (half the distance between the cells). `time`, s, only where creep is corrected.

    Raises ParameterError: unequal lengths, numbers that are not finite, a lever not above 0, creep without time."""
    positive("lever", lever, "m")
    cells = (calibration, calibration) if isinstance(calibration, LoadCell) else calibration
    if not (isinstance(cells, tuple | list) and len(cells) == 2 and all(isinstance(c, LoadCell) for c in cells)):
        raise ParameterError(f"calibration = {calibration!r}: expected a LoadCell or a pair of them")
    first, second = cells
    readings = samples("force_1", force_1), samples("force_2", force_2)
    if len(readings[0]) != len(readings[1]):
        raise ParameterError(f"force_2 has {len(readings[1])} samples: expected {len(readings[0])}, as many as force_1")
    return np.asarray((first.force(readings[0], time=time) + second.force(readings[1], time=time)) * lever)


def pretension_from_load_cells(
    reading_in: float | np.ndarray, reading_out: float | np.ndarray, *, g: float = STANDARD_GRAVITY
) -> float | np.ndarray:
    """Pretension of each cable of a pair, N: (in + out) / 4 g  (S3 eq. 3).

    A cell carries both cables of its side, so the mean of the two readings is twice the pretension. Readings in kg,
    numbers or arrays of one shape; `g` in m/s^2, 1 where the readings are in N.

    Raises ParameterError: readings below 0 (a cable cannot push) or not finite, unequal shapes, g not above 0."""
    positive("g", g, "m/s^2")
    sides = [reals("reading_in", reading_in), reals("reading_out", reading_out)]
    for name, side in zip(("reading_in", "reading_out"), sides, strict=True):
        broken = side[~(np.isfinite(side) & (side >= 0.0))]
        if broken.size:
            raise ParameterError(f"{name} = {broken.flat[0]}: expected a value in [0, inf)")
    if sides[0].shape != sides[1].shape:
        raise ParameterError(f"reading_out has shape {sides[1].shape}: expected {sides[0].shape}, that of reading_in")
    pretension = (sides[0] + sides[1]) / 4.0 * g
    return float(pretension) if pretension.ndim == 0 else pretension

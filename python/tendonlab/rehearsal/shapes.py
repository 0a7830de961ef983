"""Shapes of planned motions and commands: samples of a path from a few numbers."""

from __future__ import annotations

import numpy as np

from tendonlab.data.schema import Table

SHAPES = {  # the numbers that each shape takes
    "chirp": ("amplitude", "offset", "frequencies"),
    "steps": ("amplitude", "offset", "hold"),
    "slow_reversals": ("amplitude", "offset", "speed"),
}
LEVELS = (0.0, 1.0, -1.0, 0.5, -0.5)  # of the amplitude, one after the other


def planned_path(shape: str, table: Table, time: np.ndarray) -> np.ndarray:
    """Samples of a shape at `time`, s from 0, shape (n,), in the SI unit of its signal. Raises DatasetError for a
    number that is missing or out of bounds."""
    amplitude = table.number("amplitude", lower=1e-12)
    moved = {"chirp": _chirp, "steps": _steps, "slow_reversals": _reversals}[shape](table, time, amplitude)
    return table.number("offset", 0.0) + moved


def _chirp(table: Table, time: np.ndarray, amplitude: float) -> np.ndarray:
    """A sine whose frequency goes evenly from the first to the last of `frequencies`, Hz."""
    given = table.values.get("frequencies")
    if not isinstance(given, list) or len(given) != 2 or not all(_is_positive(f) for f in given):
        raise table.error("frequencies", f"{given!r}: expected two numbers above 0, Hz, such as [0.1, 3.0]")
    first, last = map(float, given)
    if last > 0.5 / float(time[1] - time[0]):
        raise table.error("frequencies", f"{last:g} Hz: expected at most half of the rate")
    return np.asarray(amplitude * np.sin(2 * np.pi * (first * time + 0.5 * (last - first) * time**2 / time[-1])))


def _steps(table: Table, time: np.ndarray, amplitude: float) -> np.ndarray:
    """LEVELS of the amplitude, each for `hold` seconds, over and over."""
    hold = table.number("hold", lower=float(time[1] - time[0]))
    place = np.floor(time / hold + 1e-9).astype(int) % len(LEVELS)
    return np.asarray(amplitude * np.array(LEVELS)[place])


def _reversals(table: Table, time: np.ndarray, amplitude: float) -> np.ndarray:
    """A triangle between plus and minus the amplitude at `speed` per second, from 0."""
    speed = table.number("speed", lower=1e-12)
    return np.asarray(amplitude * 2 / np.pi * np.arcsin(np.sin(0.5 * np.pi * speed / amplitude * time)))


def _is_positive(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0 < value < float("inf")

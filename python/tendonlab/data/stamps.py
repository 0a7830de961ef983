"""Time stamps that were rounded: even sampling under whole milliseconds, say, is given its even steps back."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from tendonlab.data.said import listed
from tendonlab.simulation.records import Experiment

COARSEST, FINEST = 0, -9  # powers of ten of a second that stamps may be rounded to
MATTERS = 0.01  # of the sampling period: rounding to finer steps is left alone
WHOLE = 1e-3  # of a step, from whole ones, beside what floats of that size resolve
EVEN = 1e-6  # of the period: stamps so near to a grid are on it
FEWEST = 20  # samples that tell a grid from chance
BEGINNING = 32  # samples that the grid is begun with; it is then followed to twice as many, and so on


@dataclass(frozen=True)
class Grid:
    """Even instants, a `period` apart, s, under stamps that were rounded to whole steps of `rounding`, s. `numbers`:
    that of each sample, from 0; some are not there where samples are missing."""

    period: float
    rounding: float
    numbers: np.ndarray


def with_even_stamps(experiments: Iterable[Experiment]) -> tuple[tuple[Experiment, ...], list[str]]:
    """The experiments, where stamps were rounded from even instants at these, counted from the first stamp; and a
    warning for each rounding and period. Other stamps stay as they are, to the last bit."""
    found: list[Experiment] = []
    evened: dict[tuple[str, str], list[str]] = {}
    for experiment in experiments:
        time = experiment.time
        grid = grid_of(time)
        if grid is not None:
            evened.setdefault((f"{grid.rounding:g}", f"{grid.period:.4g}"), []).append(experiment.name)
            data = experiment.data.set_axis(time[0] + grid.period * grid.numbers, axis=0).rename_axis("t", axis=0)
            experiment = replace(experiment, data=data)
        found.append(experiment)
    return tuple(found), [
        f"the time stamps of {listed(names)} are rounded to {rounding} s, and fit samples taken every {period} s: "
        "these even instants are used"
        for (rounding, period), names in evened.items()
    ]


def grid_of(time: np.ndarray) -> Grid | None:
    """The grid that increasing stamps, s, were rounded from; None where they were not, where the rounding does not
    matter, and where they are even as they are."""
    if len(time) < FEWEST:
        return None
    passed = time - time[0]
    resolved = 2.0 * float(np.spacing(np.abs(time).max()))
    rounding = _rounding(passed, resolved)
    if rounding is None:
        return None
    steps = np.diff(passed)
    period = float(np.mean(steps[steps <= np.median(steps) + 1.5 * rounding]))  # without the steps over lost samples
    if not MATTERS * period < rounding < period:
        return None
    numbers = _numbers(passed, period)
    if numbers is None:
        return None
    period, spread = _narrowest(passed, numbers, rounding)
    is_even, fits = spread <= 2.0 * max(EVEN * period, resolved), spread <= rounding * (1.0 + WHOLE) + resolved
    return Grid(period, rounding, numbers) if fits and not is_even else None


def _rounding(passed: np.ndarray, resolved: float) -> float | None:
    """The largest power of ten of a second that all stamps are multiples of."""
    for power in range(COARSEST, FINEST - 1, -1):
        step = 10.0**power
        if WHOLE * step < resolved:
            return None
        if np.abs(passed - step * np.round(passed / step)).max() <= WHOLE * step + resolved:
            return step
    return None


def _numbers(passed: np.ndarray, period: float) -> np.ndarray | None:
    """Number of the grid's instant that is nearest to each stamp, from 0; None where two stamps share one, or most
    instants have none. The period becomes the more exact the more samples it is followed over."""
    start, num = 0.0, BEGINNING
    while True:
        seen = passed[:num]
        numbers = np.round((seen - start) / period)
        if (np.diff(numbers) < 1).any():
            return None
        if num >= len(passed):
            break
        period, start = np.polyfit(numbers, seen, 1)
        num *= 2
    numbers -= numbers[0]
    return numbers if np.mean(np.diff(numbers) == 1) > 0.5 else None


def _narrowest(passed: np.ndarray, numbers: np.ndarray, rounding: float) -> tuple[float, float]:
    """The period around which the stamps scatter least, and the width of that scatter: both s."""
    from scipy.optimize import minimize_scalar

    def spread(period: float) -> float:
        return float(np.ptp(passed - period * numbers))

    middle, room = float(np.polyfit(numbers, passed, 1)[0]), 2.0 * rounding / float(numbers[-1])
    best = minimize_scalar(
        spread, bounds=(middle - room, middle + room), method="bounded", options={"xatol": 1e-7 * room}
    )
    return float(best.x), float(best.fun)

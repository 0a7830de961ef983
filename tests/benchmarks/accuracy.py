"""Errors, and the cheapest setting of a tool that keeps within one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.clock import Call, cpu_seconds

TARGETS = (1e-3, 1e-6)
ENOUGH = 0.1 * min(TARGETS)  # a scan ends after two settings in a row below this error,
SLOWEST = 3.0  # or after a call that takes so long, s


def error(found: np.ndarray, reference: np.ndarray) -> float:
    """The largest over the outputs of root mean square error over root mean square. Shape of both: (samples, k)."""
    if found.shape != reference.shape or not np.isfinite(found).all():
        return float("nan")
    return float(np.sqrt(np.mean((found - reference) ** 2, axis=0) / np.mean(reference**2, axis=0)).max())


def median_error(found: np.ndarray, reference: np.ndarray) -> float:
    """The median error of several simulations, shape (runs, samples, k)."""
    return float(np.median([error(a, b) for a, b in zip(found, reference, strict=True)]))


@dataclass(frozen=True)
class Setting:
    """A tool at one tolerance: the error and the CPU time, s, of a call."""

    tolerance: float
    error: float
    seconds: float


def scan(
    call_at: Callable[[float], Call], judge: Callable[[np.ndarray], float], tolerances: Sequence[float]
) -> list[Setting]:
    """Every tolerance from the loosest on, until the error is far below the tightest target or a call is too slow. A
    setting that fails has no error."""
    done: list[Setting] = []
    for tolerance in tolerances:
        call = call_at(tolerance)
        try:
            found = judge(call())
        except (ArithmeticError, RuntimeError, ValueError):
            found = float("nan")
        done.append(Setting(float(tolerance), found, _least(call) if np.isfinite(found) else float("nan")))
        far_below = len(done) > 1 and all(s.error <= ENOUGH for s in done[-2:])
        if far_below or done[-1].seconds > SLOWEST:
            break
    return done


def _least(call: Call) -> float:
    """CPU time of a call: the least of a few if they are quick."""
    first = cpu_seconds(call)
    return first if first > 0.1 else min(first, *(cpu_seconds(call) for _ in range(4)))


def cheapest(settings: Sequence[Setting], target: float) -> Setting | None:
    """The loosest setting from which on all tighter ones keep the error."""
    kept = None
    for setting in reversed(settings):
        if not setting.error <= target:
            break
        kept = setting
    return kept

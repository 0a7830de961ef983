"""CPU time of calls that take turns."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import Any

SHORTEST = 0.02  # s of CPU time of one measurement; quicker calls are repeated

Call = Callable[[], Any]


def cpu_seconds(call: Call, repeats: int = 1) -> float:
    """CPU time of this process, all threads, per call."""
    began = time.process_time()
    for _ in range(repeats):
        call()
    return (time.process_time() - began) / repeats


def alternate(calls: Sequence[Call], *, rounds: int) -> list[float]:
    """The least CPU time of one call of each, s, over rounds in which they take turns: A, B, A, B, ... A first round
    warms up and says how often quick calls are repeated. The least, because other processes only ever add time."""
    repeats = [max(1, math.ceil(SHORTEST / max(cpu_seconds(call), 1e-6))) for call in calls]
    least = [math.inf] * len(calls)
    for _ in range(rounds):
        for i, call in enumerate(calls):
            least[i] = min(least[i], cpu_seconds(call, repeats[i]))
    return least

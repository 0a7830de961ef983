"""One run of the bench of S0 as its encoder sees it: up, steady, down, over the same travel at every speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

STEP = 2.0 * np.pi / 8192.0  # of the encoder, rad
INTERVAL = 1e-3  # s
TRAVEL, RAMP = 40.0, 0.15  # rad, s


@dataclass(frozen=True)
class Run:
    """`time`, s, true `speed`, rad/s, and `measured` position, rad, with noise and quantisation."""

    time: np.ndarray
    speed: np.ndarray
    measured: np.ndarray


@pytest.fixture(scope="session")
def bench_run() -> Callable[..., Run]:
    def run(speed: float, *, seed: int = 0, noise: float = 2e-4) -> Run:
        duration = TRAVEL / abs(speed) + RAMP
        time = np.arange(0.0, duration + 0.1, INTERVAL)
        true = speed * np.clip(np.minimum(time, duration - time) / RAMP, 0.0, 1.0)
        position = np.concatenate([[0.0], np.cumsum(0.5 * (true[1:] + true[:-1])) * INTERVAL])
        noisy = position + noise * np.random.default_rng(seed).normal(size=len(time))
        return Run(time, true, np.round(noisy / STEP) * STEP)

    return run

"""An effect predicts what its model was not fitted to, all in all or but for one run."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.search import halves


@pytest.mark.parametrize(
    ("even", "odd", "better"),
    [
        ([105, 168, -34, 175, 116, 118], [91, 162, 85, -343, 121, 174], True),  # a servo that sticks elsewhere once
        ([105, 168, -340, 175, 116, 118], [91, 162, 85, -343, 121, 174], False),  # twice is no chance
        ([300, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], True),  # one run alone shows the effect
        ([5, -5, 6, -5, 5, -6], [5, -4, 5, -5, 4, -5], False),
        ([40, 35, -120], [38, 41, 37], False),  # too few to leave one out
    ],
)
def test_one_run_may_stick_elsewhere(
    even: list[float], odd: list[float], better: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    base: Any = SimpleNamespace(counted=lambda shares: "base")
    extended: Any = SimpleNamespace(shares=None)
    gains = {False: np.array(even, dtype=float), True: np.array(odd, dtype=float)}
    monkeypatch.setattr(
        halves, "_scores", lambda fitter, model, *, odd: 0.0 * gains[odd] if model == "base" else gains[odd]
    )
    fitter: Any = None
    assert halves.predicts_better(fitter, base, extended) is better

"""Starts of effects whose amplitude is a share that fits hold."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.diagnosis.search import shares

START = {"static_friction_coefficient": 0.9, "stribeck_velocity": 5e-4, "stribeck_share": 1.0}
BEST = {"static_friction_coefficient": 0.3, "stribeck_velocity": 1.2e-3}


def start(monkeypatch: pytest.MonkeyPatch, gain: Any, *, promised: float, effect: str = "contact:stribeck") -> Any:
    """What `whole` makes of START where an effect at some values brings `gain`."""
    fitter: Any = SimpleNamespace(case=SimpleNamespace(system=SimpleNamespace(info=tl.system_info("ccsrm"))))
    base: Any = SimpleNamespace(counted=lambda: None)
    monkeypatch.setattr(
        shares, "expected_gains", lambda fitter, base, effect, tried: [gain(values) for values in tried]
    )
    return shares.whole(fitter, base, effect, START, promised)


def hill(values: dict[str, float]) -> float:
    """Far from BEST the whole effect harms."""
    return 100.0 - 80.0 * sum(math.log(values[name] / best) ** 2 for name, best in BEST.items())


def test_a_start_that_keeps_its_promise_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    assert start(monkeypatch, lambda values: 60.0, promised=100.0) == START


def test_shapes_are_sought_with_which_the_whole_share_brings_most(monkeypatch: pytest.MonkeyPatch) -> None:
    found = start(monkeypatch, hill, promised=100.0)
    assert hill(START) < 0.0
    assert hill(found) > 90.0
    assert found["stribeck_share"] == 1.0


def test_values_that_cannot_be_simulated_are_no_start(monkeypatch: pytest.MonkeyPatch) -> None:
    def breaks(values: dict[str, float]) -> float:
        return -math.inf if values["static_friction_coefficient"] < 0.5 else hill(values)

    found = start(monkeypatch, breaks, promised=100.0)
    assert found["static_friction_coefficient"] >= 0.5
    assert hill(found) > hill(START)


def test_amplitudes_that_fits_can_move_need_no_search(monkeypatch: pytest.MonkeyPatch) -> None:
    assert start(monkeypatch, lambda values: -1.0, promised=100.0, effect="joint:stribeck") == START

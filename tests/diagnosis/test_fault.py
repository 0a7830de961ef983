"""The answer where the logs cannot be right."""

from dataclasses import replace
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.checking.finding import Check, Finding
from tendonlab.cli.demo import bundled
from tendonlab.diagnosis import holding
from tendonlab.diagnosis.fault import data_fault
from tendonlab.errors import NumericalError


def test_the_noise_of_a_faulty_log_is_what_is_stated_of_its_sensors() -> None:
    logs = tl.load(bundled())
    name = logs.outputs[0]
    spec = replace(logs.signals[name], noise_sd=0.02, resolution=0.0)
    stated = replace(logs, signals={**logs.signals, name: spec})
    found = Check(dataset=logs.name, findings=(Finding(problem="sign", detail="turned", signal=name, blocks=True),))
    as_shown, as_stated = (data_fault(of, of.system(), found, seed=0, seconds=0.0).gap for of in (logs, stated))
    assert as_stated[name]["noise_floor"] == pytest.approx(0.02)
    assert 0.0 < as_shown[name]["noise_floor"] < 0.02
    assert as_stated[logs.outputs[1]] == as_shown[logs.outputs[1]]


def test_a_model_that_fails_under_white_noise_says_nothing_of_how_inputs_are_held(
    fitter: Any, nominal: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: Any, **__: Any) -> None:
        raise NumericalError("derivatives are not finite")

    monkeypatch.setattr(holding, "_under_white", fails)
    logs = replace(tl.load(bundled()), controller=None)
    search: Any = type("Search", (), {"fitter": fitter, "final": nominal})
    shop: Any = None
    assert list(holding._held(logs, logs.system()))
    assert holding.straight_inputs(logs, logs.system(), search, shop) is None

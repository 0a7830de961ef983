"""Experiments that look late once an effect is simulated."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from tendonlab.checking.finding import Check, Finding
from tendonlab.diagnosis import late
from tendonlab.diagnosis.late import checked_again

CLEAN = Check(dataset="rig", findings=())
LATE = Finding(problem="clock", detail="slow is late", experiment="slow", blocks=True, seconds=0.04)


def test_a_late_experiment_that_an_effect_hid_from_the_check_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    logs: Any = "logs"
    search: Any = SimpleNamespace(selected=("actuation:deadband",), final=SimpleNamespace(system="simulator"))
    monkeypatch.setattr(late, "late_experiments", lambda *given: [LATE] if given == ("logs", "simulator") else [])
    found = checked_again(CLEAN, logs, search)
    assert found.findings == (LATE,)
    assert found.blocks
    assert "actuation:deadband" in found.notes[-1]
    nothing: Any = SimpleNamespace(**{**vars(search), "selected": ()})
    assert checked_again(CLEAN, logs, nothing) == CLEAN
    assert checked_again(replace(CLEAN, findings=(LATE,)), logs, search).findings == (LATE,)

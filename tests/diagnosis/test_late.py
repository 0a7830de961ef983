"""Experiments that look late once an effect is simulated, unless the model predicts them as they were logged."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from tendonlab.checking.finding import Check, Finding
from tendonlab.diagnosis import late
from tendonlab.diagnosis.late import PREDICTED, checked_again

CLEAN = Check(dataset="rig", findings=())
LATE = Finding(problem="clock", detail="slow is late", experiment="slow", blocks=True, seconds=0.04)


@pytest.mark.parametrize("names", [("fast", "slow"), ("fast", "slow (part 1)", "slow (part 2)")])
@pytest.mark.parametrize(("left", "is_late"), [(0.9 * PREDICTED, False), (1.1 * PREDICTED, True)])
def test_a_run_or_all_its_parts_are_replayed_to_see_whether_it_is_late(
    names: tuple[str, ...], left: float, is_late: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    replayed: list[Any] = []

    def replay(case: Any, systems: Any, runs: Any) -> str:
        assert len(systems) == len(runs)
        replayed.extend(runs)
        return "replay"

    monkeypatch.setattr(late, "late_experiments", lambda *_: [LATE])
    monkeypatch.setattr(late, "replay", replay)
    monkeypatch.setattr(late, "level", lambda *_: left)
    case = SimpleNamespace(experiments=[SimpleNamespace(name=name) for name in names])
    fitter = SimpleNamespace(case=case, floor=None)
    search: Any = SimpleNamespace(selected=("actuation:deadband",), final=SimpleNamespace(system=None), fitter=fitter)
    logs: Any = None
    found = checked_again(CLEAN, logs, search)
    assert replayed == list(range(1, len(names)))
    assert (LATE in found.findings) is is_late
    assert found.blocks is is_late
    assert checked_again(CLEAN, logs, SimpleNamespace(**{**vars(search), "selected": ()})) == CLEAN
    assert checked_again(replace(CLEAN, findings=(LATE,)), logs, search).findings == (LATE,)

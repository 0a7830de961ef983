"""An experiment that looks late by its equation alone is late where the simulator follows it better on one clock."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from checking.pendulum import late_run, record
from tendonlab.checking import aligned
from tendonlab.checking.aligned import REFUTED, confirmed
from tendonlab.checking.clocks import ALIGN
from tendonlab.checking.finding import Finding
from tendonlab.data import Dataset
from tendonlab.errors import NumericalError

LATE = Finding(problem="clock", detail=f"quick is late; {ALIGN}", experiment="quick", blocks=True, seconds=0.02)
SIGN = Finding(problem="sign", detail="turned", signal="joint_angle", blocks=True)


@pytest.fixture
def right(tmp_path: Path) -> Dataset:
    return record().write(tmp_path)


def test_what_only_looks_late_blocks_nothing(right: Dataset) -> None:
    sign, late = confirmed([SIGN, LATE], right, right.system())
    assert sign == SIGN
    assert not late.blocks
    assert late.detail == f"quick is late; {REFUTED}"
    assert confirmed([late], right, right.system()) == [late]


@pytest.mark.parametrize("signal", [None, "joint_angle"])
@pytest.mark.parametrize("by", [0.02, -0.02])
def test_what_is_late_or_early_blocks(by: float, signal: str | None, tmp_path: Path) -> None:
    wrong = late_run(record(), "quick", by).write(tmp_path)
    found = replace(LATE, signal=signal, seconds=by)
    assert confirmed([found], wrong, wrong.system()) == [found]
    assert not confirmed([replace(found, seconds=-by)], wrong, wrong.system())[0].blocks


def test_what_cannot_be_simulated_stays_as_it_was_found(right: Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object) -> None:
        raise NumericalError("too stiff")

    monkeypatch.setattr(aligned, "rough_fit", fails)
    assert confirmed([LATE], right, right.system()) == [LATE]
    assert not confirmed([LATE], right, right.system(), if_unable=False)[0].blocks

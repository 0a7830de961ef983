"""Held-out experiments of which a part was not measured, or cannot be simulated."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.answer import heldout
from tendonlab.diagnosis.answer.heldout import Replayed, gap, replay_all, shrinkage
from tendonlab.errors import NumericalError

TIME = np.arange(0.0, 12.0, 0.01)


def replayed(error: float, lost: slice = slice(0)) -> Replayed:
    """Two outputs that are off by `error` floors everywhere; the second one was not measured where it is `lost`."""
    residual = np.full((2, len(TIME)), error)
    residual[1, lost] = np.nan
    return Replayed((), (), (residual,), ())


@pytest.mark.parametrize("lost", [slice(0), slice(500, 800), slice(600, None), slice(None)])
def test_the_gap_shrinks_as_far_as_the_measured_parts_show(lost: slice) -> None:
    """Gaps of sqrt(10² - 1) and sqrt(2² - 1) floors, whatever was not measured."""
    case: Any = SimpleNamespace(experiments=[SimpleNamespace(time=TIME)])
    floor: Any = SimpleNamespace(rms=np.ones(2))
    found = shrinkage(case, replayed(10.0, lost), replayed(2.0, lost), floor, [0], np.random.default_rng(0))
    assert found["value"] == pytest.approx(1.0 - np.sqrt(3.0 / 99.0))
    assert found["ci95"] == pytest.approx([found["value"]] * 2)


def test_an_experiment_without_an_output_has_the_gap_of_the_others() -> None:
    assert gap(np.array([4.0, np.nan]), np.ones(2)) == pytest.approx(np.sqrt(3.0))
    assert np.isnan(gap(np.array([np.nan, np.nan]), np.ones(2)))


def test_what_one_model_cannot_simulate_is_left_out_for_all(monkeypatch: pytest.MonkeyPatch) -> None:
    def replay(case: Any, systems: Any, experiments: Any) -> Replayed:
        if systems == ["stiff"] and experiments == [4]:
            raise NumericalError("too many steps")
        return replace(replayed(float(experiments[0])), systems=tuple(systems))

    monkeypatch.setattr(heldout, "replay", replay)
    case: Any = SimpleNamespace(experiments=[SimpleNamespace(name=f"run-{i}") for i in range(6)])
    models: Any = [["soft"] * 3, ["soft", "stiff", "soft"]]
    (first, last), kept, failed = replay_all(case, models, [3, 4, 5])
    assert (kept, failed) == ([3, 5], {"run-4": "too many steps"})
    assert first.systems == last.systems == ("soft", "soft")
    assert [of[0, 0] for of in last.residuals] == [3.0, 5.0]
    with pytest.raises(NumericalError, match="no experiment to judge by can be simulated: too many steps"):
        replay_all(case, [["stiff"]], [4])

"""A training experiment that holds most of what a model leaves is left out where the others tell more without it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis import apart
from tendonlab.diagnosis.apart import told_without, without_run_apart
from tendonlab.diagnosis.windows import LARGE
from tendonlab.errors import NumericalError


def search(case: Any, left: list[float], *selected: str) -> Any:
    """A search whose final model leaves this mean square of each training run; of a run alone, the first of these."""
    runs = tuple(SimpleNamespace(residual=np.full(50, level**0.5), output=np.zeros(50, dtype=int)) for level in left)
    final = SimpleNamespace(
        runs=runs, mean_square=float(np.mean(left)), levels=np.array([2.0]), known=np.array([2.0]), system="simulator"
    )
    return SimpleNamespace(final=final, selected=selected, fitter=SimpleNamespace(case=case))


@pytest.fixture
def case(twin_case: Any) -> Any:
    return twin_case


def others(case: Any) -> int:
    return len(case.train) - 1


@pytest.mark.parametrize(
    ("level", "stands_apart"), [(0.5 * LARGE, False), (40.0 * LARGE, True), (1.5 * LARGE, False), (np.inf, False)]
)
def test_a_run_stands_apart_that_holds_most_of_much(level: float, stands_apart: bool, case: Any) -> None:
    rest = LARGE if level < 10.0 * LARGE or np.isinf(level) else 2.0 * LARGE
    first = level if np.isfinite(level) else rest
    found = without_run_apart(case.dataset, search(case, [first, *[rest] * others(case)]))
    name = case.experiments[case.train[0]].name
    assert (found is not None) is stands_apart
    if found:
        assert found[1] == name
        assert name not in [e.name for e in found[0]]
        assert len(found[0].experiments) == len(case.dataset.experiments) - 1


def test_few_runs_do_not_outvote_one(case: Any) -> None:
    few = case.training_on(case.train[:4])
    assert without_run_apart(few.dataset, search(few, [1e4, 1.0, 1.0, 1.0])) is None


@pytest.mark.parametrize(
    ("selected", "left", "alone", "is_told"),
    [
        (("joint:stribeck",), 4.0, 100.0, True),
        ((), 4.0, 100.0, False),
        (("joint:stribeck",), 15.0, 100.0, False),
        (("joint:stribeck",), 4.0, 600.0, False),
        (("joint:stribeck",), 4.0, None, False),
    ],
)
def test_effects_count_that_leave_less_of_all(
    selected: tuple[str, ...], left: float, alone: float | None, is_told: bool, case: Any, monkeypatch: Any
) -> None:
    name = case.experiments[case.train[0]].name
    before = search(case, [1000.0, *[20.0] * others(case)])
    after = search(case, [left] * others(case), *selected)

    def fit(system: str, **_: object) -> Any:
        assert system == "simulator"
        if alone is None:
            raise NumericalError("runs away")
        return search(case, [alone]).final

    monkeypatch.setattr(apart, "replace", lambda fitter, case: SimpleNamespace(fit=fit, case=case))
    told = told_without(name, before, after)
    assert bool(told) is is_told
    if told:
        assert f"{name} alone held" in told
        assert "joint:stribeck was found" in told


def test_a_case_without_an_experiment_keeps_the_others(case: Any) -> None:
    left = case.without(case.experiments[0].name)
    assert left.experiments == case.experiments[1:]
    assert [p is q for p, q in zip(left.prepared, case.prepared[1:], strict=True)] == [True] * len(left.prepared)
    assert replace(case).without("none of these").experiments == case.experiments

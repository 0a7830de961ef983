"""Further effects near the floor that mend slow errors, which whitening and friction from run to run take up."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.search import contest, slow
from tendonlab.diagnosis.search.trial import Trial
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter


def after(base: Fitted, effect: str, *, evidence: float = 400.0, left_out: float = 400.0) -> Trial:
    return Trial(effect, replace(base, added=(*base.added, effect)), evidence, left_out, 1.0)


@pytest.fixture
def left(monkeypatch: pytest.MonkeyPatch) -> Any:
    """States what models of one and two effects leave above the floor."""

    def state(one: float, two: float) -> None:
        monkeypatch.setattr(slow, "_above", lambda fitter, model: one if len(model.added) == 1 else two)

    return state


@pytest.mark.parametrize(
    ("gains", "one", "two", "mends"),
    [
        ({}, 1.5, 0.7, True),
        ({}, 1.5, 0.8, False),  # less than half of it
        ({}, 0.25, 0.0, False),  # next to nothing to mend
        ({"evidence": 290.0}, 1.5, 0.0, False),
        ({"left_out": 290.0}, 1.5, 0.0, False),
    ],
)
def test_an_effect_mends_slow_errors_that_gains_much_and_removes_half_of_them(
    fitter: Fitter, nominal: Fitted, left: Any, gains: dict[str, float], one: float, two: float, mends: bool
) -> None:
    left(one, two)
    base = replace(nominal, added=("cable:backlash",))
    assert slow.mends_slow_errors(fitter, base, after(base, "motor:stribeck", **gains)) is mends


@pytest.mark.parametrize("before", ["motor:presliding", "joint:stribeck"])
def test_friction_beside_friction_may_be_an_error_of_its_form(
    fitter: Fitter, nominal: Fitted, left: Any, before: str
) -> None:
    """In the same element, or of the same law in another one."""
    left(1.5, 0.0)
    base = replace(nominal, added=(before,))
    assert not slow.mends_slow_errors(fitter, base, after(base, "motor:stribeck"))


def test_what_is_left_counts_above_the_floor_output_by_output(fitter: Fitter, nominal: Fitted) -> None:
    """At a floor of half of what the model leaves, each output leaves 4 - 1; at that of all or twice of it, nothing."""
    case = fitter.case
    rows = [
        case.run(i, nominal.system, own)["outputs"] - case.prepared[i].measured
        for i, own in zip(case.train, nominal.initial, strict=True)
    ]
    rms = np.sqrt(np.nanmean(np.square(np.concatenate(rows, axis=1)), axis=1))
    for factor, above in ((0.5, 3.0 * len(case.measured)), (1.0, 0.0), (2.0, 0.0)):
        under = replace(fitter, floor=replace(fitter.floor, rms=factor * rms))
        assert slow._above(under, nominal) == pytest.approx(above, abs=1e-9)


@pytest.mark.parametrize(("mends", "repeated"), [(True, True), (False, True), (True, False)])
def test_repeats_establish_a_further_effect_that_mends_slow_errors(
    monkeypatch: pytest.MonkeyPatch, mends: bool, repeated: bool
) -> None:
    """A gain of 0.2 % of the largest, which removes 4 % of the mean square, is an error of a form otherwise."""
    monkeypatch.setattr(contest, "predicts_better", lambda *_: True)
    monkeypatch.setattr(contest, "mends_slow_errors", lambda *_: mends)
    monkeypatch.setattr(contest, "may_be_noise", lambda *_: False)
    case = SimpleNamespace(
        prepared=[SimpleNamespace(core=SimpleNamespace(position=[0.0, 0.0]))],
        replay=SimpleNamespace(carries_noise=False, output=None),
    )
    fitter: Any = SimpleNamespace(floor=SimpleNamespace(repeated=repeated), case=case)
    base: Any = SimpleNamespace(mean_square=0.96, runs=range(7), added=("cable:backlash",))
    trial: Any = Trial("motor:stribeck", SimpleNamespace(mean_square=0.92), 2000.0, 2000.0, 1.0)  # type: ignore[arg-type]
    worth = contest._worth_adding(fitter, base, [trial], further=True, largest_gain=1e6)
    assert worth is (mends and repeated)

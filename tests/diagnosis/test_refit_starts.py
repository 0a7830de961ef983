"""A refit starts where the parameters, and the own unknowns of each run, have followed the effect."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.diagnosis.search import following
from tendonlab.diagnosis.search.following import followed
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import Fitter, pose

EFFECT = "actuation:gain_error"  # all parameters together imitate a gain


@pytest.fixture(scope="module")
def right(known: tuple[Any, Fitted]) -> tuple[Fitter, Fitted]:
    case, fit = known
    return Fitter(case, white(case.noise), _core.Cancel()), fit


def cost(fitter: Fitter, system: Any, initial: Any) -> float:
    """Of the model with the effect there, priors included."""
    return pose(fitter.case, fitter.floor, system, added=(EFFECT,), initial=initial).linearise().cost


@pytest.mark.parametrize("gain", [0.05, -0.1])
def test_the_parameters_follow_an_effect_that_they_imitate(right: tuple[Fitter, Fitted], gain: float) -> None:
    """On logs that the simulator made, where an effect beside what stays leaves hundreds of times more."""
    fitter, base = right
    values = {"actuation_gain_error": gain}
    system, initial = followed(fitter, base, EFFECT, values)
    plain = base.system.with_effects({EFFECT: values})
    assert system.parameters["actuation_gain_error"] == gain
    assert cost(fitter, system, initial) < 0.05 * cost(fitter, plain, base.initial)
    ratio = system.parameters["joint_inertia"] / base.system.parameters["joint_inertia"]
    assert 0.4 * gain < ratio - 1.0 < 1.1 * gain if gain > 0.0 else 1.1 * gain < ratio - 1.0 < 0.4 * gain


def test_own_unknowns_follow_where_parameters_are_known(right: tuple[Fitter, Fitted]) -> None:
    fitter, base = right
    alone = pose(fitter.case, fitter.floor, base.system, initial=base.initial, known=True).linearise()
    values = {"load_offset": 0.02}
    system, initial = followed(fitter, alone, "load:offset", values)
    assert system.parameters == base.system.with_effects({"load:offset": values}).parameters
    before = pose(fitter.case, fitter.floor, system, initial=alone.initial, known=True).linearise()
    after = pose(fitter.case, fitter.floor, system, initial=initial, known=True).linearise()
    assert after.cost < before.cost
    assert all(new.cost <= old.cost for new, old in zip(after.runs, before.runs, strict=True))


def test_what_cannot_be_simulated_starts_as_the_screen_found_it(
    right: tuple[Fitter, Fitted], monkeypatch: pytest.MonkeyPatch
) -> None:
    fitter, base = right
    monkeypatch.setattr(following, "whitened_at", lambda fitter, base, systems: ["stopped"] * len(systems))
    system, initial = followed(fitter, base, EFFECT, {"actuation_gain_error": 0.1})
    assert initial == base.initial
    assert system.parameters == {**base.system.parameters, "actuation_gain_error": 0.1}


def test_steps_that_cannot_be_simulated_or_leave_more_are_not_taken(
    right: tuple[Fitter, Fitted], monkeypatch: pytest.MonkeyPatch
) -> None:
    fitter, base = right
    worse = [np.full(len(run.residual), 1e6) for run in base.runs]

    def seen(fitter: Any, base: Fitted, systems: Any) -> list[Any]:
        if len(systems) == 1:
            return [[run.residual + 1.0 for run in base.runs]]
        return ["stopped", worse]

    monkeypatch.setattr(following, "whitened_at", seen)
    own = replace(base, runs=tuple(replace(run, own=run.own[:0], by_own=run.by_own[:, :0]) for run in base.runs))
    system, initial = followed(fitter, own, EFFECT, {"actuation_gain_error": 0.1})
    assert system.parameters == {**base.system.parameters, "actuation_gain_error": 0.1}
    assert initial == base.initial


def test_derivatives_that_exploded_move_nothing(right: tuple[Fitter, Fitted]) -> None:
    fitter, base = right
    wild = replace(base, runs=tuple(replace(run, jacobian=np.full_like(run.jacobian, np.inf)) for run in base.runs))
    system, initial = followed(fitter, wild, EFFECT, {"actuation_gain_error": 0.1})
    assert initial == base.initial
    assert system.parameters == {**base.system.parameters, "actuation_gain_error": 0.1}

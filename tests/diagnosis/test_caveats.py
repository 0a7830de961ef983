"""What a reader must know before any number: strained values, changes for the worse, floors above their signal."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.answer.caveats import caveats
from tendonlab.diagnosis.answer.heldout import Replayed
from tendonlab.diagnosis.answer.judged import Judged
from tendonlab.diagnosis.answer.outlier_run import OutlierRun
from tendonlab.diagnosis.drift import Drift
from tendonlab.fitting.noise import Floor
from tendonlab.simulation.records import NominalParameter

FLOOR = Floor(np.array([1.0]), [[]], [1.0], 0.008, repeated=True)


def said(
    *,
    x: float = 0.0,
    errors: tuple[float, float, float] = (9.0, 3.0, 2.0),
    added: tuple[str, ...] = ("a:b",),
    swing: float = 50.0,
    stated: NominalParameter | None = None,
    drift: Drift | None = None,
    outlier: OutlierRun | None = None,
    without: float | None = None,
) -> tuple[str, ...]:
    """Caveats on an inertia fitted `x` stated sd away (`without` the effects: so many), and these held-out errors of
    one output of this swing."""
    sd = ((stated and stated.sd) or 0.002) / 0.02
    free: Any = SimpleNamespace(
        name="inertia", log=True, scale=0.02, mean=0.0, sd=sd, value=lambda x: 0.02 * float(np.exp(x))
    )

    def model(x: float) -> Any:
        at = np.log1p(0.1 * x) if x > -10.0 else -140.0
        return SimpleNamespace(free=[free], x=[at], added=added, system=SimpleNamespace(unit=lambda name: "kg*m^2"))

    time = np.linspace(0.0, 20.0 * np.pi, 4001)
    parameters = {"inertia": stated or NominalParameter(0.02, 0.002)}
    case: Any = SimpleNamespace(
        system=SimpleNamespace(kind="two_inertia"),
        dataset=SimpleNamespace(parameters=parameters),
        measured=[0],
        outputs=["joint_angle"],
        prepared=[SimpleNamespace(measured=swing * np.sqrt(2.0) * np.sin(time)[None])],
    )
    stages = {s: _of(e) for s, e in zip(("nominal", "refitted", "with_effect"), errors, strict=True)}
    relieved = None if without is None else model(without)
    return caveats(model(x), Judged(case, FLOOR, stages, (), (0,), {}), drift, outlier, relieved=relieved)


def test_a_logarithm_without_end_is_a_value_of_0() -> None:
    (only,) = said(x=-10.0)
    assert only == "Inertia was fitted at 0 kg·m²: 10 standard deviations from the stated 0.02 ± 0.002."


def _of(error: float) -> Replayed:
    return Replayed((), (), (np.array([[error, -error]]),), ())


def test_nothing_is_said_where_all_is_well() -> None:
    assert said(x=3.9) == ()


def test_a_parameter_far_from_its_stated_value_is_named() -> None:
    (text,) = said(x=-4.4)
    assert text == "Inertia was fitted at 0.0112 kg·m²: 4 standard deviations from the stated 0.02 ± 0.002."


def test_a_value_that_is_known_to_a_factor_is_far_by_its_logarithm() -> None:
    """Stated to half of itself: six times as large is 10 of these linearly, 3.6 as the fit believes."""
    broad = NominalParameter(0.02, 0.01)
    assert said(x=50.0, stated=broad) == ()  # 6 times the value
    (text,) = said(x=200.0, stated=broad)
    assert text.endswith("6 standard deviations from the stated 0.02 ± 0.01, in its logarithm.")  # ln 21 over 0.5


@pytest.mark.parametrize("sd", [None, 0.0, np.inf])
def test_a_value_stated_without_a_standard_deviation_pulls_nothing(sd: float | None) -> None:
    assert said(x=9.0, stated=NominalParameter(0.02, sd)) == ()


def test_changes_that_make_the_held_out_error_larger_are_named() -> None:
    (tuning,) = said(errors=(2.0, 3.0, 2.5))
    assert (
        tuning == "Tuning the parameters made the held-out error larger: 2 noise floors before, 3 after; with a:b, 2.5."
    )
    (effect,) = said(errors=(9.0, 3.0, 4.0))
    assert effect == "Adding a:b made the held-out error larger: 3 noise floors before, 4 after."
    assert said(errors=(9.0, 3.0, 4.0), added=()) == ()
    assert said(errors=(3.0, 3.05, 3.0)) == ()  # rounding
    assert said(errors=(0.6, 0.9, 0.95)) == ()  # below the floor nothing counts
    assert len(said(errors=(0.6, 1.1, 1.0))) == 1


def test_a_floor_above_the_motion_is_named() -> None:
    (text,) = said(swing=0.5)
    assert text.startswith("The noise floor of joint_angle (1) exceeds its motion (rms 0.5)")
    assert said(swing=1.05) == ()


def test_friction_that_changed_over_the_session_is_named() -> None:
    (text,) = said(drift=Drift("contact", 0.12, 0.0004))
    assert text.startswith("The friction of the pulley contact rose by 12 % over the session, and no effect")
    assert text.endswith("In a random order the chance of such a trend would be 0.0004.")
    assert said(drift=Drift("contact", 0.12, 0.04)) == ()


def test_a_run_that_alone_differs_is_named() -> None:
    (text,) = said(outlier=OutlierRun(2, "run-4", 3.61, 1.0))
    assert text.startswith(
        "Of the training runs, run-4 alone leaves an error of 1.9 noise floors; the others leave 1. The verdict"
    )


def test_effects_that_bring_a_parameter_back_say_so() -> None:
    (line,) = said(x=1.23, without=9.0)
    assert line == (
        "Without a:b, inertia was fitted 9 standard deviations from its stated value; with a:b, no parameter further "
        "than 1.2 from its own. What was stated speaks for a:b where the held-out error does not."
    )
    assert said(x=1.23, without=3.0) == ()  # only unstated parameters were strained

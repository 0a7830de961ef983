"""Models weighed by an injection, and their errors in the closed loop of the rig that the report shows."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.cli.demo import bundled
from tendonlab.diagnosis import outcome
from tendonlab.diagnosis.answer import notes
from tendonlab.diagnosis.answer.answer import _shown
from tendonlab.diagnosis.answer.judged import Judged
from tendonlab.diagnosis.search.select import Search
from tendonlab.errors import NumericalError
from tendonlab.fitting import thinning
from tendonlab.fitting.case import make_case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter
from tendonlab.report.sections.computation import _weighed
from tendonlab.report.sentence import _floors


@pytest.fixture
def search(fitter: Fitter, nominal: Fitted) -> Search:
    """A search that found nothing, by fits without the controller."""
    case = make_case(replace(fitter.case.dataset, controller=None), fitter.case.system)
    return Search(replace(fitter, case=case), tuned=nominal, steps=(), rounds=())


@pytest.fixture
def weighed(search: Search) -> Judged:
    return Judged.of(search.fitter.case, search.fitter.floor, search)


def moved(search: Search, **values: float) -> Search:
    """The search as if tuning had ended at these values."""
    tuned = search.tuned
    return replace(search, tuned=replace(tuned, system=tuned.system.with_parameters(values)))


def test_the_reader_sees_the_errors_of_the_closed_loop(twin_case: Any, search: Search, weighed: Judged) -> None:
    shown, trouble = _shown(weighed, twin_case, search)
    assert trouble == []
    assert (weighed.case.replay.kind, shown.case.replay.kind) == ("injection", "controller")
    squares = []
    for i, start in zip(shown.experiments, shown.stages["nominal"].initial, strict=True):
        outputs = twin_case.run(i, twin_case.system, start)["outputs"]
        squares.append(np.mean(np.square(outputs - twin_case.prepared[i].measured), axis=1))
    rms = np.sqrt(np.mean(squares, axis=0))
    assert [row["nominal"] for row in shown.gap().values()] == pytest.approx(rms)
    assert (
        shown.gap()["motor_angle"]["nominal"] > 2.0 * weighed.gap()["motor_angle"]["nominal"]
    )  # nothing pulls it back


def test_a_simulator_that_runs_away_in_the_loop_is_shown_by_its_injection(
    twin_case: Any, search: Search, weighed: Judged
) -> None:
    stuck = moved(search, joint_coulomb=40.0 * twin_case.system.parameters["joint_coulomb"])
    shown, (said,) = _shown(weighed, twin_case, stuck)
    assert shown is weighed
    assert said.startswith("Errors are those of an injection. In the closed loop: a fitted simulator errs far more")


def test_a_rig_without_a_controller_is_shown_as_it_was_weighed(search: Search, weighed: Judged) -> None:
    assert _shown(weighed, None, search) == (weighed, [])
    assert notes.weighed(weighed, weighed) == {}


def test_a_loop_in_which_the_simulator_does_not_run_is_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> None:
        raise NumericalError("the step fell to 0")

    dataset = tl.load(bundled())
    loop, none = outcome._loop(dataset, dataset.system())
    assert (loop is not None, none) == (True, ())
    monkeypatch.setattr(outcome, "make_case", fails)
    loop, (said,) = outcome._loop(dataset, dataset.system())
    assert loop is None
    assert "does not run in its closed loop (the step fell to 0)" in said


def test_how_models_were_weighed_is_said(twin_case: Any, search: Search, weighed: Judged) -> None:
    shown, _ = _shown(weighed, twin_case, search)
    entry = notes.weighed(weighed, shown)["weighed_by"]
    assert (entry["kind"], entry["samples_per_second"]) == ("injection", 500.0)
    assert entry["errors"]["nominal"] == pytest.approx(weighed.errors()["nominal"])
    diagnosis: Any = SimpleNamespace(details={"weighed_by": entry}, gap={})
    ((title, text),) = _weighed(diagnosis)
    assert title == "Fits and probabilities"
    assert "500 samples per second. The tables of errors are of the replay above." in text
    assert _floors(diagnosis, "nominal") == entry["errors"]["nominal"]  # what the verdict's sentence quotes


@pytest.mark.parametrize(("used", "seen", "warns"), [(1.0, 1.4, False), (1.0, 1.6, True), (0.3, 1.4, False)])
def test_errors_that_differ_are_told(used: float, seen: float, warns: bool) -> None:
    weighed, shown = (SimpleNamespace(errors=lambda value=value: {"with_effect": value}) for value in (used, seen))
    said = notes._apart(weighed, shown)  # type: ignore[arg-type]
    assert bool(said) == warns
    assert all(f"held-out error is {seen:.2g} noise floors. The verdict counts the {used:.2g}" in text for text in said)


@pytest.mark.slow
def test_a_rig_with_a_controller_is_weighed_on_thinned_logs(monkeypatch: pytest.MonkeyPatch) -> None:
    """The whole way, on the bundled rig: its noise, and what that moves, is forgiven for once."""
    monkeypatch.setattr(thinning, "MOST_LOST_OF_A_LOOP", 0.15)
    for rule in ("JUMPS", "MOST_SHIFTED"):
        monkeypatch.setattr(thinning, rule, np.inf)
    told = tl.diagnose(tl.load(bundled()), library=["joint:stribeck", "motor:stribeck"], progress=False)
    assert (told.verdict, told.selected) == ("effect", ("joint:stribeck",))
    assert told.replay["kind"] == "controller"
    assert told.details["weighed_by"]["kind"] == "injection"
    assert told.details["weighed_by"]["samples_per_second"] == 100.0
    assert len(told.overlays[0].time) == 2000  # as it was logged
    assert told.gap["joint_angle"]["with_effect"] < 0.4 * told.gap["joint_angle"]["refitted"]


def test_a_loop_that_does_not_repeat_is_weighed_by_injection(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing else of the diagnosis runs."""
    kinds = []

    def under_floor(case: Any, shop: Any) -> Any:
        kinds.append(case.replay.kind)
        if len(kinds) == 2:
            raise KeyboardInterrupt
        return None, SimpleNamespace(floor=SimpleNamespace(tau=0.3))

    monkeypatch.setattr(outcome, "_under_floor", under_floor)
    with pytest.raises(KeyboardInterrupt):
        tl.diagnose(tl.load(bundled()), progress=False)
    assert kinds == ["controller", "injection"]

"""What notes say of a fit, of the replay and of held-out experiments."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tendonlab.diagnosis.answer import notes
from tendonlab.diagnosis.answer.by_noise import ByNoise
from tendonlab.diagnosis.answer.verdict import Levels
from tendonlab.diagnosis.discrepancy import Patterns
from tendonlab.diagnosis.search.contest import Round
from tendonlab.diagnosis.search.select import Search
from tendonlab.diagnosis.search.workshop import NOTHING
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter


def test_what_the_experiments_state_themselves_is_told(fitter: Fitter, twin_case: Any) -> None:
    """Of gravity, which every experiment knows, no residual says anything; nor is it proposed to be anything else."""
    known = tuple(replace(e, conditions={**e.conditions, "gravity_torque": 1.0}) for e in twin_case.experiments)
    case = replace(twin_case, experiments=known).training_on(twin_case.train[:2])
    fitted = replace(fitter, case=case).fit(case.system, max_iterations=1)
    search = Search(fitter, tuned=fitted, steps=(), rounds=())
    warning = "Held at the nominal value, since a small change leaves every prediction as it is: gravity_torque. "
    assert any(said.startswith(warning) for said in notes.warnings(case, fitter.floor, search))
    rows = notes.details(case, fitter.floor, fitted, search, None)["parameters"]
    assert [name for name, row in rows.items() if not row["informed"]] == ["gravity_torque"]


def test_a_fit_that_did_not_converge_is_a_warning(nominal: Fitted) -> None:
    """Of the refitted simulator and of the final model, each by its own words."""
    tuned = replace(nominal, converged=False, message="too few rounds")
    final = replace(nominal, added=("joint:stribeck",), converged=True)
    (stopped,) = _convergence(tuned, final)
    assert stopped.startswith("The fit of the refitted simulator did not converge: too few rounds. Tuning alone may ")
    assert "and the effects less. If that matters, state nominal values closer to the rig" in stopped
    assert _convergence(replace(tuned, converged=True), final) == []
    _, other = _convergence(tuned, replace(final, converged=False, message="no descent"))
    assert other.startswith("The fit of the model with joint:stribeck did not converge: no descent. Values and")
    (alone,) = _convergence(tuned, tuned)
    assert "and the effects less" not in alone


def _convergence(tuned: Fitted, final: Fitted) -> list[str]:
    search: Any = SimpleNamespace(tuned=tuned, final=final)
    return [note for note in notes._on_the_fits(search) if "converge" in note]


def test_gains_of_a_replay_have_the_units_of_command_over_motion(twin_case: Any) -> None:
    entry = notes.replay(twin_case)
    assert (entry["kind"], entry["kp_unit"], entry["kd_unit"]) == ("controller", "N*m/rad", "N*m*s/rad")


def test_a_held_out_experiment_that_gets_no_better_is_a_warning() -> None:
    gap = pd.DataFrame({"nominal": [9.0, 9.0], "refitted": [2.06, 5.0], "with_effect": [2.09, 1.0]}, index=["a", "b"])
    (warning,) = notes.not_improved(gap, ["joint:stribeck"])
    assert warning.startswith("Held-out experiment a: joint:stribeck does not shrink the gap (2.06 noise floors before")
    assert notes.not_improved(gap, []) == []


def test_an_established_effect_whose_interval_holds_0_is_a_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(notes, "is_nothing", lambda effect, _: effect == "sensor.cable_force_2:delay")
    search: Any = SimpleNamespace(selected=("load:offset", "sensor.cable_force_2:delay"), final=None)
    (said,) = notes._on_wide_intervals(search)
    assert said.startswith("sensor.cable_force_2:delay was established although its 95 % interval holds 0.")


def test_effects_that_no_fit_succeeded_with_or_that_were_not_tried_are_warnings(fitter: Fitter, twin_case: Any) -> None:
    fitted = fitter.fit(twin_case.system, max_iterations=1)
    contest = Round(
        (), (), (), {None: 1.0}, None, set(), failed={"joint:coulomb": "it stopped", "load:offset": NOTHING}
    )
    search = Search(fitter, tuned=fitted, steps=(), rounds=(contest,))
    said = "joint:coulomb could not be weighed, which does not exclude it: it stopped."
    warnings = notes.warnings(twin_case, fitter.floor, search)
    assert said in warnings
    (nothing,) = [w for w in warnings if "load:offset" in w]
    assert nothing.endswith("intervals hold 0, so they do not count: load:offset.")
    (warning,) = notes.not_asked(twin_case, search, ["joint:presliding"])
    assert warning.startswith("Asked for and not tried: joint:presliding (")
    assert notes.not_asked(twin_case, search, None) == []
    assert notes.not_asked(twin_case, search, [next(iter(twin_case.system.effects))]) == []


def test_an_input_has_the_unit_in_which_it_was_logged(twin_case: Any) -> None:
    """A motor command that was logged as a current is no torque."""
    signals = dict(twin_case.dataset.signals)
    signals["motor_torque"] = replace(signals["motor_torque"], si_unit="A")
    current = replace(twin_case, dataset=replace(twin_case.dataset, signals=signals))
    assert notes.units(twin_case)["motor_torque"] == "N*m"
    assert notes.units(current)["motor_torque"] == "A"
    assert notes.units(current)["reference_angle"] == notes.units(current)["motor_angle"] == "rad"
    assert notes.units(current)["known_torque"] == "N*m"  # was not logged


def test_stops_that_noise_decides_are_told() -> None:
    levels = Levels(nominal=9.0, tuned=1.0, refitted=2.0, explained=None, left=2.0, repeated=True)
    assert notes.stops(levels) == []
    (told,) = notes.stops(replace(levels, noise=ByNoise(left=4.0)))
    assert told.startswith("Noise of the logs alone leads a perfect simulator about 2 noise floors (rms) from the")
    assert levels.far_room == pytest.approx(-0.2)
    assert replace(levels, noise=ByNoise(more=1.8)).far_room == pytest.approx(1.24)


def test_an_error_that_is_no_noise_is_explained() -> None:
    near = Levels(
        nominal=9.0, tuned=1.0, refitted=2.0, explained=None, left=2.0, repeated=False, patterns=Patterns(0.1, 0.1)
    )
    assert notes.no_noise(near, selected=False) == []
    (follows,) = notes.no_noise(replace(near, patterns=Patterns(0.45)), selected=False)
    assert "predicts 45 % of its mean square" in follows
    (rings,) = notes.no_noise(replace(near, patterns=Patterns(0.1, 0.5, 6.13)), selected=False)
    assert "the frequencies about 6.1 Hz hold 50 % of its mean square" in rings
    (large,) = notes.no_noise(replace(near, trained=16.0), selected=False)
    assert "is 4 times as large as sensors and friction that differs by 2 % from run to run leave" in large
    (strained,) = notes.no_noise(replace(near, strained=37.2), selected=False)
    assert "Tuning alone needs a parameter 37 stated standard deviations away" in strained
    assert notes.no_noise(replace(near, strained=12.0), selected=True) == []
    (beside,) = notes.no_noise(replace(near, strained=37.2), selected=True)
    assert "Even with the selected effects" in beside
    (differs,) = notes.no_noise(replace(near, scattered=6.25), selected=False)
    assert "friction that differs by 5 % from run to run" in differs


def test_experiments_that_the_verdict_counts_otherwise_than_predicted_are_named(twin_case: Any) -> None:
    floor: Any = SimpleNamespace(rms=np.array([1.0, np.nan, np.nan]))
    told = [np.full((3, 5), size) for size in (3.0, 2.0)]
    predicted, near = (SimpleNamespace(residuals=rows) for rows in (told, [told[0], np.full((3, 5), 1.0)]))
    (warning,) = notes.allowed_more(twin_case, predicted, near, floor, twin_case.test[:2])  # type: ignore[arg-type]
    assert twin_case.experiments[twin_case.test[1]].name in warning
    assert "a gap of 1.7 noise floors. Within the uncertainty of the fit the gap can be 0" in warning
    as_much = SimpleNamespace(residuals=[row - 1e-3 for row in told])  # less, but told as the same numbers
    assert notes.allowed_more(twin_case, predicted, as_much, floor, twin_case.test[:2]) == []  # type: ignore[arg-type]

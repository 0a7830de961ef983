"""Held-out experiments again, within what a fit knows and friction differs from run to run."""

from dataclasses import replace
from typing import Any

import numpy as np

from diagnosis.conftest import SCATTER, measured_as
from tendonlab.diagnosis.answer.allowed import allowed
from tendonlab.diagnosis.answer.heldout import Replayed, rms
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import white


def again(case: Any, fitted: Fitted, ready: Any) -> tuple[np.ndarray, np.ndarray]:
    """Rms errors of a held-out experiment that is measured so: as the model predicts, and as it allows."""
    i = case.test[0]
    case = replace(case, prepared=tuple(ready if k == i else old for k, old in enumerate(case.prepared)))
    start = tuple(case.prepared[i].initial_mean)
    outputs = case.run(i, case.system)["outputs"]
    of = Replayed((case.system,), (start,), (outputs - ready.measured,), (outputs,))
    floor = white(case.noise)
    return rms(of), rms(allowed(case, {"fitted": fitted}, floor, {"fitted": of}, [i])["fitted"])


def test_friction_that_differs_as_it_may_is_no_gap(known: Any) -> None:
    case, fitted = known
    before, after = again(case, fitted, measured_as(case, case.test[0], 1.5 * SCATTER))
    seen = np.isfinite(before)
    assert np.any(before[seen] > 2.0 * case.noise[seen])
    assert np.all(after[seen] < 0.5 * case.noise[seen])


def test_what_suits_best_and_is_improbable_is_not_allowed(known: Any) -> None:
    """Friction 20 times its sd higher suits the run, and the model stays as predicted."""
    case, fitted = known
    before, after = again(case, fitted, measured_as(case, case.test[0], 20.0 * SCATTER))
    assert np.array_equal(before, after, equal_nan=True)


def test_what_the_fit_rules_out_stays_a_gap(known: Any) -> None:
    """A cable with another stiffness, which seven training experiments know: the eighth may move it a little."""
    case, fitted = known
    other = case.system.with_parameters({"cable_stiffness": 1.2 * case.system.parameters["cable_stiffness"]})
    before, after = again(case, fitted, measured_as(case, case.test[0], 0.0, other))
    seen = np.isfinite(before)
    assert np.max(after[seen] / case.noise[seen]) > 0.6 * np.max(before[seen] / case.noise[seen]) > 10.0


def test_an_experiment_at_the_floor_stays_as_it_is(known: Any) -> None:
    case, fitted = known
    before, after = again(case, fitted, measured_as(case, case.test[0], 0.0))
    assert np.array_equal(before, after, equal_nan=True)

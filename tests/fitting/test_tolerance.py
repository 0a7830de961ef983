"""The stepper's tolerance of a case: the loosest at which its error is a tenth of the noise."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.errors import NumericalError
from tendonlab.fitting import case as cases
from tendonlab.fitting.case import TOLERANCES, fine_enough


@pytest.fixture
def errs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two outputs whose errors are the tolerance, and three times the tolerance."""
    wave = np.where(np.arange(100) % 2, 1.0, -1.0)
    monkeypatch.setattr(
        cases, "replace", lambda case, tolerance: SimpleNamespace(**{**vars(case), "tolerance": tolerance})
    )
    monkeypatch.setattr(cases, "_outputs", lambda _, tolerance: [np.array([tolerance * wave, 3.0 * tolerance * wave])])


def case(**more: Any) -> Any:
    return SimpleNamespace(measured=[0, 2], **more)


@pytest.mark.parametrize("wanted", TOLERANCES)
def test_the_error_of_the_worst_output_stays_below_a_tenth_of_its_noise(errs: None, wanted: float) -> None:
    noise = np.array([1.0, np.nan, 31.0 * wanted])
    assert fine_enough(case(), noise).tolerance == wanted


def test_where_no_tolerance_is_fine_enough_the_finest_is_taken(errs: None) -> None:
    assert fine_enough(case(), np.full(3, 1e-30)).tolerance == min(TOLERANCES)
    assert list(TOLERANCES) == sorted(TOLERANCES, reverse=True)


@pytest.mark.parametrize("finest", TOLERANCES)
def test_the_finest_that_runs_is_taken_where_errors_still_fall(finest: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Kinks of inputs forbid a finer reference: what it would tell of the finest tolerance is not known."""

    def outputs(_: Any, tolerance: float) -> list[np.ndarray]:
        if tolerance < finest:
            raise NumericalError("the step fell to 0")
        return [tolerance * np.ones((1, 9))]

    monkeypatch.setattr(
        cases, "replace", lambda case, tolerance: SimpleNamespace(**{**vars(case), "tolerance": tolerance})
    )
    monkeypatch.setattr(cases, "_outputs", outputs)
    assert fine_enough(SimpleNamespace(measured=[0]), np.full(1, 1e-30)).tolerance == finest


def test_where_finer_steps_are_in_vain_the_loosest_of_the_best_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """A contact that falls to either side: the error does not fall with the tolerance, and the finest ones fail."""
    errors = dict(zip(TOLERANCES, (9.0, 1.5, 1.0, 3.0, 0.0), strict=True))

    def outputs(_: Any, tolerance: float) -> list[np.ndarray]:
        if tolerance < min(TOLERANCES):
            raise NumericalError("the step fell to 0")
        return [errors[tolerance] * np.ones((1, 9))]

    monkeypatch.setattr(
        cases, "replace", lambda case, tolerance: SimpleNamespace(**{**vars(case), "tolerance": tolerance})
    )
    monkeypatch.setattr(cases, "_outputs", outputs)
    assert fine_enough(SimpleNamespace(measured=[0]), np.ones(1)).tolerance == TOLERANCES[1]


def test_the_reference_is_a_hundredth_of_the_finest_or_what_the_inputs_allow(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = []

    def outputs(_: Any, tolerance: float) -> list[np.ndarray]:
        tried.append(tolerance)
        if tolerance < min(TOLERANCES):
            raise NumericalError("the step fell to 0")
        return []

    monkeypatch.setattr(cases, "_outputs", outputs)
    cases._finest(case())
    assert tried == pytest.approx([TOLERANCES[-1] / 100, TOLERANCES[-1] / 10, TOLERANCES[-1]])

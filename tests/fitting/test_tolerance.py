"""The stepper's tolerance of a case: the loosest at which its error is a twentieth of the noise."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.errors import NumericalError
from tendonlab.fitting import case as cases
from tendonlab.fitting import problem as problems
from tendonlab.fitting.case import TOLERANCES, fine_enough


def case(**more: Any) -> Any:
    """A case whose simulator takes 7 and 9 attempts of the stepper."""
    runs = [{"attempts": 7}, {"attempts": 9}]
    given = {"measured": [0, 2], "train": (0, 1), "system": None, "run": lambda i, system: runs[i]}
    return SimpleNamespace(**given | more)


def replaced(case: Any, **changes: Any) -> Any:
    return SimpleNamespace(**vars(case) | changes)


@pytest.fixture
def errs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two outputs whose errors are the tolerance, and three times the tolerance."""
    wave = np.where(np.arange(100) % 2, 1.0, -1.0)
    monkeypatch.setattr(cases, "replace", replaced)
    monkeypatch.setattr(cases, "_outputs", lambda _, tolerance: [np.array([tolerance * wave, 3.0 * tolerance * wave])])


@pytest.mark.parametrize("wanted", TOLERANCES)
def test_the_error_of_the_worst_output_stays_below_a_twentieth_of_its_noise(errs: None, wanted: float) -> None:
    noise = np.array([1.0, np.nan, 61.0 * wanted])
    found = fine_enough(case(), noise)
    assert (found.tolerance, found.num_attempts) == (wanted, 9)


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

    monkeypatch.setattr(cases, "replace", replaced)
    monkeypatch.setattr(cases, "_outputs", outputs)
    assert fine_enough(case(measured=[0]), np.full(1, 1e-30)).tolerance == finest


def test_where_finer_steps_are_in_vain_the_loosest_of_the_best_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """A contact that falls to either side: the error does not fall with the tolerance, and the finest ones fail."""
    errors = dict(zip(TOLERANCES, (9.0, 1.5, 1.0, 3.0, 0.0), strict=True))

    def outputs(_: Any, tolerance: float) -> list[np.ndarray]:
        if tolerance < min(TOLERANCES):
            raise NumericalError("the step fell to 0")
        return [errors[tolerance] * np.ones((1, 9))]

    monkeypatch.setattr(cases, "replace", replaced)
    monkeypatch.setattr(cases, "_outputs", outputs)
    assert fine_enough(case(measured=[0]), np.ones(1)).tolerance == TOLERANCES[1]


@pytest.mark.parametrize(
    ("tied", "taken"),
    [((0.30, 0.28, 0.27), 0), ((0.30, 0.15, 0.14), 3), ((0.30, 0.29, 0.02), 2), ((0.60, 0.58, 0.57), 3)],
)
def test_finer_steps_are_not_taken_where_an_experiment_hangs_on_a_tie(
    tied: tuple[float, ...], taken: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether a part just comes to rest or just does not: its error stays until steps are very fine."""
    errors = dict(zip(TOLERANCES, (*tied, 0.01, 0.001), strict=True))

    def outputs(_: Any, tolerance: float) -> list[np.ndarray]:
        return [tolerance * np.ones((1, 9)), errors.get(tolerance, 0.0) * np.ones((1, 9))]

    monkeypatch.setattr(cases, "replace", replaced)
    monkeypatch.setattr(cases, "_outputs", outputs)
    assert fine_enough(case(measured=[0]), np.ones(1)).tolerance == TOLERANCES[taken]


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


@pytest.mark.parametrize(("needed", "allowed"), [(0, 13_000), (1_000, 13_000), (5_000, 50_000)])
def test_a_stiff_simulator_may_take_ten_times_the_attempts_that_it_needs(
    needed: int, allowed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cases._core, "Settings", SimpleNamespace)
    ready = SimpleNamespace(measured=np.zeros((1, 100)), position_scale=1.0, velocity_scale=1.0)
    given = case(prepared=[ready], tolerance=1e-4, num_attempts=needed)
    assert cases.Case.settings(given).max_attempts == allowed


class Ends:
    """A problem whose simulator needs these tolerances, one after the other, where its fits end."""

    def __init__(self, *needed: float) -> None:
        self.needed, self.solves = list(needed), 0
        self.case = SimpleNamespace(tolerance=1e-4, noise=None, num_attempts=1, system="start")

    def at(self, system: str, initial: tuple[float, ...]) -> "Ends":
        assert (system, initial) == ("end", (0.5,))
        return self

    def solve(self, *, cancel: Any) -> Any:
        self.solves += 1
        return SimpleNamespace(system="end", initial=(0.5,), solves=self.solves)


@pytest.mark.parametrize(
    ("needed", "solves", "ends"),
    [([1e-4], 0, 1e-4), ([1e-3], 0, 1e-4), ([1e-6, 1e-6], 1, 1e-6), ([1e-5, 1e-7, 1e-7], 2, 1e-7)],
)
def test_a_fit_goes_on_until_it_is_fine_enough_where_it_ends(
    needed: list[float], solves: int, ends: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = Ends(*needed)

    def judged(case: Any, noise: Any) -> Any:
        assert case.system == "end"
        return SimpleNamespace(tolerance=problem.needed.pop(0), num_attempts=9)

    def changed(of: Any, **changes: Any) -> Any:
        if of is problem:
            problem.case = changes["case"]
            return problem
        return replaced(of, **changes)

    monkeypatch.setattr(problems, "replace", changed)
    monkeypatch.setattr(problems, "fine_enough", judged)
    start = SimpleNamespace(system="end", initial=(0.5,), solves=0)
    finer, fit = problems.finer(problem, start, _core.Cancel())  # type: ignore[arg-type]
    assert (fit.solves, finer.case.tolerance) == (solves, ends)  # type: ignore[attr-defined]

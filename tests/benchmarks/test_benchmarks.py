"""The benchmarks compare answers to the same question, and write their tables where they belong."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks import mass, mechanism, ours, page
from benchmarks.accuracy import Setting, cheapest, error, scan
from benchmarks.comparison import COLUMNS, Contender, compare, rows
from benchmarks.fit import EASY, REACHED, SIX
from benchmarks.fitters import free_run
from benchmarks.peers import scipys
from benchmarks.problem import Problem
from benchmarks.sweep import Sweep, masses, mechanisms
from benchmarks.table import Table, ratio_text, seconds_text

SAME = 1e-5  # relative error that both sides keep at the tolerances below

PROBLEMS = (
    mass.driven(force=False),
    mass.driven(force=True),
    mass.dragged(),
    mechanism.coupled(tensions=True, duration=1.5),
)


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda problem: problem.name)
def test_the_library_agrees_with_lsoda_on_the_equations_of_the_peers(problem: Problem) -> None:
    expected = scipys.reference(problem, 1e-9)
    assert error(ours.core_call(problem, 1e-8)(), expected) < SAME


@pytest.mark.parametrize("sweep", [masses(3), mechanisms(2, duration=0.5)], ids=["masses", "mechanisms"])
def test_a_point_of_a_sweep_is_the_same_simulation_for_all_tools(sweep: Sweep) -> None:
    found = sweep.read_call(1e-8)()
    expected = scipys.reference(replace(sweep.problem, parameters=sweep.points[-1]), 1e-9)
    assert found.shape == (len(sweep.points), *expected.shape)
    assert error(found[-1], expected) < SAME


def test_the_error_is_that_of_the_worst_output() -> None:
    reference = np.array([[3.0, 1.0], [4.0, 1.0]])
    assert error(reference + np.array([0.0, 0.1]), reference) == pytest.approx(0.1)
    assert np.isnan(error(np.full((2, 2), np.nan), reference))


def test_a_lucky_loose_setting_is_not_chosen() -> None:
    """0.1 keeps the error by chance: 0.01 does not."""
    errors = {0.1: 1e-4, 0.01: 1e-2, 1e-3: 5e-4, 1e-4: 2e-3, 1e-5: 9e-4, 1e-6: 1e-5}
    settings = [Setting(tolerance, e, 1.0) for tolerance, e in errors.items()]
    chosen = cheapest(settings, 1e-3)
    assert chosen is not None
    assert chosen.tolerance == 1e-5
    assert cheapest(settings, 1e-6) is None


def test_a_scan_ends_when_the_error_is_far_below_all_targets_and_survives_failures() -> None:
    def call_at(tolerance: float):  # type: ignore[no-untyped-def]
        def call() -> np.ndarray:
            if tolerance > 0.5:
                raise ValueError("too coarse")
            return np.array([tolerance])

        return call

    settings = scan(call_at, lambda found: float(found[0]), [1.0, 1e-3, 1e-7, 1e-8, 1e-9])
    assert [s.tolerance for s in settings] == [1.0, 1e-3, 1e-7, 1e-8]
    assert np.isnan(settings[0].error)


def test_a_missing_tool_is_skipped_and_its_row_says_so() -> None:
    def call_at(tolerance: float):  # type: ignore[no-untyped-def]
        return lambda: np.array([tolerance])

    contenders = [Contender("a", call_at, (1e-4, 1e-8, 1e-9)), Contender("b", call_at, (), ("nowhere",))]
    found = rows("job", contenders, compare(contenders, lambda f: float(f[0]), rounds=1))
    assert found[0][:3] == ("job", "a", "1e-04 (1e-04)")
    assert found[1][:3] == ("job", "b", "skipped: nowhere not installed")
    assert all(len(row) == len(COLUMNS) + 2 for row in found)


def test_tables_are_written_between_their_marks() -> None:
    text = Table(("a", "b"), (("1", "x|y"),), ("A note.",), "Title").markdown()
    assert text == "### Title\n\n| a | b |\n| --- | --- |\n| 1 | x\\|y |\n\nA note.\n"
    before = "# Page\n<!-- one -->\nold\n<!-- end of one -->\nrest\n"
    after = page.placed(before, "one", text)
    assert after == f"# Page\n<!-- one -->\n\n{text}\n<!-- end of one -->\nrest\n"
    assert page.placed(after, "one", text) == after
    with pytest.raises(ValueError, match="no marks of 'two'"):
        page.placed(before, "two", text)
    with pytest.raises(ValueError, match="1 cells"):
        Table(("a", "b"), (("1",),))


@pytest.mark.parametrize(
    ("seconds", "text"), [(1.5, "1.5 s"), (0.0123, "12.3 ms"), (3.54e-5, "35.4 µs"), (2e-7, "200 ns")]
)
def test_times_are_given_in_the_unit_that_suits(seconds: float, text: str) -> None:
    assert seconds_text(seconds) == text


def test_ratios_have_two_or_three_digits() -> None:
    assert [ratio_text(r) for r in (0.876, 12.34, 1234.5, float("nan"))] == ["0.876×", "12.3×", "1 234×", "–"]


def test_a_fit_is_right_for_an_exact_simulation_too() -> None:
    """The tolerance that is fine at this start lets a fit explain noise by the stepper's error: 1.10 without a second
    look where it ended."""
    point = EASY.problem.parameters.copy()
    point[SIX] = free_run(EASY, 3)()
    exact = scipys.reference(replace(EASY.problem, parameters=point))
    assert np.mean(EASY.residual(exact) ** 2) < REACHED

"""What an exact gradient costs, in plain simulations of the same problem at the same tolerance."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import tendonlab as tl
from benchmarks import mass, mechanism
from benchmarks.clock import Call, alternate
from benchmarks.options import Options
from benchmarks.ours import core_call
from benchmarks.problem import Problem
from benchmarks.table import Table, ratio_text, seconds_text
from tendonlab.fitting.case import Case, make_case
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import pose

RIG = Path(__file__).resolve().parents[3] / "data" / "two_inertia"
TOLERANCES = (1e-4, 1e-6)
COLUMNS = ("job", "directions", "tolerance", "plain", "with gradient", "ratio")
NOTES = (
    "The fit differentiates each of the rig's training experiments by all free parameters and by that experiment's "
    "initial state, and whitens the residuals; plain is the simulation of the same experiments.",
)


def run(options: Options) -> list[Table]:
    found = [
        *_rows(mass.driven(force=False), tuple(mass.FRICTION), options.rounds),
        *_rows(mechanism.coupled(tensions=True), mechanism.SIX, options.rounds),
        *_fit_rows(options.rounds),
    ]
    return [Table(COLUMNS, tuple(found), NOTES)]


def _rows(problem: Problem, names: tuple[str, ...], rounds: int) -> list[tuple[str, ...]]:
    known = [p.name for p in problem.system.info.parameters]
    seeds = [("parameter", known.index(name)) for name in names]
    return [
        _row(problem.name, f"{len(seeds)} parameters", tolerance, calls, rounds)
        for tolerance in TOLERANCES
        for calls in [(core_call(problem, tolerance), core_call(problem, tolerance, seeds))]
    ]


def _fit_rows(rounds: int) -> list[tuple[str, ...]]:
    rig = tl.load(RIG)
    return [_fit_row(make_case(rig, tolerance=tolerance), rounds) for tolerance in TOLERANCES]


def _fit_row(case: Case, rounds: int) -> tuple[str, ...]:
    problem = pose(case, white(case.noise), case.system)
    num_initial = len(case.prepared[case.train[0]].initial)
    text = f"{len(problem.free)} parameters, {num_initial} initial states"
    calls = (partial(_simulate_all, case), problem.linearise)
    return _row(f"two-inertia fit, {len(case.train)} experiments", text, case.tolerance, calls, rounds)


def _simulate_all(case: Case) -> None:
    for i in case.train:
        case.run(i, case.system)


def _row(text: str, directions: str, tolerance: float, calls: tuple[Call, Call], rounds: int) -> tuple[str, ...]:
    plain, gradient = alternate(calls, rounds=rounds)
    cells = (f"{tolerance:.0e}", seconds_text(plain), seconds_text(gradient), ratio_text(gradient / plain))
    return (text, directions, *cells)

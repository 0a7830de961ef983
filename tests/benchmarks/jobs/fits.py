"""J4: success and CPU seconds of fits from several starts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from benchmarks.clock import cpu_seconds
from benchmarks.fit import EASY, HARD, REACHED, SIX, Fit
from benchmarks.fitters import OURS, PEERS, Fitter
from benchmarks.options import Options
from benchmarks.peers import scipys
from benchmarks.table import Table, ratio_text, seconds_text

COLUMNS = ("starts", "tool", "reached", "CPU time, median", "ratio")
NOTES = (
    "Six friction parameters of J1a from position and velocity at 1 kHz over 1 s, from starts within ±5 % "
    "(noise 1e-6 m, 3e-4 m/s) and ±25 % (1e-7 m, 3e-5 m/s). Reached: the mean square residual of an exact simulation "
    f"at the fitted values is below {REACHED} of the noise. The ratio is over the first row's time, each tool by the "
    "starts that it reached, or by all in brackets if it reached none; preparing the data (15 ms in tendonlab) is not "
    "counted. "
    "Peers differentiate by finite differences of q in P = P0 exp(q - 1).",
)

Outcome = tuple[bool, float]  # was the optimum reached, and the CPU time, s


def run(options: Options) -> list[Table]:
    found = []
    for text, fit in (("±5 %", EASY), ("±25 %", HARD)):
        found += _rows(text, fit, options.starts)
    return [Table(COLUMNS, tuple(found), NOTES)]


def _rows(text: str, fit: Fit, starts: int) -> list[tuple[str, ...]]:
    outcomes: dict[str, list[Outcome]] = {f.name: [] for f in (*OURS, *PEERS)}
    present = [f for f in (*OURS, *PEERS) if not f.missing]
    for fitter in present:  # compiles and loads
        fitter.solver(fit, starts)()
    for seed in range(starts):
        for fitter in present:
            if seed < fitter.most:
                outcomes[fitter.name].append(_outcome(fit, fitter, seed))
    medians = {name: _median(of) for name, of in outcomes.items()}
    first = medians[OURS[0].name]
    return [
        (text, f.name, _reached(f, outcomes[f.name]), *_times(outcomes[f.name], medians[f.name], first))
        for f in (*OURS, *PEERS)
    ]


def _times(outcomes: list[Outcome], median: float, first: float) -> tuple[str, str]:
    """Median and ratio; in brackets where no start was reached."""
    cells = (seconds_text(median), ratio_text(median / first))
    failed = bool(outcomes) and not any(reached for reached, _ in outcomes)
    return (f"({cells[0]})", f"({cells[1]})") if failed else cells


def _outcome(fit: Fit, fitter: Fitter, seed: int) -> Outcome:
    point = fit.problem.parameters.copy()

    solver = fitter.solver(fit, seed)

    def solve() -> None:
        point[SIX] = solver()

    seconds = cpu_seconds(solve)
    outputs = scipys.reference(replace(fit.problem, parameters=point))
    return bool(np.mean(fit.residual(outputs) ** 2) < REACHED), seconds


def _median(outcomes: list[Outcome]) -> float:
    """Of the starts that were reached; of all if none was."""
    spent = [seconds for reached, seconds in outcomes if reached] or [seconds for _, seconds in outcomes]
    return float(np.median(spent)) if spent else math.nan


def _reached(fitter: Fitter, outcomes: list[Outcome]) -> str:
    if fitter.missing:
        return f"skipped: {', '.join(fitter.missing)} not installed"
    return f"{sum(reached for reached, _ in outcomes)} of {len(outcomes)}"

"""Many simulations: masses and mechanisms with drawn parameters through `tl.sweep`, at equal median error.

Settings are found on the first points of each sweep and timed on all of them; diffrax is timed on fewer."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from benchmarks.accuracy import median_error
from benchmarks.comparison import COLUMNS, Contender, compare, rows
from benchmarks.options import Options
from benchmarks.peers import diffraxes, scipys, soda
from benchmarks.sweep import Sweep, masses, mechanisms
from benchmarks.table import Table, count_text
from benchmarks.tool import FINE

MOST_ROUNDS = 5  # a round of all points takes seconds
JUDGED_MASSES, JUDGED_MECHANISMS = 40, 8  # points on which settings are found
NOTES = (
    "Time per simulation, all outputs kept. J1: position and velocity; J2: the angle and the friction of a contact. "
    "numbalsoda runs in a loop that numba compiled. diffrax maps over "
    f"{diffraxes.POINTS} points by `jax.vmap`; its compilation is not counted.",
)


def run(options: Options) -> list[Table]:
    rounds = min(options.rounds, MOST_ROUNDS)
    small = masses(diffraxes.POINTS)
    found = [
        *_rows(
            f"J1, {count_text(options.points)} points",
            masses(options.points),
            JUDGED_MASSES,
            rounds,
            diffraxes.contenders(small),
        ),
        *_rows(
            f"J2, {count_text(options.mechanisms)} points", mechanisms(options.mechanisms), JUDGED_MECHANISMS, rounds
        ),
    ]
    return [Table(("job", "tool", *COLUMNS), tuple(found), NOTES)]


def _rows(
    text: str, sweep: Sweep, num_judged: int, rounds: int, more: tuple[Contender, ...] = ()
) -> list[tuple[str, ...]]:
    contenders = [*_contenders(sweep, num_judged), *more]
    points = sweep.points[:num_judged]
    truth = np.stack([scipys.reference(replace(sweep.problem, parameters=p)) for p in points])
    measured = compare(contenders, lambda found: median_error(found[: len(truth)], truth), rounds=rounds)
    return rows(text, contenders, measured)


def _contenders(sweep: Sweep, num_judged: int) -> list[Contender]:
    first, problem, num = sweep.first(num_judged), sweep.problem, len(sweep.points)
    by_soda = [partial(soda.sweep_call, problem, points) for points in (first.points, sweep.points)]
    return [
        Contender("tendonlab, tl.sweep", first.read_call, FINE, (), sweep.call, num),
        Contender(soda.SCALED.name, by_soda[0], FINE, soda.SCALED.missing, by_soda[1], num),
    ]

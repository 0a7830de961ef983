"""One simulation at a time: J1a, J1b and J2 by every tool, at equal error."""

from __future__ import annotations

from functools import partial

from benchmarks import mass, mechanism, ours
from benchmarks.accuracy import error
from benchmarks.comparison import COLUMNS, Contender, Measured, compare, rows
from benchmarks.options import Options
from benchmarks.peers import natives, scipys, soda, sundials
from benchmarks.plot import draw
from benchmarks.problem import Problem
from benchmarks.table import Table

TOOLS = (ours.TOOL, soda.SCALED, soda.PLAIN, *natives.TOOLS, *scipys.TOOLS, sundials.TOOL)
PROBLEMS = (
    mass.driven(force=False),
    mass.driven(force=True),
    mass.dragged(),
    mechanism.coupled(tensions=False),
    mechanism.coupled(tensions=True),
)
NOTES = (
    "; ".join(f"{p.name}: {p.text}" for p in PROBLEMS) + ". Outputs at 1 kHz. In brackets the error at that tolerance. "
    "The ratio is the tool's CPU time over tendonlab's.",
)


def run(options: Options) -> list[Table]:
    """A table of all problems, and the work–precision figure."""
    found: list[tuple[str, ...]] = []
    measured: dict[str, Measured] = {}
    for problem in PROBLEMS:
        contenders = [Contender(t.name, partial(t.call, problem), t.tolerances, t.missing) for t in TOOLS]
        measured[problem.name] = _measure(problem, contenders, options)
        found += rows(problem.name, contenders, measured[problem.name])
    draw({name: measured[name].settings for name in ("J1a with force", "J1b", "J2")})
    return [Table(("job", "tool", *COLUMNS), tuple(found), NOTES)]


def _measure(problem: Problem, contenders: list[Contender], options: Options) -> Measured:
    truth = scipys.reference(problem)
    return compare(contenders, lambda found: error(found, truth), rounds=options.rounds)

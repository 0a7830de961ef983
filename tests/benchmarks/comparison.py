"""Tools compared at equal error."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.accuracy import TARGETS, Setting, cheapest, scan
from benchmarks.clock import Call, alternate
from benchmarks.table import ratio_text, seconds_text

COLUMNS = ("error ≤ 1e-3: tolerance", "time", "ratio", "error ≤ 1e-6: tolerance", "time", "ratio")


@dataclass(frozen=True)
class Contender:
    """A tool at one problem: `call_at(tolerance)` gives a call whose result is compared with the reference. `timed_at`:
    the call that is timed, if it is another one; it makes `runs` simulations."""

    name: str
    call_at: Callable[[float], Call]
    tolerances: Sequence[float]
    missing: tuple[str, ...] = ()
    timed_at: Callable[[float], Call] | None = None
    runs: int = 1

    def timed(self, setting: Setting) -> Call:
        return (self.timed_at or self.call_at)(setting.tolerance)


@dataclass(frozen=True)
class Measured:
    """`settings`: the scans by tool. `times`: for each target, by tool, the setting and the CPU time, s, of a run."""

    settings: Mapping[str, Sequence[Setting]]
    times: Mapping[float, Mapping[str, tuple[Setting, float]]]


def compare(contenders: Sequence[Contender], judge: Callable[[np.ndarray], float], *, rounds: int) -> Measured:
    """Scan every tool, then time its cheapest setting for each target, taking turns with the others."""
    present = [c for c in contenders if not c.missing]
    scans = {c.name: scan(c.call_at, judge, c.tolerances) for c in present}
    times = {}
    for target in TARGETS:
        chosen = [(c, found) for c in present if (found := cheapest(scans[c.name], target)) is not None]
        spent = alternate([c.timed(s) for c, s in chosen], rounds=rounds)
        times[target] = {c.name: (s, least / c.runs) for (c, s), least in zip(chosen, spent, strict=True)}
    return Measured(scans, times)


def rows(text: str, contenders: Sequence[Contender], measured: Measured) -> list[tuple[str, ...]]:
    """A row per tool: for each target the tolerance, the time of a simulation, and its ratio to the first tool's."""
    ours = contenders[0].name
    return [(text, c.name, *_cells(c, ours, measured)) for c in contenders]


def _cells(contender: Contender, ours: str, measured: Measured) -> list[str]:
    if contender.missing:
        return [f"skipped: {', '.join(contender.missing)} not installed", *["–"] * (len(COLUMNS) - 1)]
    cells: list[str] = []
    for target in TARGETS:
        setting, seconds = measured.times[target].get(contender.name, (None, math.nan))
        base = measured.times[target].get(ours, (None, math.nan))[1]
        tolerance = "not reached" if setting is None else f"{setting.tolerance:.0e} ({setting.error:.0e})"
        cells += [tolerance, seconds_text(seconds), ratio_text(seconds / base)]
    return cells

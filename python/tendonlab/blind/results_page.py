"""The page of blind results: Markdown with tables, figures and every wrong answer."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import pandas as pd

from tendonlab.rehearsal.tally import Share
from tendonlab.report.numbers import counted
from tendonlab.version import version

from .calibrating import by_system, results_on, spreads_on
from .results import Mean, Results
from .results_figures import pictures

PAGE = "blind-results.md"
FIGURES = "figures"
NORMAL = 1.96  # standard deviations on either side hold 95 %
LEAST_CASES = 5  # of a kind of rig, to tell how true its probabilities are


def write(found: Results, folder: Path, command: str) -> Path:
    """Write the page, with its figures in `figures`; `command`: the one that made it. Returns the page."""
    figures = folder / FIGURES
    figures.mkdir(parents=True, exist_ok=True)
    drawn = pictures(found)
    for picture in drawn:
        (figures / f"{picture.name}.svg").write_text(picture.svg, encoding="utf-8")
    page = folder / PAGE
    images = {p.name: f"![{p.alt}]({FIGURES}/{p.name}.svg)" for p in drawn}
    page.write_text("\n\n".join(_sections(found, images, command)) + "\n", encoding="utf-8")
    return page


def _sections(found: Results, images: dict[str, str], command: str) -> Iterable[str]:
    parts = found.parts
    columns = [f"{name} ({counted(len(cases), 'rig')})" for name, cases in parts.items()]
    yield "# Blind results"
    yield f"{counted(len(found.cases), 'rig')}. Written by tendonlab {version()} with"
    yield f"    {command}"
    intervals = "Shares with their number of cases and 95 % intervals (Clopper–Pearson)."
    yield f"{intervals} [The protocol](blind.md) says what is drawn and what counts."
    yield "## Shares"
    yield _table(["quantity", *columns], [[q, *map(_share, both)] for q, both in found.shares().items()])
    means = found.means()
    if means:
        yield "Means with 95 % intervals by bootstrap of the rigs; where all rigs have 0, or all 1, Clopper–Pearson."
        yield _table(["mean", *columns], [[q, *map(_mean, both)] for q, both in means.items()])
    yield "## Verdicts"
    rows = [[name, *map(_share, both)] for name, both in found.by_system().items()]
    yield _table(["verdict right", *columns], rows)
    confusion = found.confusion()
    yield _table(["truth (rows), reported (columns)", *confusion.columns], [[n, *r] for n, r in confusion.iterrows()])
    if len(found.single()):
        yield "## Strength of the missing effect"
        yield images["blind-strength"]
    confused = found.confused_effects()
    if confused:
        yield "## Effects reported in place of the true one"
        yield "Where the most probable effect is a wrong one: the first that was selected; the verdict where none was."
        yield _table(["missing effect", "reported first instead"], [_confused(n, *of) for n, of in confused.items()])
    yield from _probabilities(found, images)
    yield "## Wrong answers"
    yield "A right effect in another form than the library's, found under `unknown_effect`, counts as right here."
    columns = ["case", "system", "repeats", "missing", "gap/noise", "verdict reported", "selected"]
    yield _table(columns, [_miss(str(name), case) for name, case in found.misses().iterrows()])


def _probabilities(found: Results, images: dict[str, str]) -> Iterable[str]:
    yield "## Probabilities"
    if not found.map_is_shipped:
        yield "Here the probabilities are those of the fitted map; above they are those that the reports state."
    yield images["blind-reliability"]
    which = "shipped" if found.map_is_shipped else "fitted"
    yield (
        f"How true the probabilities of the {which} map are. Each cell: share that came true; mean probability stated; "
        "calibration error beyond what chance shows at this number, with its 95 % interval (normal, spread by "
        "bootstrap of the rigs); Spiegelhalter's z; reliability slope."
    )
    yield _table(["kind of rig", "cases", "verdicts", "effects"], list(_calibration(found)))


def _calibration(found: Results) -> Iterable[list[object]]:
    for repeats in (False, True):
        of = found.map_of(repeats=repeats)
        mine = [case for case in found.judged if case.repeats == repeats]
        for name, group in {"all": mine, **by_system(mine)}.items():
            if len(group) >= LEAST_CASES:
                stated, spread = results_on(group, of), spreads_on(group, of)
                title = f"{name}, {'with' if repeats else 'without'} repeats"
                yield [title, len(group), *(_true(stated[kind], spread[kind]) for kind in ("verdicts", "effects"))]


def _true(stated: dict[str, float], spread: float) -> str:
    error = stated["calibration error beyond chance"]
    cells = [f"{stated[name]:.2f}" for name in ("came true", "mean probability")]
    cells += [f"{error:.3f} ({error - NORMAL * spread:.3f} to {error + NORMAL * spread:.3f})"]
    cells += [f"{stated['z']:.1f}", f"{stated['reliability slope']:.2f}"]
    return "; ".join(cells).replace("-", "−")


def _confused(effect: str, num: int, reported: dict[str, int]) -> list[object]:
    wrong = ", ".join(f"{name} {count}" for name, count in reported.items())
    return [effect, f"{sum(reported.values())} of {num}: {wrong}"]


def _mean(of: Mean) -> str:
    if not of.num:
        return "–"
    interval = f"{of.ci95[0]:.2f}–{of.ci95[1]:.2f}; " if of.ci95 else ""
    return f"{of.mean:.2f} ({interval}of {counted(of.num, 'rig')})"


def _miss(name: str, case: pd.Series) -> list[object]:
    cause = case["cause"] if pd.notna(case["cause"]) else None
    missing = case["effect"] or cause or case["truth"].replace("_", " ")
    gap = f"{case['gap_noise']:.2g}" if pd.notna(case["gap_noise"]) else "–"
    with_repeats = "yes" if case["repeats"] else "no"
    reported = [case["verdict"], case["selected"].replace(",", ", ") or "–"]
    return [name, case["system"], with_repeats, str(missing).replace(",", ", "), gap, *reported]


def _share(of: Share) -> str:
    if not of.num:
        return "–"
    low, high = (100.0 * end for end in of.ci95)
    return f"{of.hits} of {of.num} ({low:.0f}–{high:.0f} %)"


def _table(columns: Sequence[object], rows: Iterable[Sequence[object]]) -> str:
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)

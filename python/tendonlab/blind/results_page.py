"""The page of blind results: Markdown with tables, figures and every wrong answer."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import pandas as pd

from tendonlab.rehearsal.tally import Share
from tendonlab.version import version

from .calibrating import by_system, results_on
from .results import Results
from .results_figures import pictures

PAGE = "blind-results.md"
FIGURES = "figures"
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
    columns = [f"{name} ({len(cases)} rigs)" for name, cases in parts.items()]
    yield "# Blind results"
    yield f"{len(found.cases)} rigs. Written by tendonlab {version()} with"
    yield f"    {command}"
    intervals = "Shares with their number of cases and 95 % intervals (Clopper–Pearson)."
    yield f"{intervals} [The protocol](blind.md) says what is drawn and what counts."
    yield "## Shares"
    yield _table(["quantity", *columns], [[q, *map(_share, both)] for q, both in found.shares().items()])
    means = found.means()
    rows = [[q, *(f"{mean:.2f} (of {num} rigs)" if num else "–" for mean, num in both)] for q, both in means.items()]
    if rows:
        yield _table(["mean", *columns], rows)
    yield "## Verdicts"
    rows = [[name, *map(_share, both)] for name, both in found.by_system().items()]
    yield _table(["verdict right", *columns], rows)
    confusion = found.confusion()
    yield _table(["truth (rows), told (columns)", *confusion.columns], [[n, *r] for n, r in confusion.iterrows()])
    if len(found.single()):
        yield "## Strength of the missing effect"
        yield images["blind-strength"]
    yield "## Probabilities"
    yield images["blind-reliability"]
    which = "the shipped map" if found.map_is_shipped else "the map that was fitted (the shares above: as reported)"
    yield (
        f"How true the probabilities of {which} are. Each cell: share that came true; mean probability stated; "
        "calibration error beyond what chance shows at this number; Spiegelhalter's z; reliability slope."
    )
    yield _table(["kind of rig", "cases", "verdicts", "effects"], list(_calibration(found)))
    yield "## Wrong answers"
    yield "A right effect in another form than the library's, found under `unknown_effect`, counts as right here."
    columns = ["case", "system", "repeats", "missing", "gap/noise", "verdict told", "selected"]
    yield _table(columns, [_miss(str(name), case) for name, case in found.misses().iterrows()])


def _calibration(found: Results) -> Iterable[list[object]]:
    for repeats in (False, True):
        of = found.map_of(repeats=repeats)
        mine = [case for case in found.judged if case.repeats == repeats]
        for name, group in {"all": mine, **by_system(mine)}.items():
            if len(group) >= LEAST_CASES:
                told = results_on(group, of)
                title = f"{name}, {'with' if repeats else 'without'} repeats"
                yield [title, len(group), *(_true(told[kind]) for kind in ("verdicts", "effects"))]


def _true(told: dict[str, float]) -> str:
    names = ("came true", "mean probability", "calibration error beyond chance", "z", "reliability slope")
    digits = (2, 2, 3, 1, 2)
    return "; ".join(f"{told[name]:.{n}f}" for name, n in zip(names, digits, strict=True)).replace("-", "−")


def _miss(name: str, case: pd.Series) -> list[object]:
    cause = case["cause"] if pd.notna(case["cause"]) else None
    missing = case["effect"] or cause or case["truth"].replace("_", " ")
    gap = f"{case['gap_noise']:.2g}" if pd.notna(case["gap_noise"]) else "–"
    with_repeats = "yes" if case["repeats"] else "no"
    told = [case["verdict"], case["selected"].replace(",", ", ") or "–"]
    return [name, case["system"], with_repeats, str(missing).replace(",", ", "), gap, *told]


def _share(of: Share) -> str:
    if not of.num:
        return "–"
    low, high = (100.0 * end for end in of.ci95)
    return f"{of.hits} of {of.num} ({low:.0f}–{high:.0f} %)"


def _table(columns: Sequence[object], rows: Iterable[Sequence[object]]) -> str:
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)

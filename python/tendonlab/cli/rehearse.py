"""The command `rehearse`: its options, and what it found as text."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tendonlab.rehearsal.result import Rehearsal
    from tendonlab.report.blocks import Table


def add_parser(commands: Any) -> None:
    """Add the command to the subparsers of `tendonlab`."""
    text = "simulate rigs like yours that lack one effect each, and count which effects a diagnosis would find"
    parser: argparse.ArgumentParser = commands.add_parser("rehearse", help=text, description=text)
    parser.set_defaults(run=_rehearse)
    parser.add_argument("dataset", type=Path, metavar="DATASET", help="folder with dataset.toml")
    parser.add_argument("--plan", type=Path, metavar="FILE.toml", help="experiments that are not made yet")
    parser.add_argument("--effects", nargs="+", metavar="EFFECT", help="only these; default: all that may be missing")
    sizes = "gaps over noise that an effect leaves; default: 0.1 0.2 0.5 1 2 5"
    parser.add_argument("--sizes", nargs="+", type=float, metavar="GAP", help=sizes)
    parser.add_argument("--repeats-per-size", type=int, default=6, metavar="N", help="rigs per size; default: 6")
    parser.add_argument("--minutes", type=float, default=15.0, metavar="M", help="time for it; default: 15")
    parser.add_argument("--jobs", type=int, metavar="N", help="processes; default: one per processor")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="default: 0; same seed, same rigs")
    parser.add_argument("--out", type=Path, metavar="DIR", help="store each case and write the page here; resumes")
    parser.add_argument("--quiet", action="store_true", help="show no progress")


def _rehearse(given: argparse.Namespace) -> int:
    from tendonlab.rehearsal.rehearse import SIZES, rehearse

    found = rehearse(
        given.dataset,
        plan=given.plan,
        effects=given.effects,
        sizes=SIZES if given.sizes is None else given.sizes,
        repeats_per_size=given.repeats_per_size,
        minutes=given.minutes,
        jobs=len(os.sched_getaffinity(0)) if given.jobs is None else given.jobs,
        seed=given.seed,
        out=given.out,
        progress=not given.quiet,
    )
    print(rehearsal_text(found))
    written = "none written; --out DIR writes one" if given.out is None else found.report(given.out)
    print(f"\n{found.seconds:.0f} s, seed {found.seed}. Page: {written}")
    if found.interrupted:
        raise KeyboardInterrupt(_kept_text(found, given.out))
    return 0


def _kept_text(found: Rehearsal, out: Path | None) -> str:
    """What is left of a rehearsal that was interrupted, and how to go on."""
    from tendonlab.report.numbers import counted

    rigs = f"{len(found.cases)} of {counted(len(found.cases) + found.num_left_out, 'rig')}"
    if out is None:
        return f"{rigs} diagnosed, none stored: --out DIR stores them"
    return f"{rigs} stored in {out}; the same command does the rest"


def rehearsal_text(found: Rehearsal) -> str:
    """The table of sizes, a sentence per effect, and how far the answers can be relied on."""
    from tendonlab.cli.text import bullets, wrapped
    from tendonlab.rehearsal.page import headline, reliability_table, sizes_table
    from tendonlab.rehearsal.words import amount_of_work, nothing_words, reliability_words

    rates = _plain(reliability_table(found)) if found.reliability else ""
    parts = [
        wrapped(f"{found.dataset}: {headline(found)}"),
        wrapped(amount_of_work(found)),
        _plain(sizes_table(found), most=4),
        bullets("In words", found.sentences),
        wrapped(nothing_words(found)),
        "\n".join(part for part in (wrapped(reliability_words(found)), rates) if part),
        bullets("Notes", found.notes),
    ]
    return "\n\n".join(part for part in parts if part)


def _plain(block: Table, *, most: int = 99) -> str:
    """A table of the page as text: its first `most` columns."""
    from tendonlab.cli.text import table

    head = [str(column) for column in block.columns[:most]]
    rows = [[cell.text for cell in row[:most]] for row in block.rows]
    return table([head, *rows], right=[k for k in block.right if k < most])

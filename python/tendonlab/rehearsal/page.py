"""One self-contained HTML page from a rehearsal, in the look of the diagnosis report."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tendonlab.rehearsal.figure import pictures
from tendonlab.rehearsal.words import (
    OWN_LAWS,
    amount_of_work,
    effect_words,
    gap_words,
    missed_words,
    nothing_words,
    reliability_words,
    size_words,
)
from tendonlab.report.blocks import Cell, Table
from tendonlab.report.document import environment
from tendonlab.report.numbers import number, percent, percent_span, probability
from tendonlab.report.words import capital, phrase

if TYPE_CHECKING:
    from tendonlab.rehearsal.result import Rehearsal


OFTEN = 0.1  # share of the rigs that lack nothing
NEAR = 2.0  # gap over noise


def page(of: Rehearsal) -> str:
    """The text of rehearsal.html: everything inline, all text escaped."""
    from jinja2 import ChoiceLoader, PackageLoader

    own = environment()
    loader = ChoiceLoader([PackageLoader("tendonlab.rehearsal"), *([own.loader] if own.loader else [])])
    drawn = pictures(of.effects)
    titled = [(capital(phrase(e.effect, of.system)), e, effect_words(e, of.system)) for e in of.effects]
    return (
        own.overlay(loader=loader)
        .get_template("rehearsal.html.j2")
        .render(
            of=of,
            headline=headline(of),
            work=amount_of_work(of),
            own_laws=OWN_LAWS,
            sizes=sizes_table(of),
            nothing=nothing_words(of),
            relied=reliability_words(of),
            reliability=reliability_table(of),
            curves=[(title, words, drawn[e.effect].inline()) for title, e, words in titled if e.effect in drawn],
            others=[words for _, e, words in titled if e.effect not in drawn],
        )
    )


def headline(of: Rehearsal) -> str:
    """How many effects would be found where they leave twice the noise floor or less, and at any size; and how often
    something is missed where nothing is missing, if that is often."""
    kinds = [e.threshold for e in of.effects if e.threshold is not None and e.threshold.kind != "above"]
    near = [threshold for threshold in kinds if threshold.size <= NEAR]
    further = f"; {len(kinds)} are found at some size that was tried" if len(kinds) > len(near) else ""
    wrong, num = of.nothing["effect"].hits + of.nothing["unknown_effect"].hits, of.nothing["effect"].num
    false = f" But of {num} rigs that lack nothing {wrong} are told to lack something." if wrong > OFTEN * num else ""
    return (
        f"{len(near)} of {len(of.effects)} effects are found 9 times in 10 where they leave a gap of twice the noise "
        f"floor or less{further}.{false}"
    )


def sizes_table(of: Rehearsal) -> Table:
    """One row per effect: from which size it is found, and what it is taken for otherwise."""
    rows = [
        [
            Cell(capital(phrase(e.effect, of.system))),
            Cell(size_words(e)),
            Cell(gap_words(e)),
            Cell(f"{sum(s.found for s in e.sizes)} of {e.tried}"),
            Cell(missed_words(e.missed, of.system) or "–"),
            Cell(missed_words(e.tied, of.system) or "–"),
        ]
        for e in of.effects
    ]
    columns = (
        "Effect",
        "Found 9 times in 10 from",
        "as gap over noise (95 %)",
        "Found, all sizes",
        "Taken for",
        "Tied with",
    )
    return Table(columns=columns, rows=rows, right=frozenset({1, 2, 3}), wraps=True)


def reliability_table(of: Rehearsal) -> Table:
    """Stated probabilities beside how often they were right."""
    rows = [
        [
            Cell(f"{number(one.stated[0], 2)} to {number(one.stated[1], 2)}"),
            Cell(str(one.right.num)),
            Cell(probability(one.mean)),
            Cell(percent(one.right.hits / one.right.num)),
            Cell(percent_span(one.right.ci95)),
        ]
        for one in of.reliability
    ]
    columns = ("Stated probability", "Answers", "Mean stated", "Right", "95 %")
    return Table(columns=columns, rows=rows, right=frozenset({1, 2, 3, 4}))

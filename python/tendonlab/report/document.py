"""One self-contained HTML page from a diagnosis."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING

from tendonlab.report import numbers, words
from tendonlab.report.sentence import WORSE, sentence

if TYPE_CHECKING:
    from jinja2 import Environment

    from tendonlab.report.diagnosis import Diagnosis
    from tendonlab.report.figures import Picture


@cache
def environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    made = Environment(
        loader=PackageLoader("tendonlab.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {
        "number": numbers.number,
        "percent": numbers.percent,
        "probability": numbers.probability,
        "percent_span": numbers.percent_span,
        "span": numbers.span,
        "unit": numbers.unit_text,
        "words": words.words,
        "phrase": words.phrase,
        "capital": words.capital,
        "listing": words.listing,
    }
    made.globals |= {"parameter_words": words.parameter_words, "width": _width}
    return made


def page(diagnosis: Diagnosis, pictures: Mapping[str, Picture]) -> str:
    """The text of report.html: everything inline, all text escaped. `pictures` comes from `report.figures.draw_all`."""
    from tendonlab.report.outline import SECTIONS

    return (
        environment()
        .get_template("report.html.j2")
        .render(
            why=diagnosis,
            sentence=sentence(diagnosis),
            verdicts=words.VERDICTS,
            facts=_facts(diagnosis),
            sections=[(section, section.render(diagnosis)) for section in SECTIONS if section.when(diagnosis)],
            pictures={name: picture.inline() for name, picture in pictures.items() if name != "effects"},
        )
    )


def effects_table(diagnosis: Diagnosis) -> str:
    """The ranked effects as an HTML table, for the page and for notebooks."""
    from tendonlab.report.sections.causes import listed

    return environment().get_template("effects.html.j2").render(why=diagnosis, findings=listed(diagnosis))


def _facts(diagnosis: Diagnosis) -> list[tuple[str, str, str]]:
    """(value, what it is, detail) of the figures below the headline; those without a value are left out."""
    facts = [
        (
            numbers.probability(diagnosis.verdict_probability[diagnosis.verdict]),
            f"probability of “{words.VERDICTS[diagnosis.verdict].lower()}”",
            "calibrated on simulated rigs" if diagnosis.calibrated else "not yet calibrated",
        )
    ]
    for key, title in (
        ("from_nominal", "of the held-out gap removed, from nominal"),
        ("from_refitted", "of the held-out gap removed, beyond tuning"),
    ):
        entry = diagnosis.shrinkage[key]
        if entry is not None and entry.get("value") is not None and (key == "from_nominal" or diagnosis.selected):
            bounds = entry.get("ci95")
            detail = f"95 %: {numbers.percent_span(bounds)}" if bounds is not None else ""
            grown = entry["value"] <= WORSE
            facts.append(_growth(diagnosis, key) if grown else (numbers.percent(entry["value"]), title, detail))
    if diagnosis.explained is not None and diagnosis.selected:
        share = numbers.percent(diagnosis.explained)
        facts.append(
            (
                share,
                "of the excess error explained, as mean square beyond noise",
                "“effect identified” needs 75 % (60 % without repeats, or with training runs at the floor; up to 85 % "
                "where more than four times the floor is left), an error at the floor, or parameters that only the "
                "effect brings near their stated values",
            )
        )
    return facts


def _growth(diagnosis: Diagnosis, key: str) -> tuple[str, str, str]:
    """The figure in place of a share that was removed, where held-out experiments got worse."""
    before, worse = "after tuning", "the added effects"
    if key == "from_nominal":
        before, worse = "of the simulator as stated", f"tuning{f' and {worse}' * bool(diagnosis.selected)}"
    value = (diagnosis.shrinkage[key] or {})["value"]
    return numbers.times_as_large(value), f"as the held-out gap {before}", f"{worse} made held-out runs worse"


def _width(share: float | None) -> str:
    """A share as the width of a bar in CSS."""
    known = share is not None and math.isfinite(share)
    return f"{100 * min(1.0, max(0.0, share or 0.0)) if known else 0:.1f}%"

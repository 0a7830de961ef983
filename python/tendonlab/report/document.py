"""One self-contained HTML page from a diagnosis."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

from tendonlab.report import numbers, words
from tendonlab.report.sentence import sentence, version

if TYPE_CHECKING:
    from jinja2 import Environment

    from tendonlab.report.diagnosis import Diagnosis
    from tendonlab.report.figures import Picture

_CLEAR = 0.05  # p-value up to which the summary says that the gap is concentrated in a regime
_SHOWN = 12  # candidates in the table of the page; report.json has all
_LEAST = 0.005  # probability below which a candidate without a selected effect is not worth a row of its own


@cache
def _environment() -> Environment:
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
        "separation": words.separation,
        "plainly": _plainly,
        "element": words.element_words,
        "gain": words.gain_words,
    }
    made.globals |= {"parameter_words": words.parameter_words, "width": _width}
    return made


def page(diagnosis: Diagnosis, pictures: Mapping[str, Picture]) -> str:
    """The text of report.html: everything inline, all text escaped. `pictures` comes from `report.figures.draw_all`."""
    return (
        _environment()
        .get_template("report.html.j2")
        .render(
            why=diagnosis,
            sentence=sentence(diagnosis),
            version=version(),
            shown_part=_shown_part(diagnosis),
            most=_where_in_words(diagnosis),
            elements=_elements(diagnosis),
            verdicts=words.VERDICTS,
            replays=words.REPLAYS,
            facts=_facts(diagnosis),
            rows=_gap_rows(diagnosis),
            regimes=_regimes(diagnosis),
            findings=_listed(diagnosis),
            runs=_runs(diagnosis),
            side=_side(diagnosis),
            fitted=_fitted(diagnosis),
            details=_details(diagnosis),
            pictures={name: picture.inline() for name, picture in pictures.items() if name != "effects"},
        )
    )


def _shown_part(diagnosis: Diagnosis) -> str:
    """What the overlay leaves out, for its caption; empty where it shows all."""
    from tendonlab.report.figures import MOST_DRAWN
    from tendonlab.report.plot.runs import telling_window

    run = diagnosis.overlay
    if run is None or not run.measured:
        return ""
    window, left_out = telling_window(run), len(run.measured) - MOST_DRAWN
    part = f" Shown: {numbers.span(window)} s of the run, where the refitted residual is largest." if window else ""
    return part + (f" The {MOST_DRAWN} outputs that carry most of the gap are drawn." if left_out > 0 else "")


def effects_table(diagnosis: Diagnosis) -> str:
    """The ranked effects as an HTML table, for the page and for notebooks."""
    template = _environment().get_template("effects.html.j2")
    return template.render(why=diagnosis, findings=_listed(diagnosis))


def _listed(diagnosis: Diagnosis) -> list[Any]:
    likely = [found for found in diagnosis.effects if found.probability >= _LEAST or found.name in diagnosis.selected]
    kept = [found for place, found in enumerate(likely) if place < _SHOWN or found.name in diagnosis.selected]
    return kept or list(diagnosis.effects[:3])


def _facts(diagnosis: Diagnosis) -> list[tuple[str, str, str]]:
    """(value, what it is, detail) of the figures below the headline; those without a value are left out."""
    facts = [
        (
            numbers.probability(diagnosis.verdict_probability[diagnosis.verdict]),
            f"probability of “{words.VERDICTS[diagnosis.verdict].lower()}”",
            "calibrated" if diagnosis.calibrated else "not yet calibrated",
        )
    ]
    for key, title in (
        ("from_nominal", "of the held-out gap removed, from nominal"),
        ("from_refitted", "of the held-out gap removed, beyond tuning"),
    ):
        found = diagnosis.shrinkage[key]
        if found is not None and found.get("value") is not None and (key == "from_nominal" or diagnosis.selected):
            bounds = found.get("ci95")
            detail = f"95 %: {numbers.percent_span(bounds)}" if bounds is not None else ""
            facts.append((numbers.percent(found["value"]), title, detail))
    if diagnosis.explained is not None and diagnosis.selected:
        share = numbers.percent(diagnosis.explained)
        facts.append((share, "of the excess mean square explained", "beyond the noise floor"))
    return facts


def _gap_rows(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    rows = []
    for signal, values in diagnosis.gap.items():
        factor, unit = numbers.prefixed(values.values(), diagnosis.units.get(signal, ""))
        shown = {key: numbers.number(None if value is None else factor * value) for key, value in values.items()}
        floor = values["noise_floor"]
        last = values["with_effect" if diagnosis.selected else "refitted"]
        left = last / floor if floor and last is not None and math.isfinite(last) else None
        rows.append({"signal": signal, "unit": unit, "left": left, **shown})
    return rows


def _regimes(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Every regime with its range in words."""
    regimes = diagnosis.where["regimes"]
    rows = []
    for regime in regimes:
        unit = numbers.unit_text(words.unit_of(regime["coordinate"], diagnosis.units))
        text = f"{words.words(regime['coordinate'])} {numbers.span(regime.get('range'))} {unit}".rstrip()
        rows.append({"text": text, "share": regime.get("share"), "p_value": regime.get("p_value")})
    return rows


def _elements(diagnosis: Diagnosis) -> list[tuple[str, float | None]]:
    """(element, probability) of those worth a row; the others are one row without a number of its own."""
    entries = diagnosis.where["elements"]
    rows = [
        (words.element_words(e["element"], diagnosis.system), e["probability"])
        for e in entries
        if e["probability"] >= _LEAST
    ]
    others = len(entries) - len(rows)
    return rows + ([(f"{others} other element{'s' if others > 1 else ''}", None)] if others else [])


def _where_in_words(diagnosis: Diagnosis) -> str:
    """The largest entry of each list of `where`, in one sentence; empty where nothing stands out."""
    parts = []
    if elements := diagnosis.where["elements"]:
        first = max(elements, key=lambda entry: entry["probability"])
        sure = numbers.probability(first["probability"])
        source = words.element_words(first["element"], diagnosis.system, article=True)
        parts.append(f"comes most likely from {source} (probability {sure})")
    if signals := diagnosis.where["signals"]:
        first = max(signals, key=lambda entry: entry["share"])
        share = numbers.percent(first["share"])
        parts.append(f"shows most in the {words.words(first['signal'])} ({share} of the excess)")
    if clear := [one for one in _regimes(diagnosis) if one["p_value"] is not None and one["p_value"] <= _CLEAR]:
        first = max(clear, key=lambda entry: entry["share"] or 0.0)
        parts.append(f"is concentrated at {first['text']} ({numbers.percent(first['share'])} of the excess)")
    return f"What tuning leaves of the gap {words.listing(parts)}." if parts else ""


def _runs(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Per held-out experiment: the gap of each stage in noise floors and its shrinkage by the selected effects."""
    rows = []
    for name, row in diagnosis.held_out.iterrows():
        nominal, before, after = (float(row[stage]) for stage in words.STAGES)
        shrinkage = 1.0 - after / before if before > 0 else None
        entry = {"nominal": nominal, "refitted": before, "with_effect": after}
        rows.append({"name": str(name), "shrinkage": shrinkage, **entry})
    return rows


def _fitted(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """The parameters of the last simulator: nominal, fitted and interval, each in its unit where that is known."""
    rows = []
    for name, of in diagnosis.details.get("parameters", {}).items():
        bounds = list(of.get("ci95") or [])
        shown = [of["value"], of.get("nominal"), *bounds]
        factor, unit = numbers.prefixed(shown, str(of.get("unit") or ""))
        value, nominal, *ends = (None if number is None else factor * number for number in shown)
        interval = "" if None in ends or not ends else numbers.span([end for end in ends if end is not None], 4)
        if not of.get("informed", True):
            interval = "not informed by these data"
        texts = {"value": numbers.number(value, 4), "nominal": numbers.number(nominal, 4), "interval": interval}
        rows.append({"name": words.words(str(name)), "unit": unit, **texts})
    return rows


def _details(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """(title, text) of what else says how it was computed; a value of a signal carries its unit."""
    rows = []
    for key, value in diagnosis.details.items():
        if key == "parameters":  # a table of its own
            continue
        if isinstance(value, Mapping) and value and set(value) <= set(diagnosis.units):
            text = "; ".join(
                f"{words.words(name)} {_with_unit(of, diagnosis.units[name])}" for name, of in value.items()
            )
        else:
            text = _plainly(value)
        rows.append((words.capital(words.words(key)), text))
    return rows


def _with_unit(value: float, unit: str) -> str:
    factor, shown = numbers.prefixed([value], unit)
    return f"{numbers.number(factor * value)} {shown}".rstrip()


def _side(diagnosis: Diagnosis) -> dict[str, Any] | None:
    if diagnosis.table is None:
        return None
    frame = diagnosis.table.frame
    frame = frame.reset_index() if frame.index.name is not None else frame
    cells = [[_cell(value) for value in row] for row in frame.itertuples(index=False, name=None)]
    texts = {"title": diagnosis.table.title, "note": diagnosis.table.note}
    return texts | {"columns": [str(column) for column in frame.columns], "cells": cells}


def _cell(value: Any) -> tuple[str, bool]:
    """Its text, and whether it is a number and so set flush right."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value), False
    return numbers.number(float(value), 4), True


def _plainly(value: Any) -> str:
    """A setting of `details` or `replay` in words, whatever its type."""
    if isinstance(value, Mapping):
        return "; ".join(f"{words.words(str(key))} {_plainly(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(_plainly(item) for item in value) or "none"
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: numbers.ABSENT}[value]
    return numbers.number(float(value), 4) if isinstance(value, int | float) else str(value)


def _width(share: float | None) -> str:
    """A share as the width of a bar in CSS."""
    known = share is not None and math.isfinite(share)
    return f"{100 * min(1.0, max(0.0, share or 0.0)) if known else 0:.1f}%"

"""Where: the signals, elements and regimes in which the error of the refitted simulator lies."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from tendonlab.report import numbers, words
from tendonlab.report.blocks import Block, Cell, Columns, Figure, Table, Text
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.report.sentence import ON_FLOOR

CLEAR = 0.05  # p-value up to which the summary says that the error is concentrated in a regime
LEAST = 0.005  # probability below which an element is not worth a row of its own
ALIKE = 0.01  # difference of probabilities of elements that are as probable
LIKELY = 0.2  # probability from which an element is named in words
_P_VALUE = (
    "p-value: how often the same error, shifted in time against the motion, would be as concentrated by chance. "
    "It is not corrected for the number of regimes compared."
)


def location(diagnosis: Diagnosis) -> list[Block]:
    """A sentence, tables of elements, signals and regimes, and the map."""
    summary = _summary(diagnosis) or "No signal, element or regime stands out over the noise floor."
    blocks: list[Block] = [Text(text=summary, brief=True)]
    tables = [table for table in (_elements(diagnosis), _signals(diagnosis)) if table.rows]
    if tables:
        blocks.append(Columns(tables=tables))
    if diagnosis.where["regimes"]:
        blocks += [_regimes(diagnosis), Text(text=_P_VALUE, note=True)]
    scale = "; both panels share one scale" if diagnosis.selected else ""
    caption = f"Residual over the plane of motion, in multiples of the noise floor{scale}. Empty cells hold no data."
    return [*blocks, Figure(name="where", caption=caption, small=not diagnosis.selected)]


def _summary(diagnosis: Diagnosis) -> str:
    """The largest entry of each list of `where`; empty where nothing stands out."""
    sentences = []
    if elements := [entry for entry in diagnosis.where["elements"] if entry["probability"] >= LIKELY]:
        sentences.append(f"After tuning, the remaining error most likely comes from {_sources(diagnosis, elements)}.")
    largest = []
    if signals := diagnosis.where["signals"]:
        first = max(signals, key=lambda entry: entry["share"])
        if first["share"] == 0.0 or _largest_error(diagnosis) < ON_FLOOR:
            beyond = "beyond" if first["share"] == 0.0 else f"by more than {ON_FLOOR} times"
            is_unknown = diagnosis.verdict == "unknown_effect"
            elsewhere = " What is missing shows in the training experiments." if is_unknown else ""
            return " ".join(
                [*sentences, f"On held-out experiments no output errs {beyond} its noise floor.{elsewhere}"]
            )
        largest.append(f"in the {words.words(first['signal'])} ({_of_excess(first['share'])})")
    if clear := [r for r in diagnosis.where["regimes"] if r.get("p_value") is not None and r["p_value"] <= CLEAR]:
        first = max(clear, key=lambda entry: entry["share"] or 0.0)
        largest.append(
            f"{'mainly ' if largest else ''}at {_regime_words(diagnosis, first)} ({_of_excess(first['share'])})"
        )
    if largest:
        sentences.append(f"{'It' if sentences else 'The remaining error'} is largest {', '.join(largest)}.")
    return " ".join(sentences)


def _largest_error(diagnosis: Diagnosis) -> float:
    """Of the refitted simulator on held-out experiments, in noise floors; unknown where models were weighed otherwise
    than errors are shown."""
    if diagnosis.details.get("weighed_by"):
        return math.inf
    return max((error["refitted"] / error["noise_floor"] for error in diagnosis.gap.values()), default=math.inf)


def _sources(diagnosis: Diagnosis, elements: Sequence[Mapping[str, Any]]) -> str:
    """The most probable of these elements, with those that are as probable: all of them where each is likelier than
    not, else one of them."""
    most = max(entry["probability"] for entry in elements)
    alike = [entry["element"] for entry in elements if entry["probability"] > most - ALIKE]
    named = [words.element_words(element, diagnosis.system, article=True) for element in alike]
    sure = f"probability {numbers.probability(most)}{' each' if len(alike) > 1 else ''}"
    return f"{(' and ' if most > 0.5 else ' or ').join(named)} ({sure})"


def _of_excess(share: float | None) -> str:
    return f"{numbers.percent(share)} of the excess"


def _elements(diagnosis: Diagnosis) -> Table:
    """Elements worth a row; the others share one without a number of its own."""
    entries = diagnosis.where["elements"]
    rows = [
        [
            Cell(words.capital(words.element_words(e["element"], diagnosis.system))),
            _share(e["probability"], numbers.probability),
        ]
        for e in entries
        if e["probability"] >= LEAST
    ]
    others = len(entries) - len(rows)
    if others:
        rows.append([Cell(f"{others} other element{'s' if others > 1 else ''}"), Cell("< 0.01 each")])
    return Table(columns=("Element", "Probability"), rows=rows)


def _signals(diagnosis: Diagnosis) -> Table:
    rows = [
        [Cell(words.capital(words.words(entry["signal"]))), _share(entry["share"], numbers.percent)]
        for entry in diagnosis.where["signals"]
    ]
    return Table(columns=("Signal", "Share of the excess"), rows=rows)


def _regimes(diagnosis: Diagnosis) -> Table:
    rows = [
        [
            Cell(words.capital(_regime_words(diagnosis, regime))),
            _share(regime.get("share"), numbers.percent),
            Cell(numbers.number(regime.get("p_value"), 2)),
        ]
        for regime in diagnosis.where["regimes"]
    ]
    return Table(columns=("Regime", "Share of the excess", "p-value"), rows=rows, right=frozenset({2}))


def _regime_words(diagnosis: Diagnosis, regime: Mapping[str, Any]) -> str:
    unit = numbers.unit_text(words.unit_of(regime["coordinate"], diagnosis.units))
    name = words.coordinate_words(regime["coordinate"], diagnosis.system)
    return f"{name} {numbers.region(regime.get('range'))} {unit}".rstrip()


def _share(value: float | None, text: Callable[[float | None], str]) -> Cell:
    return Cell(text(value), share=value)

"""A diagnosis as plain text: the sections of its report, in brief."""

from __future__ import annotations

from tendonlab.cli.text import bullets, table, wrapped
from tendonlab.report.blocks import Block, Candidates, Cell, Points, Table, Text
from tendonlab.report.diagnosis import Diagnosis, EffectFinding
from tendonlab.report.numbers import estimate, prefixed, probability
from tendonlab.report.outline import SECTIONS, Section
from tendonlab.report.words import capital, parameter_words

_BAR = 20  # columns of a probability of 1
_LEAST = 0.01  # probability below which a candidate is not worth a line
_SHOWN = 6


def diagnosis_text(diagnosis: Diagnosis) -> str:
    """The diagnosis on one screen: the verdict, then the brief parts of every section of the report."""
    parts = [_section(diagnosis, section) for section in SECTIONS if section.when(diagnosis)]
    first = [diagnosis.sentence, *(capital(caveat) for caveat in diagnosis.caveats)]
    return "\n\n".join([*map(wrapped, first), *(part for part in parts if part)])


def _section(diagnosis: Diagnosis, section: Section) -> str:
    shown = [text for block in section.render(diagnosis) if block.brief and (text := _block(diagnosis, block))]
    heading = f"{section.title}: {section.subtitle}" if section.subtitle else section.title
    return "\n".join([heading, *shown]) if shown else ""


def _block(diagnosis: Diagnosis, block: Block) -> str:
    title = wrapped(f"{block.title}:", indent="  ") if block.title else ""
    return "\n".join(part for part in (title, _content(diagnosis, block)) if part)


def _content(diagnosis: Diagnosis, block: Block) -> str:
    if isinstance(block, Text):
        return wrapped(block.text, indent="    " if block.title else "  ")
    if isinstance(block, Points):
        items = [f"{text} ({aside})" if aside else text for text, aside in block.items]
        return bullets("", items, numbered=block.style == "numbered")
    if isinstance(block, Table):
        return _table(block)
    if isinstance(block, Candidates):
        return _candidates(diagnosis, block)
    return ""


def _table(block: Table) -> str:
    kept = [k for k in range(len(block.columns)) if k not in block.spare]
    rows = [[block.columns[k] for k in kept], *([_cell(row[k]) for k in kept] for row in block.rows)]
    return table(rows, right=[place for place, k in enumerate(kept) if k in block.right])


def _cell(cell: Cell) -> str:
    return f"{cell.text} {cell.soft}".rstrip()


def _candidates(diagnosis: Diagnosis, block: Candidates) -> str:
    """One effect per line with its probability, the selected ones with their parameters."""
    likely = [e for e in block.findings if e.probability >= _LEAST or e.name in diagnosis.selected]
    shown = [e for rank, e in enumerate(likely) if rank < _SHOWN or e.name in diagnosis.selected]
    longest = max((len(effect.name) for effect in shown), default=0)
    lines = []
    for effect in shown:
        bar = "█" * max(1, round(_BAR * effect.probability))
        selected = effect.name in diagnosis.selected
        start = f"  {effect.name.ljust(longest)}  {probability(effect.probability):>6}  {bar.ljust(_BAR)}"
        lines.append(f"{start}  selected" if selected else start.rstrip())
        lines += [f"    {parameter}" for parameter in _parameters(effect)] if selected else []
    return "\n".join(lines)


def _parameters(effect: EffectFinding) -> list[str]:
    """One parameter per line: value, unit and 95 % interval."""
    lines = []
    for name, entry in effect.parameters.items():
        bounds = entry.get("ci95")
        shown = [entry["value"], *(bounds or [])]
        factor, unit = prefixed(shown, str(entry.get("unit", "")))
        value, *ends = (None if one is None else factor * one for one in shown)
        told, between = estimate(value, ends)
        interval = f" (95 %: {between})" if between else ""
        lines.append(f"{parameter_words(name, element=effect.element)} = {told} {unit}".rstrip() + interval)
    return lines

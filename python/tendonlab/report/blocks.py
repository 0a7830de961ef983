"""The parts that a section of the report is made of, in words: the page and the terminal show the same ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from tendonlab.report.diagnosis import EffectFinding


@dataclass(frozen=True, kw_only=True)
class Block:
    """`title`: a heading within the section. `brief`: whether a terminal shows it as well."""

    kind: ClassVar[str]
    title: str = ""
    brief: bool = False


@dataclass(frozen=True, kw_only=True)
class Text(Block):
    """A paragraph; a `note` is set smaller."""

    kind = "text"
    text: str
    note: bool = False


@dataclass(frozen=True, kw_only=True)
class Points(Block):
    """A list. `style`: "plain", "boxed" for what must not be overlooked, "numbered" for steps in order."""

    kind = "points"
    items: Sequence[tuple[str, str]]  # (text, what to add in smaller print)
    style: str = "plain"


@dataclass(frozen=True)
class Cell:
    """`soft`: added in smaller print. `share`: drawn as a bar before the text."""

    text: str
    soft: str = ""
    share: float | None = None
    bold: bool = False


@dataclass(frozen=True, kw_only=True)
class Table(Block):
    """Rows of cells. `right`: indices of the columns of numbers. `spare`: of those that a narrow screen leaves out.
    `wraps`: numbers may break into lines."""

    kind = "table"
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    right: frozenset[int] = frozenset()
    spare: frozenset[int] = frozenset()
    wraps: bool = False


@dataclass(frozen=True, kw_only=True)
class Columns(Block):
    """Tables side by side."""

    kind = "columns"
    tables: Sequence[Table]


@dataclass(frozen=True, kw_only=True)
class Figure(Block):
    """The picture of this name, where there is one. `folded`: the line that it unfolds from; empty: it is open."""

    kind = "figure"
    name: str
    caption: str = ""
    small: bool = False
    folded: str = ""


@dataclass(frozen=True, kw_only=True)
class Terms(Block):
    """(term, explanation) by row."""

    kind = "terms"
    rows: Sequence[tuple[str, str]]


@dataclass(frozen=True, kw_only=True)
class Candidates(Block):
    """The candidate effects with probability, parameters and what each does to held-out data."""

    kind = "candidates"
    findings: Sequence[EffectFinding]

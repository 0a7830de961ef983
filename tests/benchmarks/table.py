"""Tables as Markdown, and numbers as people read them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """`rows`: one cell of text per column. `notes`: sentences below it. `title`: where a job has several tables."""

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()
    title: str = ""

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(f"{len(row)} cells {row}: expected one for each of {self.columns}")

    def markdown(self) -> str:
        lines = [f"### {self.title}", ""] if self.title else []
        lines += [_line(self.columns), _line(["---"] * len(self.columns))]
        lines += [_line(row) for row in self.rows]
        lines += [line for note in self.notes for line in ("", note)]
        return "\n".join(lines) + "\n"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def count_text(count: int) -> str:
    """Thousands set apart: "10 000"."""
    return f"{count:,}".replace(",", " ")


def seconds_text(seconds: float) -> str:
    """Three digits in the unit that suits: "35.2 µs"."""
    if not math.isfinite(seconds):
        return "–"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{_three(seconds / size)} {unit}"
    return f"{_three(seconds / 1e-9)} ns"


def ratio_text(ratio: float) -> str:
    """Two or three digits and a times sign."""
    return f"{_three(ratio)}×" if math.isfinite(ratio) else "–"


def _three(value: float) -> str:
    if value >= 100:
        return f"{value:,.0f}".replace(",", " ")
    return f"{value:.3g}" if value < 10 else f"{value:.1f}"

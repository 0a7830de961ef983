"""What a check of the logs found, as plain values."""

from __future__ import annotations

from dataclasses import dataclass, field
from html import escape
from typing import Any

PROBLEMS = (
    "sign", "scale", "clock", "copy", "uninformative", "sampling", "outliers", "saturation", "quantisation", "constant",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One thing that looks wrong with the logs.

    `problem`: one of `PROBLEMS`. `signal`, `experiment`: where, None for no owner or for all of them. `alternatives`:
    signals that are equally guilty. `factor`: what is logged over what the equation of motion allows. `seconds`: lag
    behind the inputs, or behind the other experiments. `count`: samples concerned. `blocks`: a diagnosis would mislead
    unless this is corrected first."""

    problem: str
    detail: str
    signal: str | None = None
    experiment: str | None = None
    blocks: bool = False
    alternatives: tuple[str, ...] = ()
    factor: float | None = None
    seconds: float | None = None
    count: int | None = None

    def to_dict(self) -> dict[str, Any]:
        """As field `data` of report.json has it."""
        entry: dict[str, Any] = {
            "problem": self.problem,
            "signal": self.signal,
            "experiment": self.experiment,
            "detail": self.detail,
            "blocks": self.blocks,
        }
        extra = {"or": list(self.alternatives), "factor": self.factor, "seconds": self.seconds, "count": self.count}
        return entry | {name: value for name, value in extra.items() if value not in (None, [])}

    @property
    def place(self) -> str:
        """Signal and experiment in words; empty where neither is known."""
        signals = " or ".join(dict.fromkeys([*([self.signal] if self.signal else []), *self.alternatives]))
        return ", ".join(part for part in (signals, self.experiment or "") if part)


@dataclass(frozen=True, kw_only=True)
class Check:
    """What `tendonlab.check` says about a dataset: its `findings`, worst first."""

    dataset: str
    findings: tuple[Finding, ...]
    notes: tuple[str, ...] = field(default=())

    @property
    def blocks(self) -> bool:
        """Whether something must be corrected before a diagnosis."""
        return any(finding.blocks for finding in self.findings)

    def to_dict(self) -> dict[str, Any]:
        """Plain types: the dataset, its findings as in report.json, and notes on what could not be checked."""
        findings = [finding.to_dict() for finding in self.findings]
        return {"dataset": self.dataset, "blocks": self.blocks, "data": findings, "notes": list(self.notes)}

    def __repr__(self) -> str:
        kinds = ", ".join(f"{f.problem}{' (blocks)' if f.blocks else ''}" for f in self.findings)
        return f"Check({self.dataset!r}: {kinds or 'nothing wrong'})"

    def _repr_html_(self) -> str:
        cells = [(f.problem, f.place, f.detail, "yes" if f.blocks else "") for f in self.findings]
        rows = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in cells)
        notes = "".join(f"<p>{escape(note)}</p>" for note in self.notes)
        head = "<tr><th>problem</th><th>where</th><th>detail</th><th>blocks</th></tr>"
        return f"<p>{escape(repr(self))}</p><table>{head}{rows}</table>{notes}"

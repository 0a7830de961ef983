"""What looks wrong with the logs themselves, and what weakens the answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from tendonlab.report.blocks import Block, Points, Text
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.report.words import capital, words


def problems(diagnosis: Diagnosis) -> list[Block]:
    """Problems of the logs, worst first; one that many experiments share is told once."""
    items = [(_problem(alike[0]), _place(alike)) for alike in _grouped(diagnosis.data)]
    return [Points(items=items, style="boxed", brief=True)]


def warnings(diagnosis: Diagnosis) -> list[Block]:
    """What weakens the answer."""
    if not diagnosis.warnings:
        return [Text(text="None.")]
    return [Points(items=[(capital(warning), "") for warning in diagnosis.warnings], style="boxed", brief=True)]


def _grouped(entries: Sequence[Mapping[str, Any]]) -> list[list[Mapping[str, Any]]]:
    """The entries with the same problem of the same signal, in the order of their first."""
    groups: dict[tuple[Any, ...], list[Mapping[str, Any]]] = {}
    for entry in entries:
        alone = entry["detail"] if entry["blocks"] else None
        groups.setdefault((entry["problem"], entry["signal"], alone), []).append(entry)
    return list(groups.values())


def _problem(entry: Mapping[str, Any]) -> str:
    return f"{capital(words(str(entry['problem'])))}: {entry['detail']}"


def _place(alike: Sequence[Mapping[str, Any]]) -> str:
    """Which signal and experiments, and whether the diagnosis had to stop."""
    signal, (experiment, *others) = alike[0]["signal"], (entry["experiment"] for entry in alike)
    parts = [
        f"signal {signal}" if signal else "",
        f"experiment {experiment}" if experiment else "",
        f"alike in {', '.join(others)}" if all(others) and others else "",
        "must be corrected before a diagnosis" if alike[0]["blocks"] else "",
    ]
    return "; ".join(part for part in parts if part)

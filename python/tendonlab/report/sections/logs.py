"""What looks wrong with the logs themselves, and what weakens the answer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tendonlab.report.blocks import Block, Points, Text
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.report.words import capital, words


def problems(diagnosis: Diagnosis) -> list[Block]:
    """Problems of the logs, worst first."""
    return [Points(items=[(_problem(entry), _place(entry)) for entry in diagnosis.data], style="boxed", brief=True)]


def warnings(diagnosis: Diagnosis) -> list[Block]:
    """What weakens the answer."""
    if not diagnosis.warnings:
        return [Text(text="None.")]
    return [Points(items=[(capital(warning), "") for warning in diagnosis.warnings], style="boxed", brief=True)]


def _problem(entry: Mapping[str, Any]) -> str:
    return f"{capital(words(str(entry['problem'])))}: {entry['detail']}"


def _place(entry: Mapping[str, Any]) -> str:
    """Which signal and experiment, and whether the diagnosis had to stop."""
    signal, experiment = entry.get("signal"), entry.get("experiment")
    parts = [
        f"signal {signal}" if signal else "",
        f"experiment {experiment}" if experiment else "",
        "must be corrected before a diagnosis" if entry.get("blocks") else "",
    ]
    return "; ".join(part for part in parts if part)

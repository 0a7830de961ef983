"""What next: the measurements that would decide most."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tendonlab.report.blocks import Block, Points, Text
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.report.words import capital, gain_words, phrase, separation

_NOT_TIED = "No candidates are tied. These motions would test the selected effect against its closest competitor."
_UNKNOWN = "The library explains too little. These measurements show what the unknown cause follows."
_GAIN = (
    "Expected evidence: how far the simulator expects the experiment to favour the true explanation, in nats. About 10 "
    "nats decide; beyond 100 the size no longer matters."
)


def next_steps(diagnosis: Diagnosis) -> list[Block]:
    """The proposed experiments, best first."""
    if not diagnosis.next_experiments:
        settled = ": no other cause competes with what was named" if diagnosis.verdict == "effect" else ""
        return [Text(text=f"No further measurement is proposed{settled}.")]
    items = [
        (capital(str(entry["description"])), _purpose(entry, diagnosis.system)) for entry in diagnosis.next_experiments
    ]
    text = {"data_fault": "", "unknown_effect": _UNKNOWN}.get(diagnosis.verdict, _NOT_TIED)
    why = [Text(text=text, brief=True)] if text and not diagnosis.indistinguishable else []
    gains = any(entry.get("expected_gain") is not None for entry in diagnosis.next_experiments)
    note = [Text(text=_GAIN, note=True)] if gains else []
    return [*why, Points(items=items, style="numbered", brief=True), *note]


def _purpose(entry: Mapping[str, Any], kind: str) -> str:
    names = [phrase(name, kind) for name in entry.get("separates") or []]
    file = f"reference in {entry['reference']}" if entry.get("reference") else ""
    parts = [separation(names) if names else "", gain_words(entry.get("expected_gain")), file]
    return "; ".join(part for part in parts if part)

"""What next: the measurements that would decide most."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from tendonlab.report.blocks import Block, Points, Text
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.report.words import capital, coordinate_words, gain_words, phrase, separation

_NOT_TIED = "No candidates are tied. These motions would test the selected effect against its closest competitor."
_UNKNOWN = "The library explains too little. These measurements show what the unknown cause follows."
_GAIN = (
    "Expected evidence: how far the simulator expects the experiment to favour the true explanation, in nats. About 10 "
    "nats decide; beyond 100 the size no longer matters."
)
_INFORMATION = "Expected information: how much the experiment tells of the errors, wherever the rig moves, in nats."


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
    notes = [_GAIN] * any(_separates(entry) for entry in _weighed(diagnosis))
    notes += [_INFORMATION] * any(not _separates(entry) for entry in _weighed(diagnosis))
    shown = [Text(text=text, note=True) for text in notes]
    return [*why, Points(items=items, style="numbered", brief=True), *shown]


def _weighed(diagnosis: Diagnosis) -> list[Mapping[str, Any]]:
    """The entries whose gain is known."""
    return [entry for entry in diagnosis.next_experiments if entry.get("expected_gain") is not None]


def _separates(entry: Mapping[str, Any]) -> Sequence[str]:
    return entry.get("separates") or []


def _purpose(entry: Mapping[str, Any], kind: str) -> str:
    names = [_explanation(name, kind) for name in _separates(entry)]
    file = f"reference in {entry['reference']}" if entry.get("reference") else ""
    gain = gain_words(entry.get("expected_gain"), of="evidence" if names else "information")
    parts = [separation(names) if names else "", gain, file]
    return "; ".join(part for part in parts if part)


def _explanation(name: str, kind: str) -> str:
    """An effect, or a coordinate that the errors may follow."""
    if ":" in name:
        return phrase(name, kind)
    coordinate = coordinate_words(name, kind)
    if coordinate.endswith(" history"):
        return f"errors that follow the way of the {coordinate.removesuffix(' history')} since its last reversal"
    return f"errors that follow {'' if name == 'time' else 'the '}{coordinate}"

"""The verdict as one sentence, with numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tendonlab.report.numbers import percent, probability
from tendonlab.report.words import capital, phrases

if TYPE_CHECKING:
    from tendonlab.report.diagnosis import Diagnosis

_COUNTS = {2: "Two", 3: "Three", 4: "Four", 5: "Five"}


def sentence(diagnosis: Diagnosis) -> str:
    """The verdict, what it does to the held-out gap, and how probable it is."""
    tell = {
        "data_fault": _data_fault,
        "no_gap": _no_gap,
        "parameters_only": _parameters_only,
        "effect": _effect,
        "unknown_effect": _unknown,
    }[diagnosis.verdict]
    claim = "that this is the whole explanation" if diagnosis.verdict == "effect" else "of this verdict"
    state = "" if diagnosis.calibrated else ", not yet calibrated"
    return f"{tell(diagnosis)} Probability {claim}: {probability(certainty(diagnosis))}{state}."


def certainty(diagnosis: Diagnosis) -> float:
    """The probability that the sentence quotes: of the verdict, or of the selected set where that is less sure."""
    of_verdict = diagnosis.verdict_probability[diagnosis.verdict]
    if diagnosis.verdict != "effect" or not diagnosis.selected:
        return of_verdict
    chosen = frozenset(diagnosis.selected)
    for candidate in diagnosis.sets:
        if frozenset(candidate["effects"]) == chosen:
            return min(of_verdict, float(candidate["probability"]))
    return min([of_verdict, *(finding.probability for finding in diagnosis.effects if finding.name in chosen)])


def _shrinks(diagnosis: Diagnosis, start: str, subject: str) -> str:
    """What the change in `subject` does to the held-out gap: shrinks it, or not."""
    shrinkage = diagnosis.shrinkage[start]
    if shrinkage is None or shrinkage.get("value") is None:
        return ""
    if shrinkage["value"] <= 0:
        return f" {subject} does not shrink the held-out gap."
    return f" {subject} shrinks the held-out gap by {percent(shrinkage['value'], shrinkage.get('ci95'))}."


def _data_fault(diagnosis: Diagnosis) -> str:
    blocking = next((entry["detail"] for entry in diagnosis.data if entry["blocks"]), "")
    detail = f": {blocking}" if blocking else ""
    return f"The logs cannot be right{detail}. Nothing is said about effects."


def _no_gap(_: Diagnosis) -> str:
    return "There is no gap to explain: the simulator as it stands predicts to the noise floor."


def _parameters_only(diagnosis: Diagnosis) -> str:
    tail = _shrinks(diagnosis, "from_nominal", "Re-identifying them")
    return f"Only parameter values were off, and no effect is missing.{tail}"


def _effect(diagnosis: Diagnosis) -> str:
    names = diagnosis.selected
    if not names:
        return "An unmodelled effect of the library explains the gap."
    one = len(names) == 1
    several = f"{_COUNTS.get(len(names), len(names))} unmodelled effects explain"
    opening = "An unmodelled effect explains" if one else several
    tail = _shrinks(diagnosis, "from_refitted", f"Adding {'it' if one else 'them'}")
    return f"{opening} the gap: {phrases(names, diagnosis.system)}.{_ties(diagnosis) if one else ''}{tail}"


def _ties(diagnosis: Diagnosis) -> str:
    """What the data cannot tell from the one effect that was selected."""
    (chosen,) = diagnosis.selected
    others = [name for group in diagnosis.indistinguishable if chosen in group for name in group if name != chosen]
    return f" These data cannot tell it from {phrases(others, diagnosis.system, last='or')}." if others else ""


def _unknown(diagnosis: Diagnosis) -> str:
    if not diagnosis.selected:
        return "A gap remains after tuning that no effect of the library explains."
    one = len(diagnosis.selected) == 1
    effects = f"{capital(phrases(diagnosis.selected, diagnosis.system))} {'is' if one else 'are'} established"
    if not diagnosis.explained:
        share = f"but {'explains' if one else 'explain'} nothing of the excess error on held-out experiments"
    else:
        share = f"and {'explains' if one else 'explain'} {percent(diagnosis.explained)} of the excess error"
    return f"The library explains only a part of the gap. {effects} {share}; the rest is unknown."

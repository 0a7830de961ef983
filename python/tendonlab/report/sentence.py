"""The verdict as one sentence, with numbers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from tendonlab.report.numbers import percent, probability
from tendonlab.report.words import listing, phrase

if TYPE_CHECKING:
    from tendonlab.report.diagnosis import Diagnosis

_COUNTS = {2: "Two", 3: "Three", 4: "Four", 5: "Five"}


def version() -> str:
    """The version of tendonlab that runs, "0.0.0" where it is used without being installed."""
    from importlib import metadata

    try:
        return metadata.version("tendonlab")
    except metadata.PackageNotFoundError:
        return "0.0.0"


def sentence(diagnosis: Diagnosis) -> str:
    """What was found, how sure that is and what it does to the held-out gap."""
    return {"no_gap": _no_gap, "parameters_only": _parameters_only, "effect": _effect, "unknown_effect": _unknown}[
        diagnosis.verdict
    ](diagnosis)


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


def _aside(diagnosis: Diagnosis) -> str:
    state = "" if diagnosis.calibrated else ", not yet calibrated"
    return f"(probability {probability(certainty(diagnosis))}{state})"


def _shrinks(diagnosis: Diagnosis, start: str, subject: str) -> str:
    found = diagnosis.shrinkage[start]
    if found is None or found.get("value") is None:
        return ""
    return f"; {subject} the held-out gap by {percent(found['value'], found.get('ci95'))}"


def _no_gap(diagnosis: Diagnosis) -> str:
    return f"There is no gap to explain: the simulator as it stands predicts to the noise floor {_aside(diagnosis)}."


def _parameters_only(diagnosis: Diagnosis) -> str:
    tail = _shrinks(diagnosis, "from_nominal", "re-identifying them shrinks")
    return f"Only parameter values were off, and no effect is missing {_aside(diagnosis)}{tail}."


def _effect(diagnosis: Diagnosis) -> str:
    names = diagnosis.selected
    if not names:
        return f"An unmodelled effect of the library explains the gap {_aside(diagnosis)}."
    one = len(names) == 1
    several = f"{_COUNTS.get(len(names), len(names))} unmodelled effects explain"
    opening = "An unmodelled effect explains" if one else several
    tail = _shrinks(diagnosis, "from_refitted", f"adding {'it' if one else 'them'} shrinks")
    tied = f"{_aside(diagnosis)}{_ties(diagnosis) if one else ''}"
    return f"{opening} the gap: {_effects(diagnosis, names)} {tied}{tail}."


def _ties(diagnosis: Diagnosis) -> str:
    """What the data cannot tell from the one effect that was selected."""
    (chosen,) = diagnosis.selected
    others = [name for group in diagnosis.indistinguishable if chosen in group for name in group if name != chosen]
    return f", which these data cannot tell from {_effects(diagnosis, others, last='or')}" if others else ""


def _effects(diagnosis: Diagnosis, names: Iterable[str], *, last: str = "and") -> str:
    return listing((phrase(name, diagnosis.system) for name in names), last=last)


def _unknown(diagnosis: Diagnosis) -> str:
    if not diagnosis.selected:
        return f"A gap remains after tuning that no effect of the library explains {_aside(diagnosis)}."
    are, explain = ("is", "explains") if len(diagnosis.selected) == 1 else ("are", "explain")
    share = "" if diagnosis.explained is None else f" and {explain} {percent(diagnosis.explained)} of the excess error"
    found = f"{_effects(diagnosis, diagnosis.selected)} {are} established{share}"
    return f"The library explains only a part of the gap {_aside(diagnosis)}: {found}, the rest is unknown."

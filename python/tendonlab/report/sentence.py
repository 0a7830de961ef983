"""The verdict as one sentence, with numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tendonlab.report.numbers import percent, probability, times_as_large
from tendonlab.report.words import capital, changed_friction, phrases

if TYPE_CHECKING:
    from tendonlab.report.diagnosis import Diagnosis

FAR = 1.5  # noise floors of held-out error from which on effects leave something to be told
ON_FLOOR = 1.1  # noise floors of held-out error that read as the floor itself
WORSE = -0.05  # shrinkage below which the gap has grown, and not by rounding
EVEN = 0.5  # probability below which what was selected is not called established
LITTLE = 0.1  # share of the held-out excess below which effects explain hardly any of the gap
NOTHING = "A gap remains after tuning that no effect of the library explains."
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
    claim = _claim(diagnosis) if diagnosis.verdict == "effect" else "of this verdict"
    state = "" if diagnosis.calibrated else ", not yet calibrated"
    return f"{tell(diagnosis)} Probability {claim}: {probability(certainty(diagnosis))}{state}."


def certainty(diagnosis: Diagnosis) -> float:
    """The probability that the sentence quotes: of the verdict, or of the selected set where that is less sure. Sets
    that the data cannot tell from the selected one count with it: the sentence names them."""
    of_verdict = diagnosis.verdict_probability[diagnosis.verdict]
    if diagnosis.verdict != "effect" or not diagnosis.selected:
        return of_verdict
    chosen = frozenset(diagnosis.selected)
    twin_of = {name: own for own in chosen for name in _twins(diagnosis, own)}
    alike = [s for s in diagnosis.sets if frozenset(twin_of.get(name, name) for name in s["effects"]) == chosen]
    if alike:
        return min(of_verdict, sum(float(s["probability"]) for s in alike if len(s["effects"]) == len(chosen)))
    return min([of_verdict, *(finding.probability for finding in diagnosis.effects if finding.name in chosen)])


def _claim(diagnosis: Diagnosis) -> str:
    """What `certainty` is the probability of, where effects were selected: theirs, or that of any named beside them."""
    rank = "main" if _floors(diagnosis, "with_effect") >= FAR else "whole"
    if any(_twins(diagnosis, own) for own in diagnosis.selected):
        return f"that one of these explanations is the {rank} one"
    return f"that this is the {rank} explanation"


def _twins(diagnosis: Diagnosis, chosen: str) -> list[str]:
    """What the data cannot tell from an effect that was selected, unless it was selected too."""
    groups = [group for group in diagnosis.indistinguishable if chosen in group]
    return [name for group in groups for name in group if name not in diagnosis.selected]


def _shrinks(diagnosis: Diagnosis, start: str, subject: str) -> str:
    """What the change in `subject` does to the held-out gap: shrinks it, or not."""
    shrinkage = diagnosis.shrinkage[start]
    if shrinkage is None or shrinkage.get("value") is None:
        return ""
    if shrinkage["value"] <= WORSE:
        return f" {subject} makes held-out runs worse: their gap becomes {times_as_large(shrinkage['value'])}."
    if shrinkage["value"] <= 0:
        return f" {subject} does not shrink the held-out gap."
    return f" {subject} shrinks the held-out gap by {percent(shrinkage['value'], shrinkage.get('ci95'))}."


def _data_fault(diagnosis: Diagnosis) -> str:
    blocking = next((entry["detail"] for entry in diagnosis.data if entry["blocks"]), "")
    detail = f": {blocking}" if blocking else ""
    return f"The logs cannot be right{detail}. Nothing is said about effects."


def _no_gap(diagnosis: Diagnosis) -> str:
    floors = _floors(diagnosis, "nominal")
    if floors < ON_FLOOR:
        return "There is no gap to explain: the simulator as it stands predicts to the noise floor."
    return (
        f"No gap can be shown: the simulator as it stands errs by {floors:.2g} times the noise floor, and neither "
        "tuning nor an effect of the library lowers that reliably."
    )


def _parameters_only(diagnosis: Diagnosis) -> str:
    tail = _shrinks(diagnosis, "from_nominal", "Re-identifying them")
    floors = _floors(diagnosis, "refitted")
    if floors < ON_FLOOR:
        return f"Only parameter values were off, and no effect is missing.{tail}"
    return (
        f"Parameter values were off, and no missing effect can be shown: the refitted simulator errs by {floors:.2g} "
        f"times the noise floor, and no effect of the library lowers that reliably.{tail}"
    )


def _floors(diagnosis: Diagnosis, stage: str) -> float:
    """The held-out error at a stage over the noise floor, rms over the outputs, as the verdict counted it."""
    if weighed := diagnosis.details.get("weighed_by"):
        return float(weighed["errors"][stage])
    squares = [(error[stage] / error["noise_floor"]) ** 2 for error in diagnosis.gap.values()]
    return float((sum(squares) / len(squares)) ** 0.5) if squares else 0.0


def _effect(diagnosis: Diagnosis) -> str:
    names = diagnosis.selected
    if not names:
        return "An unmodelled effect of the library explains the gap."
    one, how_many = len(names) == 1, _COUNTS.get(len(names), str(len(names)))
    said = f"{phrases(names, diagnosis.system)}.{_ties(diagnosis)}"
    them = "it" if one else "them"
    if diagnosis.explained is None:  # held-out experiments leave nothing to explain
        return (
            f"The simulator lacks {'an effect' if one else f'{how_many.lower()} effects'}: {said} The training "
            f"experiments show {them}; the held-out ones are at the noise floor without {them} as well."
        )
    opening = "An unmodelled effect explains" if one else f"{how_many} unmodelled effects explain"
    return f"{opening} the gap: {said}{_shrinks(diagnosis, 'from_refitted', f'Adding {them}')}{_left(diagnosis)}"


def _left(diagnosis: Diagnosis) -> str:
    """What the selected effects leave, where that is far above the noise floor."""
    floors = _floors(diagnosis, "with_effect")
    if floors < FAR:
        return ""
    form = "another form of this effect" if len(diagnosis.selected) == 1 else "another form of one of these effects"
    return f" What is left is {floors:.2g} times the noise floor: {form}, or a smaller effect, may still be missing."


def _ties(diagnosis: Diagnosis) -> str:
    """What the data cannot tell from the effects that were selected."""
    kind, told = diagnosis.system, ""
    for chosen in diagnosis.selected:
        if others := _twins(diagnosis, chosen):
            own = "it" if len(diagnosis.selected) == 1 else phrases([chosen], kind)
            told += f" These data cannot tell {own} from {phrases(others, kind, last='or')}."
    return told


def _unknown(diagnosis: Diagnosis) -> str:
    drift = _drift(diagnosis)
    if not diagnosis.selected:
        return drift or NOTHING
    one = len(diagnosis.selected) == 1
    shares = [finding.probability for finding in diagnosis.effects if finding.name in diagnosis.selected]
    if max(shares, default=1.0) >= EVEN:
        found, rest = f"{'is' if one else 'are'} established", "the rest is unknown"
    else:
        found = f"{'helps' if one else 'help'} on the training experiments"
        rest = (
            f"{'it' if one else 'they'} may only imitate what is unknown, so compare the fitted values with what you "
            "know of the rig"
        )
    effects = f"{capital(phrases(diagnosis.selected, diagnosis.system))} {found}"
    if diagnosis.explained is None:
        share = "and held-out experiments are at the noise floor"
    elif diagnosis.explained < LITTLE:
        part = percent(diagnosis.explained) if diagnosis.explained else "nothing"
        share = f"but {'explains' if one else 'explain'} {part} of the excess error on held-out experiments"
    else:
        share = f"and {'explains' if one else 'explain'} {percent(diagnosis.explained)} of the excess error"
    is_part = diagnosis.explained is None or diagnosis.explained >= LITTLE
    opening = drift or ("The library explains only a part of the gap." if is_part else NOTHING)
    return f"{opening} {effects} {share}; {rest}."


def _drift(diagnosis: Diagnosis) -> str:
    """How friction changed over the session; empty where it did not."""
    drift = diagnosis.details.get("drift")
    if drift is None:
        return ""
    change = changed_friction(drift["element"], drift["change"], diagnosis.system)
    return f"An effect is missing that the library lacks: {change} over the session."

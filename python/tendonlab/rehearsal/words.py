"""A rehearsal in plain sentences, for the terminal and the page."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from tendonlab.rehearsal.tally import EffectRehearsal, Share
from tendonlab.report.numbers import counted, number, percent_span, prefixed, probability, span
from tendonlab.report.words import capital, listing, parameter_words, phrase

if TYPE_CHECKING:
    from tendonlab.rehearsal.result import Rehearsal

ANSWERS = {
    "nothing": "nothing, or wrong parameters",
    "unknown": "an unknown effect",
    "data_fault": "a fault of the logs",
    "failed": "no answer, because the diagnosis failed",
}
MOST_NAMED = 2  # wrong answers that a sentence names
MOST_ROOM = 2.5  # of the largest size tried: below, no other size can be asked for
OWN_LAWS = (
    "The simulated rigs contain the library's own laws, the same as the diagnosis fits. On a real rig an effect has "
    "another form: expect to find it a little later than here."
)


def effect_words(entry: EffectRehearsal, kind: str) -> str:
    """From which size an effect is found, and what smaller ones are taken for."""
    title = capital(phrase(entry.effect, kind))
    if entry.threshold is None:
        return f"{title}: {_not_tried(entry)}."
    after = _missed_words(entry, kind)
    ties = missed_words(entry.tied, kind, most=MOST_NAMED)
    tied = (
        f" In {sum(entry.tied.values())} of {entry.tried} rigs the data could not separate it from {ties}."
        if ties
        else ""
    )
    return f"{title}: {_found_words(entry)}.{tied}" + (f" {after}." if after else "")


def amount_words(entry: EffectRehearsal, amount: float | None) -> str:
    """A value of the parameter that says how large the effect is, with its unit: "12 mrad"."""
    if amount is None:
        return "–"
    factor, unit = prefixed([amount], entry.unit)
    return f"{number(factor * amount, 2)} {unit}".rstrip()


def size_words(entry: EffectRehearsal) -> str:
    """The size from which the effect is found, for a table: "12 mrad", "> 40 mrad"."""
    if entry.threshold is None:
        return "–"
    signs = {"within": "", "above": "> ", "below": "≤ "}
    if entry.falls:  # a softer spring is the larger effect
        signs = {"within": "", "above": "< ", "below": "≥ "}
    return signs[entry.threshold.kind] + amount_words(entry, entry.amounts[0])


def gap_words(entry: EffectRehearsal) -> str:
    """The same as gap over noise, with its interval: "0.9 (0.5 to 1.6)"."""
    if entry.threshold is None:
        return "–"
    sign = {"within": "", "above": "> ", "below": "≤ "}[entry.threshold.kind]
    best = f"{sign}{number(entry.threshold.size, 2)}"
    if sign:
        return best
    low, high = entry.threshold.ci95
    first, last = (number(size.gap, 2) for size in (entry.sizes[0], entry.sizes[-1]))
    return f"{best} ({number(low, 2) if low else f'< {first}'} to {number(high, 2) if high else f'> {last}'})"


def answer_words(answer: str, kind: str) -> str:
    """A wrong answer in words: an effect, or one of ANSWERS."""
    return ANSWERS.get(answer) or phrase(answer, kind)


def missed_words(missed: Mapping[str, int], kind: str, *, most: int = 99) -> str:
    """Wrong answers with their counts: "a delay of the actuator (3), nothing (2)"."""
    named = [f"{answer_words(answer, kind)} ({count})" for answer, count in list(missed.items())[:most]]
    return ", ".join(named)


def parameter_title(entry: EffectRehearsal) -> str:
    """The parameter that says how large the effect is, in words."""
    return parameter_words(entry.parameter, element=entry.effect.partition(":")[0])


def nothing_words(of: Rehearsal) -> str:
    """How often something was called where nothing was withheld."""
    named = of.nothing["effect"]
    if not named.num:
        return "No rig without a missing effect was diagnosed, so false effects were not counted."
    text = f"Where nothing was withheld, an effect was named in {_share_words(named)}"
    unknown = of.nothing["unknown_effect"]
    fault = of.nothing["data_fault"]
    further = [f"an unknown effect was claimed in {unknown.hits}"] * bool(unknown.hits)
    further += [f"a fault of the logs in {fault.hits}"] * bool(fault.hits)
    which = missed_words(of.false_effects, of.system)
    return text + (f": {which}" if which else "") + (f"; {listing(further)}" if further else "") + "."


def reliability_words(of: Rehearsal) -> str:
    """Mean probability on the truth, in a sentence."""
    if of.on_truth is None:
        return "No case tells whether the probabilities can be relied on."
    return (
        f"The truth got a probability of {probability(of.on_truth)} on average, over the rigs with a gap of at least "
        "one noise floor and those from which nothing was withheld."
    )


def amount_of_work(of: Rehearsal) -> str:
    """How many rigs were diagnosed, and what there was no time for."""
    done, left = counted(len(of.cases), "simulated rig"), of.num_left_out
    text = f"{done} {_were(len(of.cases))} diagnosed"
    if left:
        why = "the rehearsal was interrupted" if of.interrupted else "there was no time"
        text += f"; {left} {_were(left)} left out because {why}. The same call with an output folder goes on"
    return f"{text}."


def _were(count: int) -> str:
    return "was" if count == 1 else "were"


def _share_words(of: Share) -> str:
    return f"{of.hits} of {of.num} rigs (95 %: {percent_span(of.ci95)})"


def _not_tried(entry: EffectRehearsal) -> str:
    if entry.largest_gap <= 0 or entry.largest_amount is None:
        return "invisible in these experiments, whatever its size"
    at = f"{parameter_title(entry)} {amount_words(entry, entry.largest_amount)}"
    return f"not tried; at {at} its gap after tuning is {_times(entry.largest_gap)}"


def _found_words(entry: EffectRehearsal) -> str:
    assert entry.threshold is not None
    at = f"{parameter_title(entry)} {amount_words(entry, entry.amounts[0])}"
    gap = _times(entry.threshold.size)
    if entry.threshold.kind == "above":
        last = entry.sizes[-1]
        found = f"where it was found in {last.found} of {last.tried} rigs"
        most = f"; no plausible size leaves more than {_times(entry.largest_gap)}"
        if entry.largest_gap >= MOST_ROOM * entry.threshold.size:
            most = ""
        way = "down" if entry.falls else "up"
        return f"not found 9 times in 10 at any size tried, {way} to {at} ({gap}), {found}{most}"
    if entry.threshold.kind == "below":
        return f"found 9 times in 10 already at {at} ({gap}), the smallest size tried{_at_most(entry)}"
    return f"found 9 times in 10 from {at} on{' down' * entry.falls} ({gap}{_interval(entry)})"


def _times(gap: float) -> str:
    return f"{number(gap, 2)} times the noise floor"


def _at_most(entry: EffectRehearsal) -> str:
    """How sure it is that the smallest size is enough."""
    high = entry.amounts[2]
    if high is None:
        few = "one rig is" if entry.tried == 1 else f"{entry.tried} rigs are"
        return f" ({few} too few to be sure)"
    return f" (95 %: from {amount_words(entry, high)} on at the latest)"


def _interval(entry: EffectRehearsal) -> str:
    """The 95 % interval of the size, as far as it lies among the sizes that were tried."""
    _, low, high = entry.amounts
    if low is not None and high is not None:
        factor, unit = prefixed([low, high], entry.unit)
        return f"; 95 %: {span(sorted([factor * low, factor * high]), 2)} {unit}".rstrip()
    if high is None:
        return "; 95 %: perhaps beyond the largest size tried" if low is None else f"; 95 %: {_from(entry, low)}"
    return f"; 95 %: {amount_words(entry, high)} at the latest"


def _from(entry: EffectRehearsal, low: float) -> str:
    return f"{amount_words(entry, low)} at the earliest, perhaps beyond the largest size tried"


def _missed_words(entry: EffectRehearsal, kind: str) -> str:
    missed = {answer: count for answer, count in entry.missed.items() if answer != "failed"}
    failed = entry.missed.get("failed", 0)
    words = []
    if missed:
        named = missed_words(missed, kind, most=MOST_NAMED)
        words.append(f"it was missed in {sum(missed.values())} of {entry.tried} rigs and taken for {named}")
    if failed:
        words.append(f"the diagnosis failed in {failed} of {entry.tried} rigs")
    return capital("; ".join(words))

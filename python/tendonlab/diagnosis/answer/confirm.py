"""What held-out experiments refute: an effect that was established on the training experiments alone.

Without repeats nothing tells what repeats from what a sensor adds. A slow error of a sensor then looks like an effect
on the training experiments, but not on others. With repeats an effect may imitate a cause that the library lacks; where
held-out experiments are predicted worse with that effect, the imitation fails. Repeats of one motion share what happens
by chance; an effect that gains on them alone explains that chance.

Effects of rigs have other forms than the library's. What the form of the first effect leaves, a further one may remove
in part, on all experiments alike. So may a further one that imitates a cause which the library lacks. And what changes
no prediction by as much as a reader sees is no cause of a gap."""

from __future__ import annotations

from collections.abc import Sequence

from tendonlab.diagnosis.answer import heldout
from tendonlab.diagnosis.answer.heldout import Replayed
from tendonlab.diagnosis.answer.verdict import NO_GAP
from tendonlab.diagnosis.floor import renewed
from tendonlab.diagnosis.search.select import Search
from tendonlab.diagnosis.search.trial import HIDDEN, Trial, relief, restores_belief
from tendonlab.diagnosis.search.workshop import Workshop
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.noise import NEAR_FLOOR, Floor

CONFIRMED = 0.25  # share of the held-out excess that confirms the last effect
FURTHER = 0.6  # the same of an effect beside others: one that only mends the form of theirs removes 0 to 0.56
TELLING = 0.4  # the same where left-out training experiments gain `HIDDEN` nats: 13 errors of forms gained 62 at most
NEAR = 4.0  # mean square over the floor with it, beyond which more is missing and that share tells less
WHOLE = 0.85  # share of the held-out excess that all effects remove, below which something unknown is left
BESIDE_UNKNOWN = 0.5  # share of it that the last of several must then remove: five imitations removed 0.05 to 0.36
CARRIED = 0.1  # share of its gain on left-out training experiments that an effect must bring on held-out ones
MOSTLY = 0.5  # share of the held-out excess beyond which any gain there is enough: chance of one motion removes little
VISIBLY = 1.05  # ratio of held-out errors that a reader sees: right effects improved some output 1.24 times and more
SURE = 2.0  # standard errors of its gain on held-out experiments that confirm it as well
MAINLY = 0.25  # share of its gain that beliefs must make up, to confirm an effect without held-out experiments

WORSE = "adding it predicts held-out experiments worse, or hardly better"
CHANCE = f"adding it removes less than {100 * CONFIRMED:.0f} % of the held-out excess error, which may be chance"
LITTLE = (
    "adding it removes {:.0f} % of what the other effects leave above the floor of held-out experiments, but {:.0f} % "
    "are needed"
)
INVISIBLE = (
    "held-out experiments are near the noise floor without it, and adding it improves the error of no output by "
    f"{100 * (VISIBLY - 1.0):.0f} %"
)
UNTOUCHED = "the untouched simulator predicts held-out experiments as well, and to the floor"


def confirmed(search: Search, shop: Workshop) -> Search:
    """The search without the last effects that held-out experiments refute."""
    while search.selected and (why := _why_refuted(search)):
        search = search.without_last(*renewed(search.fitter, search.path[-2], shop.pool), why)
    return search


def _why_refuted(search: Search) -> str:
    """Why held-out experiments refute the last effect, if they do: they are predicted worse with it, or hardly better
    though the training experiments predict much; without repeats where it removes little of what the model without it
    leaves, and may do even that by chance, or where an effect beside others leaves much of what they leave. At the
    floor, where it changes nothing, or the untouched simulator is as good."""
    case, fitter, pair = search.fitter.case, search.fitter, search.path[-2:]
    gained, is_first = _gained(search), len(search.selected) == 1
    # What beliefs tell needs no experiment.
    is_believed = restores_belief(case, *pair) and relief(*pair) > MAINLY * gained
    if not case.test or (is_first and is_believed):
        return ""
    models = [heldout.models(case, m, case.test) for m in (pair if is_first else (search.tuned, *pair))]
    try:
        replays, judged, _ = heldout.replay_all(case, models, case.test)
    except NumericalError:  # there is none that both models simulate
        return ""
    tuned, before, after = replays[0], replays[-2], replays[-1]
    if not is_believed and pair[0].mean_square < NEAR_FLOOR and _changes_nothing(before, after, fitter.floor):
        return INVISIBLE
    floor = fitter.floor.reached_by(heldout.rms(after))
    if _is_as_good_untouched(case, after, floor, judged):
        return UNTOUCHED
    share = heldout.explained(before, after, floor) or 0.0
    least = 0.0 if is_first else _least_share(tuned, after, floor, gained)
    if share < least:
        return LITTLE.format(100 * share, 100 * least)
    if is_believed:
        return ""
    gain = heldout.predictive_gain(case, fitter.whitening, fitter.floor, before, after, judged)
    if fitter.floor.repeated:
        predicted = CARRIED * gained * len(judged) / len(case.train)
        needed = 0.0 if share > MOSTLY else max(0.0, min(SURE * gain["se"], predicted))
        return WORSE if gain["mean"] < needed else ""
    return CHANCE if share < CONFIRMED and gain["mean"] < SURE * gain["se"] else ""


def _changes_nothing(before: Replayed, after: Replayed, floor: Floor) -> bool:
    """Whether no output is predicted visibly better, at the floor: many samples may tell a fifth of a sampling step."""
    is_better = heldout.rms(before) >= VISIBLY * heldout.rms(after)  # NaN, where nothing was measured, is not
    return heldout.level(before, floor) < NEAR_FLOOR and not is_better.any()


def _is_as_good_untouched(case: Case, after: Replayed, floor: Floor, judged: Sequence[int]) -> bool:
    """Whether the untouched simulator is at the floor, and no visibly farther from it."""
    try:
        untouched = heldout.level(heldout.replay(case, [case.system] * len(judged), judged), floor)
    except NumericalError:
        return False
    return untouched < min(NO_GAP, VISIBLY**2 * heldout.level(after, floor))


def _least_share(tuned: Replayed, after: Replayed, floor: Floor, gained: float) -> float:
    """Share of what the others leave above the held-out floor that an effect beside them must remove, which gained so
    many nats on left-out training experiments."""
    if heldout.level(after, floor) >= NEAR:
        return BESIDE_UNKNOWN if (heldout.explained(tuned, after, floor) or 0.0) < WHOLE else 0.0
    if floor.repeated:
        return 0.0
    return TELLING if gained > HIDDEN else FURTHER


def _gained(search: Search) -> float:
    """Nats that left-out parts of the training experiments gain by the last effect beside those before it: its place
    may have been contested beside one that was refuted since."""
    before, after = search.path[-2:]
    return Trial.of(search.selected[-1], after, before).left_out_gain

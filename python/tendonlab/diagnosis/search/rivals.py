"""Each effect beside the others: alone, an effect may gain most because it imitates two that belong together, and what
it was worth then says little about whether it is part of the cause."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from tendonlab.diagnosis.search.contest import DETECT, HOPEFUL, Round, Trial, Workshop, again, another, conclude
from tendonlab.diagnosis.search.halves import confirmed
from tendonlab.diagnosis.search.refit import CATCH_UP
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.fitting.fitted import Fitted, Fitter
from tendonlab.simulation.system import System

NUM_RIVALS, MAX_EFFECTS = 3, 3


@dataclass(frozen=True)
class Seat:
    """The place of one effect: the model of the `others` without it, what it gains there (`own`), and the round in
    which it stands against everything else that might take the place."""

    others: Fitted
    own: Trial
    round: Round

    def key(self, effect: Trial) -> tuple[frozenset[str], str]:
        """What the place of `effect` goes by."""
        return frozenset(self.others.added), effect.effect

    def rival(self) -> Trial | None:
        """The best other claim to it, unless that lies far behind."""
        able = [t for t in self.round.trials if t.effect != self.own.effect and t.effect in self.round.established]
        best = max(able, key=lambda t: t.evidence_gain, default=None)
        return best if best and best.evidence_gain > CATCH_UP * self.own.evidence_gain else None

    def given_to(self, rival: Trial) -> Seat:
        """The same place with `rival` in it."""
        return Seat(self.others, rival, replace(self.round, accepted=rival))


Known = dict[tuple[frozenset[str], str], Seat]  # by the effects beside it, and its own


def seats(fitter: Fitter, best: Fitted, known: Known, shop: Workshop) -> list[Seat]:
    """A seat for each effect of `best`: the one in `known`, else a new one; an older one of another company where the
    others cannot do without it."""
    found = []
    for effect in best.added:
        others = frozenset(best.added) - {effect}
        seat = known.get((others, effect))
        if seat is None:
            try:
                seat = _seat(fitter, best, effect, shop)
            except (NumericalError, ParameterError):
                seat = next(known[key] for key in reversed(known) if key[1] == effect)
        found.append(seat)
    return found


def _seat(fitter: Fitter, best: Fitted, effect: str, shop: Workshop) -> Seat:
    rest = tuple(name for name in best.added if name != effect)
    others = fitter.fit(without(fitter, best, (effect,)), added=rest, initial=best.initial)
    own = Trial.of(effect, replace(best, added=(*rest, effect)), others)
    label = f"instead of {effect}"
    leads = shop.leads(fitter, others, label)
    rivals = [x for x in leads if x.effect != effect and x.gain > HOPEFUL * DETECT.evidence][:NUM_RIVALS]
    trials = shop.refit(fitter, others, rivals, label, known=own)
    passed = {t.effect for t in trials if DETECT.passed(t) and not (_leads(t, own) and not _holds(fitter, best, t))}
    return Seat(others, own, conclude(others, leads, trials, passed=passed, bar=DETECT, accepted=own))


def exchange(fitter: Fitter, best: Fitted, chosen: Sequence[Seat], known: Known, shop: Workshop) -> Fitted | None:
    """The model in which a seat is given to nothing, to what fills it clearly better, or to what does so together with
    one effect more; `known` then holds who took a seat. None where every effect is in its place."""
    first = max(chosen, key=lambda seat: seat.own.evidence_gain)
    bar = again(fitter, first.own.evidence_gain)
    needless = [seat for seat in chosen if seat is not first and not bar.passed(seat.own)]
    if needless:
        return min(needless, key=lambda seat: seat.own.evidence_gain).others
    claims = [(seat, rival) for seat in chosen if (rival := seat.rival()) is not None]
    for seat, rival in sorted(claims, key=lambda claim: -claim[1].fitted.evidence):
        if _leads(rival, seat.own):
            known[seat.key(rival)] = seat.given_to(rival)
            return rival.fitted
    for _, rival in claims if len(best.added) < MAX_EFFECTS else []:
        together = another(fitter, rival.fitted, most=most(known), shop=shop)
        if together is None or (friend := together.accepted) is None:
            continue
        clear = friend.fitted.evidence - best.evidence > again(fitter, most(known)).evidence
        if clear and _holds(fitter, best, friend):
            shared = Seat(rival.fitted, friend, together)
            known[shared.key(friend)] = shared
            return friend.fitted
    return None


def most(known: Known) -> float:
    """The most evidence that an effect has gained so far."""
    return max((seat.own.evidence_gain for seat in known.values()), default=0.0)


def _leads(rival: Trial, own: Trial) -> bool:
    return rival.evidence_gain - own.evidence_gain > DETECT.evidence


def _holds(fitter: Fitter, best: Fitted, instead: Trial) -> bool:
    """Whether it predicts experiments that it was not fitted to better than `best`, whose place it would take."""
    try:
        return confirmed(fitter, best, instead.fitted)
    except NumericalError:
        return False


def without(fitter: Fitter, model: Fitted, effects: Sequence[str]) -> System:
    """The simulator of `model` without some of the effects that were added to it."""
    own = model.system.parameters
    nominal = fitter.case.system
    kept = [name for name in model.added if name not in effects]
    values = {name: {p: own[p] for p in nominal.info.effect(name).parameters if p in own} for name in kept}
    return nominal.with_parameters({name: own[name] for name in nominal.parameters}).with_effects(values)

"""The place of each effect contested by its rivals, given the other effects.

Alone, an effect may gain most because it imitates two that belong together. What it gained alone then says little about
whether it is part of the cause."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from tendonlab.diagnosis.search.contest import Round, next_effect, promising
from tendonlab.diagnosis.search.halves import predicts_better
from tendonlab.diagnosis.search.refit import CATCH_UP
from tendonlab.diagnosis.search.screen import can_be_added
from tendonlab.diagnosis.search.swap import extended
from tendonlab.diagnosis.search.trial import (
    DETECT,
    FURTHER_SHARE,
    Trial,
    bar_for_further_effect,
    gain_elsewhere,
    is_no_shape,
    plainest_first,
)
from tendonlab.diagnosis.search.workshop import Workshop
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter
from tendonlab.simulation.catalog import WHOLE
from tendonlab.simulation.system import System

NUM_RIVALS, MAX_EFFECTS = 3, 3
KEPT = 0.5  # share of its gain that an effect keeps over the others fitted anew, where its contest still holds


@dataclass(frozen=True)
class Place:
    """The place of one effect in a model: the model of the `others` without it, the trial of the effect that holds the
    place (`holder`), and the round in which its rivals contested it."""

    others: Fitted
    holder: Trial
    round: Round

    @property
    def key(self) -> tuple[frozenset[str], str]:
        """What identifies a place: the other effects, and its holder."""
        return frozenset(self.others.added), self.holder.effect

    def rival(self) -> Trial | None:
        """The best other established trial for this place, unless it lies far behind the holder."""
        trials = self.round.trials
        able = [t for t in trials if t.effect != self.holder.effect and t.effect in self.round.established]
        best = max(able, key=lambda t: t.evidence_gain, default=None)
        return best if best and best.evidence_gain > CATCH_UP * self.holder.evidence_gain else None

    def with_rival(self, rival: Trial) -> Place:
        """The same place held by `rival`."""
        return Place(self.others, rival, replace(self.round, accepted=rival))


Places = Mapping[tuple[frozenset[str], str], Place]  # by Place.key, in the order in which they were first contested


@dataclass(frozen=True)
class Improved:
    """A better model, and the contest that its new effect won (None: an effect was dropped)."""

    model: Fitted
    won: Place | None = None


def largest_gain(places: Places) -> float:
    """The most evidence that an effect has gained so far."""
    return max((place.holder.evidence_gain for place in places.values()), default=0.0)


def contest_each_place(fitter: Fitter, base: Fitted, places: Places, shop: Workshop) -> list[Place]:
    """The place of each effect of `base`: the stored contest for this effect if its companions are the same and do no
    better now, else a new one; the latest stored contest if the model cannot run without the effect, or only so that
    its derivatives explode."""
    contested = []
    for effect in base.added:
        place = places.get((frozenset(base.added) - {effect}, effect))
        if place is None or len(base.added) > 1:
            stored = [stored for key, stored in places.items() if key[1] == effect]
            try:
                place = _contest(fitter, base, effect, shop, place)
            except (NumericalError, ParameterError):
                if not stored:
                    raise
                place = stored[-1]
            if stored and place.others.exploded:
                place = stored[-1]
        contested.append(place)
    return contested


def _contest(fitter: Fitter, base: Fitted, effect: str, shop: Workshop, stored: Place | None) -> Place:
    """The contest for one place, or the `stored` one, unless the other effects had ended in a wrong optimum: then they
    do without this effect nearly as well, once they start where they ended with it. A rival whose lead predicts
    no other block better is as good as the holder, no better."""
    rest = tuple(name for name in base.added if name != effect)
    others = refitted_without(fitter, base, (effect,))
    holder = Trial.of(effect, replace(base, added=(*rest, effect)), others)
    if stored is not None and holder.evidence_gain > KEPT * stored.holder.evidence_gain:
        return stored
    label = f"instead of {effect}"
    under = fitter.left_by(others)
    screened = [] if others.exploded else shop.screen_all(under, others, label)  # nothing follows from such slopes
    rivals = [s for s in promising(screened, DETECT) if s.effect != effect][:NUM_RIVALS]
    refitted = shop.refit_all(under, others, rivals, label, least=DETECT.evidence, incumbent=holder)

    def no_further_than_it_predicts(t: Trial) -> Trial:
        in_doubt = _clearly_better(t, holder) and not predicts_better(fitter, base, t.fitted)
        return replace(t, evidence_gain=holder.evidence_gain) if in_doubt else t

    trials = [no_further_than_it_predicts(t) for t in refitted.trials]
    established = {t.effect for t in trials if DETECT.passed(t)}
    failed = refitted.failed
    round_ = Round.of(others, screened, trials, established=established, bar=DETECT, accepted=holder, failed=failed)
    return Place(others, holder, round_)


def refitted_without(fitter: Fitter, model: Fitted, effects: Sequence[str]) -> Fitted:
    """The model refitted without some of the effects that were added to it, nor any that cannot be without them."""
    system = drop_effects(fitter, model, effects)
    left = tuple(name for name in model.added if name in system.effects)
    return fitter.settled(fitter.fit(system, added=left, initial=model.initial))


def improve(
    fitter: Fitter, base: Fitted, contested: Sequence[Place], places: Places, shop: Workshop
) -> Improved | None:
    """Try to improve the set: drop a needless effect, swap one for a clearly better rival, or swap and add one.

    None where every effect deserves its place."""
    strongest = max(contested, key=lambda place: place.holder.evidence_gain)
    bar, most = bar_for_further_effect(fitter), strongest.holder.evidence_gain

    def is_needed(place: Place) -> bool:
        return bar.passed(place.holder) and not place.holder.is_nothing and is_no_error_of_a_shape(place)

    def is_no_error_of_a_shape(place: Place) -> bool:
        if not fitter.floor.repeated:
            return True
        elsewhere = gain_elsewhere(place.others, place.holder, heard=fitter.case.replay.output)
        return is_no_shape(place.others, [place.holder], most, elsewhere=elsewhere)

    needless = [place for place in contested if place is not strongest and not is_needed(place)]
    if needless:
        return Improved(min(needless, key=lambda place: place.holder.evidence_gain).others)
    claims = [(place, rival) for place in contested if (rival := place.rival()) is not None]
    for place, rival in sorted(claims, key=lambda claim: -claim[1].fitted.evidence):
        if _clearly_better(rival, place.holder) or _plainer(rival, place.holder):
            return Improved(rival.fitted, place.with_rival(rival))
    for _, rival in claims if len(base.added) < MAX_EFFECTS else []:
        pair = _rival_and_one_more(fitter, base, rival, places, shop)
        if pair is not None:
            return pair
    return None


def _rival_and_one_more(fitter: Fitter, base: Fitted, rival: Trial, places: Places, shop: Workshop) -> Improved | None:
    """The model of `rival` with one effect more, where that is clearly better than `base`."""
    under = fitter.left_by(rival.fitted)
    round_ = next_effect(under, rival.fitted, largest_gain=largest_gain(places), shop=shop)
    if round_ is None or round_.accepted is None:
        return None
    pair = round_.accepted.fitted
    share = FURTHER_SHARE * largest_gain(places) if fitter.floor.repeated else 0.0
    least = max(bar_for_further_effect(fitter).evidence, share)
    clear = pair.evidence - base.counted(pair.shares).evidence > least
    if not clear or not predicts_better(fitter, base, pair):
        return None
    return Improved(pair, Place(rival.fitted, round_.accepted, round_))


def _clearly_better(rival: Trial, holder: Trial) -> bool:
    return rival.evidence_gain - holder.evidence_gain > DETECT.evidence


def _plainer(rival: Trial, holder: Trial) -> bool:
    """Whether a rival of as much evidence says the same with fewer parameters."""
    as_much = rival.evidence_gain >= holder.evidence_gain
    return as_much and plainest_first([holder, rival], {rival.effect})[0] is rival


def drop_effects(fitter: Fitter, model: Fitted, effects: Sequence[str]) -> System:
    """The simulator of `model` without some of the effects that were added to it, nor any that cannot be without them,
    as a bristle or Stribeck friction without dry friction."""
    own = model.system.parameters
    nominal = fitter.case.system
    kept = [name for name in model.added if name not in effects]
    values = {name: {p: own[p] for p in nominal.info.effect(name).parameters if p in own} for name in kept}
    system = nominal.with_parameters({name: own[name] for name in nominal.parameters if name in own})
    while able := [name for name in values if _can_be_in(system, name, values[name])]:
        system = extended(system, {name: values.pop(name) for name in able})
    return system


def _can_be_in(system: System, effect: str, values: Mapping[str, float]) -> bool:
    law = system.info.effect(effect)
    if not (law.roles & WHOLE or can_be_added(law, system)):
        return False
    try:
        extended(system, {effect: values})
    except ParameterError:
        return False
    return True

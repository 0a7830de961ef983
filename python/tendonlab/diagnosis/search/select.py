"""Which effects: added one at a time, then the place of each contested given the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from tendonlab.diagnosis.floor import renewed
from tendonlab.diagnosis.search.contest import Round, next_effect
from tendonlab.diagnosis.search.rivals import (
    MAX_EFFECTS,
    Place,
    Places,
    contest_each_place,
    improve,
    largest_gain,
    refitted_without,
)
from tendonlab.diagnosis.search.trial import DETECT, Bar, Trial, explains_enough
from tendonlab.diagnosis.search.workshop import Workshop
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter

MAX_IMPROVEMENTS = 3
NUM_LEADERS = 2  # effects that are tried together with a second one where none is established
LEADS, ALIKE = 0.2, 0.02  # share of the error that such an effect removes, and by which what two of them leave differs
PAIR = Bar(evidence=2.0 * DETECT.evidence, left_out=2.0 * DETECT.left_out, doubted=False)  # of two effects at once


@dataclass(frozen=True)
class Search:
    """The outcome of a search. `tuned`: the refitted simulator without any added effect. `steps`: the model after each
    effect that was added. `rounds`: the contest for the place of each effect, then the one that no further effect won.
    `fitter`: the last one, under whose noise floor the final model was judged. `refuted`: effects that held-out
    experiments refuted, and why."""

    fitter: Fitter
    tuned: Fitted
    steps: tuple[Fitted, ...]
    rounds: tuple[Round, ...]
    refuted: Mapping[str, str] = field(default_factory=dict)

    @property
    def final(self) -> Fitted:
        """The model that came out."""
        return self.path[-1]

    @property
    def selected(self) -> tuple[str, ...]:
        """Effects established, in the order in which they were added."""
        return self.final.added

    def without_last(self, fitter: Fitter, model: Fitted, why: str) -> Search:
        """The search as if the last effect had not been established, under the `fitter` for the `model` before."""
        last, refuted = len(self.steps) - 1, self.selected[-1]
        tuned, steps = (self.tuned, (*self.steps[: last - 1], model)) if last else (model, ())
        rounds = (*(contest.without(refuted) for contest in self.rounds[:last]), self.rounds[last].refuted())
        return Search(fitter, tuned, steps, rounds, {refuted: why, **self.refuted})

    @property
    def path(self) -> tuple[Fitted, ...]:
        """The refitted simulator, and the model after each effect that was added."""
        return (self.tuned, *self.steps)


@dataclass(frozen=True)
class _Extended:
    """Models with more and more effects, the fitter for the search beyond the last one, the places contested so far,
    and the rounds that no further effect won: one or none."""

    fitter: Fitter
    steps: tuple[Fitted, ...] = ()
    places: Places = field(default_factory=dict)
    last: tuple[Round, ...] = ()


def select_effects(fitter: Fitter, tuned: Fitted, shop: Workshop) -> Search:
    """Add effects to the `tuned` simulator one at a time, as long as evidence and left-out experiments both demand it;
    then let rivals contest the place of each. The effect that explains most alone may only imitate two that belong
    together."""
    state = _Extended(fitter)
    for attempt in range(MAX_IMPROVEMENTS + 1):
        state = _add_effects(state, tuned, shop)
        contested = contest_each_place(state.fitter, state.steps[-1], state.places, shop) if state.steps else []
        if len(contested) < 2 or attempt == MAX_IMPROVEMENTS:
            break
        better = improve(state.fitter, state.steps[-1], contested, state.places, shop)
        if better is None:
            break
        places = {**state.places, **({better.won.key: better.won} if better.won else {})}
        fitter, model = renewed(state.fitter, better.model, shop.pool)
        state = _Extended(fitter, (*_models_before(fitter, model), model), places)
    return Search(state.fitter, tuned, state.steps, (*(place.round for place in contested), *state.last))


def _add_effects(state: _Extended, tuned: Fitted, shop: Workshop) -> _Extended:
    """Add effects until none is established or there are as many as are allowed."""
    fitter, steps, places = state.fitter, state.steps, state.places
    won: Round | None = None
    while len(steps) < MAX_EFFECTS:
        base = steps[-1] if steps else tuned
        contest = next_effect(fitter, base, largest_gain=largest_gain(places), shop=shop, before=won)
        if contest is None:
            return _Extended(fitter, steps, places)
        if contest.accepted is None:
            deeper = _two_deep(_Extended(fitter, steps, places), base, contest, shop)
            if deeper is None:
                return _Extended(fitter, steps, places, (contest,))
            fitter, steps, places, won = deeper.fitter, deeper.steps, deeper.places, None
            continue
        won = contest
        place = Place(base, contest.accepted, contest)
        places = {**places, place.key: place}
        fitter, model = renewed(fitter, contest.accepted.fitted, shop.pool)
        steps = (*steps, model)
    return _Extended(fitter, steps, places)


def _two_deep(state: _Extended, base: Fitted, contest: Round, shop: Workshop) -> _Extended | None:
    """Without repeats: an effect that removes much, though what a second one leaves hides its evidence, with that
    second one, where the two together are established. Each place is contested afterwards."""
    if state.fitter.floor.repeated or len(base.added) + 2 > MAX_EFFECTS:
        return None
    for leader in _leaders(base, contest.trials):
        fitter, first = renewed(state.fitter, leader.fitted, shop.pool)
        further = next_effect(fitter, first, largest_gain=largest_gain(state.places), shop=shop)
        if further is None or further.accepted is None:
            continue
        pair = Trial.of(further.accepted.effect, further.accepted.fitted, base)
        if PAIR.passed(pair) and explains_enough(base, [pair]):
            place = Place(first, further.accepted, further)
            fitter, model = renewed(fitter, further.accepted.fitted, shop.pool)
            return _Extended(fitter, (*state.steps, first, model), {**state.places, place.key: place})
    return None


def _leaders(base: Fitted, trials: Sequence[Trial]) -> list[Trial]:
    """The effects that leave least, of those that remove a part of the error and predict left-out blocks better; one
    of those that leave the same."""
    most = base.mean_square - LEADS * (base.mean_square - 1.0)
    able = sorted((t for t in trials if t.left_out_gain > 0.0), key=lambda t: t.fitted.mean_square)
    leaders: list[Trial] = []
    for trial in able:
        left = trial.fitted.mean_square
        if left < most and not any(abs(left - other.fitted.mean_square) < ALIKE * left for other in leaders):
            leaders.append(trial)
    return leaders[:NUM_LEADERS]


def _models_before(fitter: Fitter, model: Fitted) -> list[Fitted]:
    """The models between the refitted simulator and `model`, effect by effect."""
    return [refitted_without(fitter, model, model.added[k:]) for k in range(1, len(model.added))]

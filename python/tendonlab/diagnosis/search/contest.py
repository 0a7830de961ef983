"""One more effect: screen all candidates, refit the promising ones, say which are established."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from tendonlab.diagnosis.discrepancy import may_be_noise
from tendonlab.diagnosis.search.halves import predicts_better
from tendonlab.diagnosis.search.refit import at_believed_values, strained
from tendonlab.diagnosis.search.screen import Screened
from tendonlab.diagnosis.search.slow import mends_slow_errors
from tendonlab.diagnosis.search.trial import (
    CLEAR,
    DETECT,
    HIDDEN,
    Bar,
    Trial,
    bar_for_further_effect,
    explains_enough,
    explains_half,
    gain_elsewhere,
    is_constant,
    is_friction_beside,
    is_level_beside,
    is_no_shape,
    plainest_first,
    removes_little,
    restores_belief,
)
from tendonlab.diagnosis.search.workshop import FAR_BEHIND, Workshop
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import NEAR_FLOOR
from tendonlab.fitting.problem import Fitter

NUM_REFIT, NUM_REFIT_FURTHER = 8, 4  # candidates refitted for the first effect, and for each further one
NUM_REMEMBERED = 2  # of those that gained beside the last winner, in the next contest
NUM_HIDDEN = 4  # best candidates at believed values, or of those that gave way, that are refitted as well
TEMPERATURE = 4.0  # tempering of evidence where the library is exact; it grows with what no model explains
FORM = 0.01  # the same, of the most that an effect gains: of 52 right ones none was ahead by less than 0.04 of that
# Where laws have a shape: the others, where right, were behind by 1.7 nats at most, 192 times.
FORM_OF_VARIANTS = 0.05  # the same beside a variant of the first law: of 13 right ones ten were up to 0.06 behind
UNCONFIRMED = 3.0  # temperatures by which an effect that left-out experiments do not confirm ranks behind none
MATTERS = 0.05  # share of the whitened mean square that an effect must remove near the floor, or else
MATTERS_BESIDE = 0.06  # the same of a level of friction beside other friction: errors of forms removed up to 0.055
LOST = 0.02  # share of its left-out gain that it may lose in single experiments: what helps in each is there
ENOUGH = 5  # experiments of which it says something that an effect helps in each
STEADIER = 0.2  # share of what the first one gains that an effect must gain to take its place because it helps in each
FIRM = 2.5  # mean square below which a floor from few repeats may be too low: 53 right effects lost 1.6 % at most there
MIN_SCREEN_GAIN = 0.3  # refit a candidate if its screened gain exceeds this share of the acceptance bar


@dataclass(frozen=True)
class Round:
    """The contest for one effect in addition to those of `base`: all candidates as screened, the trials best first, the
    probability of each effect (key None: no further effect), the trial that was accepted, the effects that are
    `established`, and why every fit of the others `failed`."""

    base: tuple[str, ...]
    screened: tuple[Screened, ...]
    trials: tuple[Trial, ...]
    probability: dict[str | None, float]
    accepted: Trial | None
    established: Set[str]
    failed: Mapping[str, str] = field(default_factory=dict)

    def refuted(self) -> Round:
        """The round where none of its effects holds: each ranks behind no further effect, which takes their place."""
        behind = math.exp(-UNCONFIRMED)
        shares = {name: behind * p if name in self.established else p for name, p in self.probability.items()}
        shares[None] += sum(self.probability.values()) - sum(shares.values())
        return replace(self, probability=shares, accepted=None, established=frozenset())

    def without(self, refuted: str) -> Round:
        """The round whose place was contested beside an effect that was `refuted`, as if that had not been there."""
        return replace(self, base=tuple(name for name in self.base if name != refuted))

    @classmethod
    def of(
        cls,
        base: Fitted,
        screened: Sequence[Screened],
        trials: Sequence[Trial],
        *,
        established: Set[str],
        bar: Bar,
        accepted: Trial | None,
        failed: Mapping[str, str],
    ) -> Round:
        """The round of `trials`, best first, of which one, or none, is accepted."""
        exact = TEMPERATURE * max([1.0, min((t.fitted.whitened_square for t in trials), default=1.0)])
        there = [t for t in trials if t.effect in established]
        of_shape = [FORM * t.evidence_gain for t in there if there[0].has_shape]
        probability = probabilities(trials, established, bar, max([exact, *of_shape]), exact, _variants(trials))
        return cls(base.added, tuple(screened), tuple(trials), probability, accepted, established, failed)


def next_effect(
    fitter: Fitter, base: Fitted, *, largest_gain: float, shop: Workshop, before: Round | None = None
) -> Round | None:
    """The contest for one more effect than `base` has; None where the library holds no more.

    `largest_gain`: the most evidence that an effect has gained so far; `before`: the contest that the last effect
    won."""
    further = len(base.added) > 0
    label = f"effect {len(base.added) + 1}" if further else "effect"
    screened = shop.screen_all(fitter, base, label)
    if not screened:
        return None
    bar = bar_for_further_effect(fitter) if further else DETECT
    chosen = promising(screened, bar)[: NUM_REFIT_FURTHER if further else NUM_REFIT]
    if strained(fitter, base):  # a candidate that cannot be simulated at tuned values may well be at nominal ones
        chosen += [s for s in screened if not s.simulated]
        chosen = _with_hidden(fitter, base, chosen, bar, shop)
        chosen += _remembered(base, screened, chosen, before) if before else []
    else:
        chosen = _behind(chosen, chosen)
    worth = partial(_worth_adding, fitter, base, further=further, largest_gain=largest_gain)
    refit = partial(shop.refit_all, fitter, base, label=label, least=_least_gain(fitter, base, bar))
    refitted = refit(chosen)
    trials, established = _judged(fitter, base, refitted.trials, bar, worth, further=further)
    is_lost = not (further or established) and base.mean_square >= NEAR_FLOOR
    others = _others(screened, chosen, bar) if is_lost else []
    if others:  # no effect that tells may go unseen
        refitted = refitted.with_others(refit(others), base, fitter.case)
        trials, established = _judged(fitter, base, refitted.trials, bar, worth, further=further)
    leader = trials[0] if established else None
    if leader is None or base.mean_square < NEAR_FLOOR:  # there an effect that beliefs ask for is the plainer answer
        leader = _reliever(fitter, base, trials) or leader
        trials = [leader, *(t for t in trials if t is not leader)] if leader else trials
        established = established | {leader.effect} if leader else established
    failed = {s.effect: s.trouble for s in screened if not s.simulated} | dict(refitted.failed)
    failed = {effect: reason for effect, reason in failed.items() if effect not in {t.effect for t in trials}}
    return Round.of(base, screened, trials, established=established, bar=bar, accepted=leader, failed=failed)


def promising(screened: Sequence[Screened], bar: Bar) -> list[Screened]:
    """The candidates of which a fit may pass the bar."""
    return [s for s in screened if s.gain > MIN_SCREEN_GAIN * bar.evidence]


def _judged(
    fitter: Fitter, base: Fitted, trials: list[Trial], bar: Bar, worth: Callable[[list[Trial]], bool], *, further: bool
) -> tuple[list[Trial], Set[str]]:
    """The trials, the one to accept first, and the effects that are established: none where none is worth adding."""
    established = {t.effect for t in trials if bar.passed(t)}
    if trials and trials[0].effect in established:
        trials = plainest_first(trials, established)
        trials = _steadier_first(fitter, base, trials, further=further)
    if not trials or trials[0].effect not in established or not worth(trials):
        established = set()
    return trials, established


def _others(screened: Sequence[Screened], chosen: Sequence[Screened], bar: Bar) -> list[Screened]:
    """The most promising of those that gave way to others: beside two missing effects a screen promises little of
    either."""
    taken = {s.effect for s in chosen}
    return [s for s in promising(screened, bar) if s.effect not in taken][:NUM_HIDDEN]


def _with_hidden(fitter: Fitter, base: Fitted, chosen: list[Screened], bar: Bar, shop: Workshop) -> list[Screened]:
    """The `chosen` candidates, the last of them replaced by those that only a screen at believed values shows: tuning
    may hide the true effect behind strained parameters."""
    try:
        there = at_believed_values(fitter, base)
    except (NumericalError, ParameterError):  # the misfit there may be beyond all numbers
        return chosen
    believed = shop.screen_all(*there, "believed values")
    best = promising(believed, bar)[:NUM_HIDDEN]
    hidden = [s for s in best if s.effect not in {c.effect for c in chosen}]
    return _behind([*chosen[: max(len(chosen) - len(hidden), NUM_HIDDEN)], *hidden], believed)


def _remembered(
    base: Fitted, screened: Sequence[Screened], chosen: Sequence[Screened], before: Round
) -> list[Screened]:
    """The best of those that gained `before` as well, in other elements than the winner, from where their fits ended:
    tuning may hide them here, and the screen at believed values may see what others leave there."""
    info, taken = base.system.info, {of.effect for of in chosen}
    own = info.effect(base.added[-1]).element
    able = {s.effect: s for s in screened if s.effect not in taken and info.effect(s.effect).element != own}
    trials = [t for t in before.trials if t.effect in able and DETECT.passed(t)][:NUM_REMEMBERED]
    values = {t.effect: {p: t.fitted.system.parameters[p] for p in info.effect(t.effect).parameters} for t in trials}
    return [replace(able[effect], starts=(start,)) for effect, start in values.items()]


def _behind(chosen: Sequence[Screened], believed: Sequence[Screened]) -> list[Screened]:
    """The `chosen` candidates, marked where others promise far more at believed values, and where they also do here."""
    gain = {s.effect: s.gain if s.simulated else math.inf for s in believed}
    here, there = (FAR_BEHIND * max((s.gain for s in of), default=0.0) for of in (chosen, believed))
    poor = {s.effect: gain.get(s.effect, math.inf) < there for s in chosen}
    return [replace(s, far_behind=s.gain < here and poor[s.effect], poor_when_believed=poor[s.effect]) for s in chosen]


def _least_gain(fitter: Fitter, base: Fitted, bar: Bar) -> float:
    """Nats that an effect must at least gain to be worth adding to `base`."""
    if base.mean_square >= NEAR_FLOOR:
        return bar.evidence
    matters = MATTERS * base.cost
    return max(bar.evidence, min(CLEAR.evidence, matters) if _evidence_counts(fitter, base) else matters)


def _evidence_counts(fitter: Fitter, base: Fitted, effect: str | None = None) -> bool:
    """Whether evidence may tell of an effect that removes next to nothing near the floor: experiments enough, and noise
    that is known well. A replay may carry the noise of a sensor through one body to the next, where a delay or
    presliding imitates it, by up to 291 nats on rigs that lacked nothing; no constant does."""
    bodies = len(fitter.case.prepared[0].core.position)
    is_known = bodies == 1 or not fitter.case.replay.carries_noise
    return len(base.runs) >= ENOUGH and (is_known or (effect is not None and is_constant(effect, base.system.info)))


def _worth_adding(
    fitter: Fitter, base: Fitted, trials: Sequence[Trial], *, further: bool, largest_gain: float = 0.0
) -> bool:
    """Not far above a floor from repeats, the first effect must help in each experiment. Near the floor, which a few
    repeats determine to a few per cent, an effect must also remove a share of the error that matters, or tell clearly
    and remove a tenth of what lies above the floor.
    With repeats, a further one must be no error of a shape, unless it mends slow errors. Without, it must explain
    enough, or leave what may be noise. Near the floor, beyond the first effect and where it explains little, it must
    predict experiments that it was not fitted to."""
    near_floor, repeated, first = base.mean_square < NEAR_FLOOR, fitter.floor.repeated, trials[0].fitted
    if not (further or _helps_in_each(fitter, base, trials[0])):
        return False
    is_little = removes_little(base, trials[0])
    counts = _evidence_counts(fitter, base, trials[0].effect)
    tells = CLEAR.passed(trials[0]) and (trials[0].evidence_gain > HIDDEN or not is_friction_beside(base, trials[0]))
    is_clear = tells and trials[0].lost < LOST and not is_little and counts
    is_beside = is_level_beside(base, trials[0])
    matters = MATTERS_BESIDE if is_beside else MATTERS
    mends = near_floor and repeated and further and mends_slow_errors(fitter, base, trials[0])
    too_little = first.mean_square > (1.0 - matters) * base.mean_square
    if near_floor and (is_beside or not is_clear) and too_little and not mends:
        return False
    if is_beside and not repeated and not explains_half(base, first):
        return False
    if repeated and further and not mends:
        elsewhere = gain_elsewhere(base, trials[0], heard=fitter.case.replay.output)
        if not is_no_shape(base, trials, largest_gain, elsewhere=elsewhere):
            return False
    enough = repeated or explains_enough(base, trials)
    if not (enough or may_be_noise(fitter.case, first)):
        return False
    return (enough and not near_floor and not further) or predicts_better(fitter, base, first)


def _helps_in_each(fitter: Fitter, base: Fitted, trial: Trial) -> bool:
    """Whether the first effect helps in each experiment, which is asked for not far above a floor from repeats."""
    return not fitter.floor.repeated or base.mean_square >= FIRM or trial.lost < LOST


def _steadier_first(fitter: Fitter, base: Fitted, trials: list[Trial], *, further: bool) -> list[Trial]:
    """The trials, best first. Where the first effect does not help in each experiment, the best one comes first that
    does and tells as clearly: of two missing effects, the one that other experiments contradict is the larger one."""
    if further or _helps_in_each(fitter, base, trials[0]):
        return trials
    enough = max(HIDDEN, STEADIER * trials[0].evidence_gain)
    steady = (t for t in trials[1:] if t.lost < LOST and t.left_out_gain > enough and not removes_little(base, t))
    first = next((t for t in steady if t.evidence_gain > enough), trials[0])
    return [first, *(t for t in trials if t is not first)]


def _reliever(fitter: Fitter, base: Fitted, trials: Sequence[Trial]) -> Trial | None:
    """The best trial without whose effect only parameters that nobody believes bring `base` not far from the floor:
    what beliefs tell is no error of a shape, so no higher bar is asked of a further effect."""
    if base.mean_square >= FIRM:
        return None
    able = (t for t in trials if DETECT.passed(t))
    return next((t for t in able if restores_belief(fitter.case, base, t.fitted)), None)


def _variants(trials: Sequence[Trial]) -> frozenset[str]:
    """Effects whose law is a variant of the first one's: it acts in the same element, combines in the same way and
    reads the same. The form of either may err by more than they differ."""
    if not trials or not trials[0].has_shape or trials[0].acts is None:
        return frozenset()
    return frozenset(t.effect for t in trials[1:] if t.acts == trials[0].acts)


def probabilities(
    trials: Sequence[Trial],
    established: Set[str],
    bar: Bar,
    temperature: float,
    exact: float | None = None,
    variants: Set[str] = frozenset(),
) -> dict[str | None, float]:
    """Probability of each effect, and of no further effect (None): softmax of evidence over a temperature; `exact`:
    that of established effects whose law has no shape that could err, where it is another; `variants` of the first law
    differ by its form alone.

    Raw evidence is over-confident: what an effect explains hangs on its form, and that of the rig is another. An effect
    that is not established ranks clearly behind None, and none counts more than the first one, to which it may have
    given way."""
    gains: dict[str | None, float] = {None: bar.evidence}
    heat: dict[str | None, float] = {}
    for t in trials:
        most = trials[0].evidence_gain
        limit = most if t.effect in established else bar.evidence - UNCONFIRMED * temperature
        gains[t.effect] = min(t.evidence_gain, limit)
        if exact is not None and t.effect in established and not t.has_shape:
            heat[t.effect] = exact
        elif t.effect in established & variants:
            heat[t.effect] = max(temperature, FORM_OF_VARIANTS * most)
    top = max(gains.values())
    weights = {name: float(np.exp((g - top) / heat.get(name, temperature))) for name, g in gains.items()}
    total = sum(weights.values())
    return {name: w / total for name, w in weights.items()}

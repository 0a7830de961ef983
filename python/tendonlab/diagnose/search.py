"""Which effects: screen, refit, score, and again from the best model (DIAGNOSIS section 2, steps 5 to 9)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

from tendonlab.diagnose.confirm import NEAR_FLOOR, confirmed
from tendonlab.diagnose.fits import Fitted, Fitter
from tendonlab.diagnose.screen import Lead, candidates, screen
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.system import System

NUM_REFIT, NUM_REFIT_AGAIN = 8, 4
DETECT_EVIDENCE, DETECT_LEFT_OUT = 10.0, 3.0
AGAIN_EVIDENCE, AGAIN_LEFT_OUT, AGAIN_SHARE = 30.0, 9.0, 0.01
MAX_EFFECTS = 3
TEMPERATURE = 4.0  # tempering of evidence where the library is exact; it grows with what no model explains
UNCONFIRMED = 3.0  # temperatures by which an effect that left-out experiments do not confirm ranks behind none
MATTERS = 0.05  # share of the whitened mean square that an effect must remove near the floor
HOPEFUL = 0.3  # of what an effect must gain, which the screen must promise for a refit
SKETCH = 5  # iterations after which a fit that cannot catch up is abandoned
CATCH_UP = 0.5
STRAINED = 3.0  # sd from what was believed, to which a parameter was tuned: it makes up for something
COOLINGS = 6  # fits under noise as large as the misfit, at the most


@dataclass(frozen=True)
class Trial:
    """One refitted candidate against the model it extends: gains in nats."""

    effect: str
    fitted: Fitted
    evidence_gain: float
    left_out_gain: float
    left_out_se: float


@dataclass(frozen=True)
class Bar:
    """What an effect must gain to be established: evidence, and log score of left-out experiments, the latter also by
    `steady` standard errors."""

    evidence: float
    left_out: float
    steady: float

    def passed(self, by: Trial) -> bool:
        """Whether `by` is established."""
        left_out = max(self.left_out, self.steady * by.left_out_se)
        return by.evidence_gain > self.evidence and by.left_out_gain > left_out


@dataclass(frozen=True)
class Round:
    """One more effect: all leads, the trials best first, and the probability of each (key None: no further effect)."""

    leads: tuple[Lead, ...]
    trials: tuple[Trial, ...]
    probability: dict[str | None, float]
    accepted: Trial | None
    temperature: float


@dataclass(frozen=True)
class Search:
    """The refitted simulator, the models that came of it effect by effect, and the rounds that chose them."""

    null: Fitted
    steps: tuple[Fitted, ...]
    rounds: tuple[Round, ...]

    @property
    def best(self) -> Fitted:
        """The model that came out."""
        return self.path[-1]

    @property
    def selected(self) -> tuple[str, ...]:
        """Effects established, in the order in which they were found."""
        return self.best.added

    @property
    def path(self) -> tuple[Fitted, ...]:
        """The refitted simulator, and the model after each effect that was added."""
        return (self.null, *self.steps)


Renew = Callable[[Fitter, Fitted], tuple[Fitter, Fitted]]


def search(
    fitter: Fitter,
    null: Fitted,
    *,
    pool: ThreadPoolExecutor,
    renew: Renew,
    progress: bool,
    library: Sequence[str] | None,
) -> Search:
    """Add effects one at a time, as long as evidence and left-out experiments both ask for it. `renew` gives the fitter
    for the search beyond a model, and the model in its eyes."""
    best, steps, rounds = null, list[Fitted](), list[Round]()
    while len(rounds) < MAX_EFFECTS:
        one = _round(fitter, best, rounds, pool=pool, progress=progress, library=library)
        if one is None:
            break
        rounds.append(one)
        if one.accepted is None:
            break
        fitter, best = renew(fitter, one.accepted.fitted)
        steps.append(best)
    return Search(null, tuple(steps), tuple(rounds))


def _round(
    fitter: Fitter,
    best: Fitted,
    before: Sequence[Round],
    *,
    pool: ThreadPoolExecutor,
    progress: bool,
    library: Sequence[str] | None,
) -> Round | None:
    names = [c for c in candidates(fitter.case, best) if library is None or c in library]
    if not names:
        return None
    label = "effect" if not before else f"effect {len(before) + 1}"
    work = pool.map(lambda name: screen(fitter, best, name), names)
    leads = sorted(
        tqdm(work, desc=f"screen {label}", total=len(names), disable=not progress, leave=False), key=lambda x: -x.gain
    )
    bar = _bar(fitter, before)
    chosen = [x for x in leads if x.gain > HOPEFUL * bar.evidence][: NUM_REFIT_AGAIN if before else NUM_REFIT]
    if _strained(fitter, best):  # what cannot be simulated from there may well be from what was believed
        chosen += [x for x in leads if not x.simulated]
    first = _refit(fitter, best, chosen[0], rival=None) if chosen else []
    rival = max((t.evidence_gain for t in first), default=0.0)
    rest = pool.map(lambda lead: _refit(fitter, best, lead, rival=rival), chosen[1:])
    trials = list(first)
    for found in tqdm(rest, desc=f"refit {label}", total=len(chosen[1:]), disable=not progress, leave=False):
        trials += found
    trials.sort(key=lambda t: -t.evidence_gain)
    temperature = TEMPERATURE * max([1.0, min((t.fitted.mean_square for t in trials), default=1.0)])
    passed = {t.effect for t in trials if bar.passed(t)}
    if trials and trials[0].effect in passed and not _holds(fitter, best, trials[0], further=bool(before)):
        passed = set()
    accepted = trials[0] if trials and trials[0].effect in passed else None
    probability = _probabilities(trials, passed, bar, temperature)
    return Round(tuple(leads), tuple(trials), probability, accepted, temperature)


def _holds(fitter: Fitter, best: Fitted, trial: Trial, *, further: bool) -> bool:
    """Near the floor, which a few repeats tell to a few per cent, an effect must matter; and there, as where it comes
    after another, it must predict experiments that it was not fitted to."""
    near_floor = best.mean_square < NEAR_FLOOR
    if near_floor and fitter.floor.repeated and trial.fitted.mean_square > (1 - MATTERS) * best.mean_square:
        return False
    if not (near_floor or further):
        return True
    try:
        return confirmed(fitter, best, trial.fitted)
    except NumericalError:
        return False


def _refit(fitter: Fitter, best: Fitted, lead: Lead, *, rival: float | None) -> list[Trial]:
    """The best fit over the starts of a lead."""
    found: Fitted | None = None
    for values in lead.starts if lead.simulated else ():
        found = _better(found, fitter, best, {lead.effect: values}, rival=rival)
    if _strained(fitter, best) and (found is None or found.mean_square > NEAR_FLOOR):
        found = _better(found, fitter, best, {lead.effect: lead.starts[0]}, rival=rival, believed=True)
    if found is None:
        return []
    gains = found.left_out - best.left_out
    spread = float(np.std(gains, ddof=1) * np.sqrt(len(gains))) if len(gains) > 1 else float("inf")
    return [Trial(lead.effect, found, found.evidence - best.evidence, float(np.sum(gains)), spread)]


def _better(
    found: Fitted | None,
    fitter: Fitter,
    best: Fitted,
    effect: Mapping[str, Mapping[str, float]],
    *,
    rival: float | None,
    believed: bool = False,
) -> Fitted | None:
    """`found`, or the fit of `best` with `effect` where that has more evidence; after a sketch, one that lies far
    behind `rival` is not finished. `believed`: from what was believed of the simulator, not from what it was tuned
    to."""
    added = (*best.added, *effect)
    try:
        system, initial = best.system.with_effects(effect), best.initial
        if believed:
            system, initial = _cooled(fitter, best, system, added)
        fitted = fitter.fit(system, added=added, initial=initial, max_iterations=SKETCH)
        behind = rival is not None and fitted.evidence - best.evidence < CATCH_UP * rival
        worse = found is not None and fitted.evidence < found.evidence - 50
        if not (fitted.converged or behind or worse):
            fitted = fitter.fit(fitted.system, added=added, initial=fitted.initial, max_iterations=40)
    except (NumericalError, ParameterError):
        return found
    return fitted if found is None or fitted.evidence > found.evidence else found


def _strained(fitter: Fitter, best: Fitted) -> bool:
    """Was a nominal parameter tuned further than is believable? It makes up for what is missing, and once that is
    there, its value is no good place to start from."""
    known = fitter.case.dataset.parameters
    return any(abs(x - f.mean) > STRAINED * f.sd for f, x in zip(best.free, best.x, strict=True) if f.name in known)


def _cooled(
    fitter: Fitter, best: Fitted, system: System, added: Sequence[str]
) -> tuple[System, tuple[tuple[float, ...], ...]]:
    """A start from the believed values: fits under noise as large as the misfit, so that what the data say little of
    stays where it is believed, as long as each fit halves the misfit."""
    known = fitter.case.dataset.parameters
    system = system.with_parameters({f.name: f.value(f.mean) for f in best.free if f.name in known})
    fitted = fitter.fit(system, added=added, solve=False)
    misfit = fitted.mean_square
    for _ in range(COOLINGS):
        level = max(1.0, misfit)
        fitted = fitter.under(level).fit(fitted.system, added=added, initial=fitted.initial, max_iterations=SKETCH)
        misfit = level * fitted.mean_square
        if misfit > 0.5 * level or misfit < NEAR_FLOOR:
            break
    return fitted.system, fitted.initial


def _bar(fitter: Fitter, before: Sequence[Round]) -> Bar:
    """A further effect may only imitate what is wrong with the shape of the first, and must gain more. Without repeats
    that error counts as noise already."""
    first = before[0].accepted if before else None
    if first is None:
        return Bar(DETECT_EVIDENCE, DETECT_LEFT_OUT, 0.0)
    if not fitter.floor.repeated:
        return Bar(DETECT_EVIDENCE, DETECT_LEFT_OUT, 2.0)
    return Bar(max(AGAIN_EVIDENCE, AGAIN_SHARE * first.evidence_gain), AGAIN_LEFT_OUT, 2.0)


def _probabilities(trials: Sequence[Trial], passed: Set[str], bar: Bar, temperature: float) -> dict[str | None, float]:
    """Tempered evidence: over-confident evidence is divided by a temperature. None stands for no (further) effect;
    what is not established ranks clearly behind it."""
    gains: dict[str | None, float] = {None: bar.evidence}
    for t in trials:
        most = np.inf if t.effect in passed else bar.evidence - UNCONFIRMED * temperature
        gains[t.effect] = min(t.evidence_gain, most)
    top = max(gains.values())
    weights = {name: float(np.exp((g - top) / temperature)) for name, g in gains.items()}
    total = sum(weights.values())
    return {name: w / total for name, w in weights.items()}

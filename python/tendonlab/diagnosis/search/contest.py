"""One more effect: screen all candidates, refit the hopeful, say which is established (docs/method.md)."""

from __future__ import annotations

from collections.abc import Sequence, Set
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

from tendonlab.diagnosis.search.halves import NEAR_FLOOR, confirmed
from tendonlab.diagnosis.search.refit import refit, strained
from tendonlab.diagnosis.search.screen import Lead, candidates, screen
from tendonlab.errors import NumericalError
from tendonlab.fitting.fitted import Fitted, Fitter

NUM_REFIT, NUM_REFIT_AGAIN = 8, 4
DETECT_EVIDENCE, DETECT_LEFT_OUT = 10.0, 3.0
AGAIN_EVIDENCE, AGAIN_LEFT_OUT, AGAIN_SHARE = 30.0, 9.0, 0.01
TEMPERATURE = 4.0  # tempering of evidence where the library is exact; it grows with what no model explains
UNCONFIRMED = 3.0  # temperatures by which an effect that left-out experiments do not confirm ranks behind none
MATTERS = 0.05  # share of the whitened mean square that an effect must remove near the floor
HOPEFUL = 0.3  # of what an effect must gain, which the screen must promise for a refit


@dataclass(frozen=True)
class Trial:
    """One refitted candidate against the model it extends: gains in nats."""

    effect: str
    fitted: Fitted
    evidence_gain: float
    left_out_gain: float
    left_out_se: float

    @classmethod
    def of(cls, effect: str, fitted: Fitted, base: Fitted) -> Trial:
        """What `fitted`, which has `effect`, gains over `base`, which has not."""
        gains = fitted.left_out - base.left_out
        spread = float(np.std(gains, ddof=1) * np.sqrt(len(gains))) if len(gains) > 1 else float("inf")
        return cls(effect, fitted, fitted.evidence - base.evidence, float(np.sum(gains)), spread)


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


DETECT = Bar(DETECT_EVIDENCE, DETECT_LEFT_OUT, 0.0)


@dataclass(frozen=True)
class Round:
    """One more effect beside those of `base`: all leads, the trials best first, the probability of each (key None: no
    further effect), the one that was added, and all that are `established`."""

    base: tuple[str, ...]
    leads: tuple[Lead, ...]
    trials: tuple[Trial, ...]
    probability: dict[str | None, float]
    accepted: Trial | None
    established: Set[str]


@dataclass(frozen=True)
class Workshop:
    """What every round needs: threads, whether progress is shown, the effects to choose from (None: all)."""

    pool: ThreadPoolExecutor
    progress: bool
    library: Sequence[str] | None

    def leads(self, fitter: Fitter, base: Fitted, label: str) -> list[Lead]:
        """All candidates as the screen sees them, most promising first."""
        names = [c for c in candidates(fitter.case, base) if self.library is None or c in self.library]
        work = self.pool.map(lambda name: screen(fitter, base, name), names)
        shown = tqdm(work, desc=f"screen {label}", total=len(names), disable=not self.progress, leave=False)
        return sorted(shown, key=lambda x: -x.gain)

    def refit(
        self, fitter: Fitter, base: Fitted, leads: Sequence[Lead], label: str, known: Trial | None = None
    ) -> list[Trial]:
        """The leads refitted, best first. `known`: one that is fitted already and sets the pace, as the first does
        otherwise."""
        first = [known] if known else _tried(fitter, base, leads[0], rival=None) if leads else []
        rival = max((t.evidence_gain for t in first), default=0.0)
        rest = [lead for lead in leads if lead.effect != known.effect] if known else leads[1:]
        work = self.pool.map(lambda lead: _tried(fitter, base, lead, rival=rival), rest)
        trials = list(first)
        for found in tqdm(work, desc=f"refit {label}", total=len(rest), disable=not self.progress, leave=False):
            trials += found
        return sorted(trials, key=lambda t: -t.evidence_gain)


def another(fitter: Fitter, best: Fitted, *, most: float, shop: Workshop) -> Round | None:
    """The round for one more effect beside those of `best`; None where the library holds no more. `most`: evidence that
    one gained before."""
    further = len(best.added) > 0
    label = f"effect {len(best.added) + 1}" if further else "effect"
    leads = shop.leads(fitter, best, label)
    if not leads:
        return None
    bar = again(fitter, most) if further else DETECT
    chosen = [x for x in leads if x.gain > HOPEFUL * bar.evidence][: NUM_REFIT_AGAIN if further else NUM_REFIT]
    if strained(fitter, best):  # what cannot be simulated from there may well be from what was believed
        chosen += [x for x in leads if not x.simulated]
    trials = shop.refit(fitter, best, chosen, label)
    passed = {t.effect for t in trials if bar.passed(t)}
    if trials and trials[0].effect in passed and not _holds(fitter, best, trials[0], further=further):
        passed = set()
    accepted = trials[0] if trials and trials[0].effect in passed else None
    return conclude(best, leads, trials, passed=passed, bar=bar, accepted=accepted)


def again(fitter: Fitter, most: float) -> Bar:
    """A further effect may only imitate what is wrong with the shape of the first, and must gain more. Without repeats
    that error counts as noise already."""
    if not fitter.floor.repeated:
        return Bar(DETECT.evidence, DETECT.left_out, 2.0)
    return Bar(max(AGAIN_EVIDENCE, AGAIN_SHARE * most), AGAIN_LEFT_OUT, 2.0)


def conclude(
    base: Fitted,
    leads: Sequence[Lead],
    trials: Sequence[Trial],
    *,
    passed: Set[str],
    bar: Bar,
    accepted: Trial | None,
) -> Round:
    """The round of `trials`, best first, of which those in `passed` are established and one, or none, is added."""
    temperature = TEMPERATURE * max([1.0, min((t.fitted.mean_square for t in trials), default=1.0)])
    return Round(
        base.added, tuple(leads), tuple(trials), _probabilities(trials, passed, bar, temperature), accepted, passed
    )


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


def _tried(fitter: Fitter, base: Fitted, lead: Lead, *, rival: float | None) -> list[Trial]:
    found = refit(fitter, base, lead, rival=rival)
    return [Trial.of(lead.effect, found, base)] if found else []


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

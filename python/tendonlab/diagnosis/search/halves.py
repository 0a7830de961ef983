"""Does an effect hold on samples that it was not fitted to? Two halves, each predicted by a fit to the other.

One Newton step stands for a refit without a block. Near the floor that is not enough: replays that drift magnify small
changes, and errors of the noise model look like evidence. The halves are every other block of 2 s of each experiment:
whole experiments would leave out what they alone determine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tendonlab.diagnosis.search.trial import doubt
from tendonlab.errors import NumericalError
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter

ITERATIONS = 6
MANY = 8  # scores of which the least and the largest may be left out


def predicts_better(fitter: Fitter, base: Fitted, extended: Fitted) -> bool:
    """Whether `extended` predicts each half of the samples, fitted to the other half, better than `base`: all in all,
    or without the experiment that gains least and the one that gains most. One run may stick elsewhere by chance.

    A fit that cannot be simulated predicts nothing: False."""
    base = base.counted(extended.shares)
    try:
        halves = [_scores(fitter, extended, odd=odd) - _scores(fitter, base, odd=odd) for odd in (False, True)]
    except NumericalError:
        return False
    gains = np.sort(np.concatenate(halves))
    return any(np.sum(some) > doubt(some) for some in (gains, gains[1:-1] if len(gains) >= MANY else gains))


def _scores(fitter: Fitter, model: Fitted, *, odd: bool) -> np.ndarray:
    """Log score of each experiment on one half of its blocks, after a refit to the other half alone. That half may not
    hold the beginning of a run: where its initial state predicts worse than that of the whole fit, the latter counts.
    """
    under = fitter.left_by(model)
    learning, judging = (replace(under, case=fitter.case.on_half(odd=half)) for half in (not odd, odd))
    learnt = learning.fit(model.system, added=model.added, initial=model.initial, max_iterations=ITERATIONS)
    starts = (learnt.initial, model.initial)
    predicted = [judging.fit(learnt.system, added=model.added, initial=each, solve=False) for each in starts]
    return np.asarray(np.maximum(*(each.by_experiment(each.scores) for each in predicted)))

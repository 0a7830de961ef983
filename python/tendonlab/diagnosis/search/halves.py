"""Does an effect hold on experiments that it was not fitted to? Two halves, each predicted by a fit to the other.

One Newton step stands for a refit without an experiment. Near the floor that is not enough: replays that drift magnify
small changes, and what the noise model misses looks like evidence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tendonlab.fitting.fitted import FEW, Fitted, Fitter

NEAR_FLOOR = 1.3  # whitened mean square below which the model without the effect is nearly at the floor
ITERATIONS = 6
STEADY = 2.0  # standard errors over experiments by which the effect must predict better


def confirmed(fitter: Fitter, without: Fitted, effect: Fitted) -> bool:
    """Whether the model with the effect predicts each half of the training experiments better than the one without it.
    With fewer than four experiments there are no halves to speak of: then nothing is asked."""
    train = fitter.case.train
    if len(train) < FEW:
        return True
    halves = train[::2], train[1::2]
    gains = np.concatenate(
        [
            _scores(fitter, effect, fold, other) - _scores(fitter, without, fold, other)
            for fold, other in (halves, halves[::-1])
        ]
    )
    return bool(gains.sum() > STEADY * gains.std(ddof=1) * np.sqrt(len(gains)))


def _scores(fitter: Fitter, model: Fitted, fitted_to: tuple[int, ...], judged: tuple[int, ...]) -> np.ndarray:
    """Log score of each experiment in `judged`, its initial state marginalised, after a refit to the others alone."""
    initial = dict(zip(fitter.case.train, model.initial, strict=True))
    there, here = (replace(fitter, case=fitter.case.training_on(of)) for of in (fitted_to, judged))
    learnt = there.fit(
        model.system, added=model.added, initial=[initial[i] for i in fitted_to], max_iterations=ITERATIONS
    )
    seen = here.fit(learnt.system, added=model.added, initial=[initial[i] for i in judged], solve=False)
    scores = np.zeros(len(judged))
    for block in seen.blocks:
        scores[block.experiment] -= 0.5 * float(block.residual @ block.residual)
    return scores

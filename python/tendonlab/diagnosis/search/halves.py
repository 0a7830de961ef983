"""Does an effect hold on experiments that it was not fitted to? Two halves, each predicted by a fit to the other.

One Newton step stands for a refit without an experiment. Near the floor that is not enough: replays that drift magnify
small changes, and errors of the noise model look like evidence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tendonlab.errors import NumericalError
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter
from tendonlab.fitting.uncertainty import FEWEST_EXPERIMENTS

NEAR_FLOOR = 1.3  # whitened mean square below which the model without the effect is nearly at the floor
ITERATIONS = 6
STEADY = 2.0  # standard errors over experiments by which the effect must predict better


def predicts_better(fitter: Fitter, base: Fitted, extended: Fitted) -> bool:
    """Whether `extended` predicts each half of the training experiments, fitted to the other half, better than `base`.

    Fewer than four experiments have no halves: then True. A fit that cannot be simulated predicts nothing: False."""
    train = fitter.case.train
    if len(train) < FEWEST_EXPERIMENTS:
        return True
    halves = train[::2], train[1::2]
    try:
        gains = np.concatenate([_gains(fitter, base, extended, *fold) for fold in (halves, halves[::-1])])
    except NumericalError:
        return False
    return bool(gains.sum() > STEADY * gains.std(ddof=1) * np.sqrt(len(gains)))


def _gains(
    fitter: Fitter, base: Fitted, extended: Fitted, fitted_to: tuple[int, ...], judged: tuple[int, ...]
) -> np.ndarray:
    return np.asarray(_scores(fitter, extended, fitted_to, judged) - _scores(fitter, base, fitted_to, judged))


def _scores(fitter: Fitter, model: Fitted, fitted_to: tuple[int, ...], judged: tuple[int, ...]) -> np.ndarray:
    """Log score of each experiment in `judged`, its initial state marginalised, after a refit to the others alone."""
    initial = dict(zip(fitter.case.train, model.initial, strict=True))
    learning, judging = (replace(fitter, case=fitter.case.training_on(part)) for part in (fitted_to, judged))
    learnt = learning.fit(
        model.system, added=model.added, initial=[initial[i] for i in fitted_to], max_iterations=ITERATIONS
    )
    predicted = judging.fit(learnt.system, added=model.added, initial=[initial[i] for i in judged], solve=False)
    scores = np.zeros(len(judged))
    for block in predicted.blocks:
        scores[block.experiment] -= 0.5 * float(block.residual @ block.residual)
    return scores

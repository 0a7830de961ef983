"""Does an effect mend slow errors? Whitening takes most of a slow error for slow noise, and friction that differs from
run to run takes up more. Near the floor an effect that mends one then gains little, as errors of a form do."""

from __future__ import annotations

import numpy as np

from tendonlab.diagnosis.search.trial import Trial, is_friction_beside, is_friction_elsewhere
from tendonlab.errors import NumericalError
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter

FIRMLY = 300.0  # nats: near the floor of repeats effects that are not there gained 291 at most
ABOVE = 0.3  # mean square above the floor of single outputs, in floors, of which something can be mended
HALF = 0.5  # share of that which the effect must remove


def mends_slow_errors(fitter: Fitter, base: Fitted, trial: Trial) -> bool:
    """Whether the trial gains far more than errors of a form do near the floor, and removes half of what `base` leaves
    above the plain floor of single outputs in the training experiments."""
    gained = min(trial.evidence_gain, trial.left_out_gain)
    if gained < FIRMLY or is_friction_beside(base, trial) or is_friction_elsewhere(base, trial):
        return False
    try:
        before, after = _above(fitter, base), _above(fitter, trial.fitted)
    except NumericalError:
        return False
    return before > ABOVE and after < (1.0 - HALF) * before


def _above(fitter: Fitter, model: Fitted) -> float:
    """Mean square above the plain floor, in floors, summed over the outputs, under the same friction in every run."""
    case, left = fitter.case, []
    for i, own in zip(case.train, model.initial, strict=True):
        ready = case.prepared[i]
        states = [*own[: len(ready.initial)], *(0.0 for _ in case.scatter)]
        left.append(case.run(i, model.system, states)["outputs"] - ready.measured)
    square = np.nanmean(np.square(np.concatenate(left, axis=1)[case.measured]), axis=1)
    return float(np.sum(np.maximum(square / np.square(fitter.floor.rms[case.measured]) - 1.0, 0.0)))

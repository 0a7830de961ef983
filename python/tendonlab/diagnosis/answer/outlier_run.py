"""Whether one training experiment alone leaves more than noise: then the others decide.

Where a mechanism stops, noise moves the place by a little, and dry friction keeps that error until the next move. No
effect of the library makes one run of many differ, and repeats of another motion do not show such noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tendonlab.diagnosis.answer.verdict import NO_GAP, Levels
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import NEAR_FLOOR, Floor

ENOUGH = 5  # training experiments, of which the others can decide
FAR_ALONE = 5.0  # whitened mean square of a single run that is no noise: of rigs that lack nothing, 4.2 at most


@dataclass(frozen=True)
class OutlierRun:
    """The `run`, a training experiment, that alone leaves more than noise: a mean square of `level`; all others of
    `others`."""

    run: int
    name: str
    level: float
    others: float

    def left_out(self, levels: Levels, nominal: Fitted) -> Levels:
        """The levels without this run. `nominal`: the untouched simulator, fitted in its initial states alone."""
        return replace(levels, nominal=_without(nominal, self.run), tuned=self.others)


def find_outlier_run(case: Case, tuned: Fitted, floor: Floor) -> OutlierRun | None:
    """The training experiment without which the refitted simulator is at the floor; None where there is none, or where
    that one run is far above all noise. Only repeats tell a floor well enough."""
    if not floor.repeated or len(tuned.runs) < ENOUGH or tuned.mean_square < NEAR_FLOOR:
        return None
    levels = [run.cost / len(run.residual) for run in tuned.runs]
    run = int(np.argmax(levels))
    level, rest = levels[run], _without(tuned, run)
    if not NEAR_FLOOR < level < FAR_ALONE or rest > NO_GAP:
        return None
    return OutlierRun(run, case.experiments[case.train[run]].name, level, rest)


def _without(fit: Fitted, run: int) -> float:
    """Mean square of the whitened residuals of all training experiments but one, with what their own unknowns cost."""
    others = [r for k, r in enumerate(fit.runs) if k != run]
    return sum(r.cost for r in others) / sum(len(r.residual) for r in others)

"""A refitted candidate, what it gained, and the bar that its gains must pass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter

FURTHER_EVIDENCE, FURTHER_LEFT_OUT, FURTHER_SHARE = 30.0, 9.0, 0.01


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

    def passed(self, trial: Trial) -> bool:
        """Whether the trial establishes its effect."""
        left_out = max(self.left_out, self.steady * trial.left_out_se)
        return trial.evidence_gain > self.evidence and trial.left_out_gain > left_out


DETECT = Bar(evidence=10.0, left_out=3.0, steady=0.0)


def bar_for_further_effect(fitter: Fitter, largest_gain: float) -> Bar:
    """The bar for an effect beyond the first, which may only imitate what is wrong with the shape of the first.

    `largest_gain`: the most evidence that an effect has gained so far. Without repeats the noise floor already contains
    the error of the shape."""
    if not fitter.floor.repeated:
        return Bar(DETECT.evidence, DETECT.left_out, 2.0)
    return Bar(max(FURTHER_EVIDENCE, FURTHER_SHARE * largest_gain), FURTHER_LEFT_OUT, 2.0)

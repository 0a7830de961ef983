"""Whether data tell how large an effect is although its interval holds 0: a slope tells no interval of what jumps.

A reading that jumps between samples is a staircase over its delay, and friction that decides when a rig sticks moves
whole phases of a motion. Slopes there are those of one stair."""

from __future__ import annotations

from dataclasses import replace

from tendonlab.diagnosis.search.trial import CLEAR, Trial, explains_half
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter

LOST = 0.05  # share of the error that an effect removes, which half of it must leave for the data to tell its size


def with_told(fitter: Fitter, base: Fitted, trial: Trial) -> Trial:
    """The trial; not as one of nothing where it explains half of the rest and half of its effect is too little.

    Of about a hundred wrong effects whose intervals held 0 four explained as much, of eight right ones six."""
    if not trial.is_nothing or trial.evidence_gain < CLEAR.evidence or not explains_half(base, trial.fitted):
        return trial
    return replace(trial, is_nothing=False) if _lost_by_half(fitter, base, trial) > LOST else trial


def _lost_by_half(fitter: Fitter, base: Fitted, trial: Trial) -> float:
    """Share of the error that the effect removes from `base`, which half of it leaves; all where half of it cannot be
    simulated."""
    fit, info = trial.fitted, trial.fitted.system.info
    rows = [info.parameter(name) for name in info.effect(trial.effect).parameters]
    half = {p.name: 0.5 * fit.system.parameters[p.name] for p in rows if p.purpose == "amplitude"}
    try:
        less = fitter.fit(fit.system.with_parameters(half), added=fit.added, initial=fit.initial, solve=False)
    except (NumericalError, ParameterError):
        return 1.0
    return (less.mean_square - fit.mean_square) / max(base.mean_square - fit.mean_square, 1e-9)

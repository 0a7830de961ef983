"""One candidate refitted: from the tuned simulator, and from its nominal values where tuning strained them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from tendonlab.diagnosis.search.halves import NEAR_FLOOR
from tendonlab.diagnosis.search.screen import Screened
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter
from tendonlab.simulation.system import System

SKETCH = 5  # iterations after which a fit that cannot catch up is abandoned
CATCH_UP = 0.5  # share of the rival's evidence gain that a sketch must reach to be finished
BEHIND = 50.0  # nats behind the same effect from another start, at which a sketch is abandoned
STRAINED = 3.0  # sd between a tuned parameter and its prior mean, beyond which it compensates for something
NUM_COOLINGS = 6  # fits under noise as large as the misfit, at the most
COOLED = 0.01  # relative change of the cost at which a cooling ends: all that counts is whether it halves the misfit

Values = Mapping[str, Mapping[str, float]]  # of the parameters of effects, by effect


def refit(fitter: Fitter, base: Fitted, candidate: Screened, *, rival_gain: float | None) -> Fitted | None:
    """The best fit of `base` with the candidate over its starts, None where no fit succeeds.

    A fit that lies far behind `rival_gain`, the evidence gain of a rival, is not finished."""
    best: Fitted | None = None
    for values in candidate.starts if candidate.simulated else ():
        fit = _fit(fitter, base, {candidate.effect: values}, best, rival_gain=rival_gain)
        best = more_evident(best, fit)
    if strained(fitter, base) and (best is None or best.mean_square > NEAR_FLOOR):
        values = candidate.starts[0]
        fit = _fit(fitter, base, {candidate.effect: values}, best, rival_gain=rival_gain, from_nominal=True)
        best = more_evident(best, fit)
    return best


def more_evident(best: Fitted | None, fit: Fitted | None) -> Fitted | None:
    """Whichever of two fits has more evidence. A fit whose derivatives exploded has none that counts."""
    if fit is None or not math.isfinite(fit.evidence):
        return best
    return fit if best is None or fit.evidence > best.evidence else best


def _fit(
    fitter: Fitter,
    base: Fitted,
    effect: Values,
    best: Fitted | None,
    *,
    rival_gain: float | None,
    from_nominal: bool = False,
) -> Fitted | None:
    """`base` refitted with `effect`, None where that fails; only a sketch where it lies far behind the rival or `best`.

    `from_nominal`: start at the nominal values of the simulator instead of the tuned ones."""
    added = (*base.added, *effect)
    enough = _evidence_to_reach(base, best, rival_gain)
    try:
        system, initial = base.system.with_effects(effect), base.initial
        if from_nominal:
            system, initial = _cooled(fitter, base, system, added)
        goal = base.cost - (enough - base.evidence) / base.effective
        fit = fitter.fit(system, added=added, initial=initial, max_iterations=SKETCH, goal=goal)
        if not (fit.converged or fit.evidence < enough):
            fit = fitter.fit(fit.system, added=added, initial=fit.initial, max_iterations=40)
    except (NumericalError, ParameterError):
        return None
    return fit


def _evidence_to_reach(base: Fitted, best: Fitted | None, rival_gain: float | None) -> float:
    """The evidence below which a sketch lies too far behind the rival or the best fit so far."""
    rival = -math.inf if rival_gain is None else base.evidence + CATCH_UP * rival_gain
    return rival if best is None else max(rival, best.evidence - BEHIND)


def strained(fitter: Fitter, base: Fitted) -> bool:
    """Whether a nominal parameter was tuned further than its prior makes believable. It then compensates for a missing
    effect, and its value is a poor start once the effect is there."""
    stated = fitter.case.dataset.parameters
    return any(abs(x - f.mean) > STRAINED * f.sd for f, x in zip(base.free, base.x, strict=True) if f.name in stated)


def _cooled(
    fitter: Fitter, base: Fitted, system: System, added: Sequence[str]
) -> tuple[System, tuple[tuple[float, ...], ...]]:
    """A start from the nominal values: fits under noise as large as the misfit, as long as each fit halves the misfit.

    Under so much noise, parameters that the data hardly determine stay at their nominal values."""
    stated = fitter.case.dataset.parameters
    system = system.with_parameters({f.name: f.value(f.mean) for f in base.free if f.name in stated})
    fit = fitter.fit(system, added=added, solve=False)
    misfit = fit.mean_square
    for _ in range(NUM_COOLINGS):
        level = max(1.0, misfit)
        fit = fitter.under(level).fit(
            fit.system, added=added, initial=fit.initial, max_iterations=SKETCH, tolerance=COOLED
        )
        misfit = level * fit.mean_square
        if misfit > 0.5 * level or misfit < NEAR_FLOOR:
            break
    return fit.system, fit.initial

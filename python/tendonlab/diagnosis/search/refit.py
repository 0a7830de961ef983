"""One candidate refitted: from the tuned simulator, and from its nominal values where tuning strained them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from tendonlab.diagnosis.search.following import followed
from tendonlab.diagnosis.search.screen import Screened
from tendonlab.diagnosis.search.swap import extended
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import NEAR_FLOOR
from tendonlab.fitting.problem import Fitter, pose
from tendonlab.fitting.starts import annealed
from tendonlab.simulation.catalog import SystemInfo
from tendonlab.simulation.system import System

MAX_ITERATIONS = 45
SKETCH = 5  # iterations after which a fit that cannot catch up is abandoned
CATCH_UP = 0.5  # share of the rival's evidence gain that a sketch must reach to be finished
BEHIND = 50.0  # nats behind the same effect from another start, at which a sketch is abandoned
STRAINED = 3.0  # sd between a tuned parameter and its prior mean, beyond which it compensates for something
LESSENED = 0.1  # share of the start of an effect from which a fit begins again that led away from its base
EXPLODED = "the derivatives of every fit are too large to tell anything"
MOST = 700.0  # logarithm of the largest ratio of costs: far behind is behind


def refit(fitter: Fitter, base: Fitted, candidate: Screened, *, pace: float) -> Fitted:
    """The best fit of `base` with the candidate over its starts, settled unless it lies far behind.

    `pace`: evidence of a rival, all rows counted; a fit that lies far behind is not finished. Raises NumericalError
    where no fit succeeds, with the reason that the last one failed for."""
    best: Fitted | None = None
    to_settle: Fitted | None = None
    trouble: NumericalError | ParameterError = NumericalError(candidate.trouble)

    def attempt(start: Mapping[str, float], *, from_nominal: bool = False) -> None:
        nonlocal best, to_settle, trouble
        try:
            found, whole = _fit(fitter, base, candidate.effect, start, best, pace=pace, from_nominal=from_nominal)
            better = more_evident(best, found)
            to_settle = to_settle if better is best else whole
            best = better
        except (NumericalError, ParameterError) as failed:
            trouble = failed

    starts = candidate.starts[:1] if candidate.far_behind else candidate.starts
    for values in starts if candidate.simulated else ():
        attempt(values)
    if best is not None and best.counted().evidence < base.counted().evidence:  # no fit of more parameters need lose
        attempt(_lessened(base.system.info, candidate.starts[0]))
    hidden = strained(fitter, base) and not candidate.poor_when_believed
    # Near the floor a base that is strained may hide an effect by which it is believed, and by little else.
    if best is None or (hidden and (best.mean_square > NEAR_FLOOR or base.mean_square < NEAR_FLOOR)):
        attempt(candidate.starts[0], from_nominal=True)
    if best is None:
        raise NumericalError(str(trouble))
    if to_settle is None:
        return best
    try:
        settled = fitter.settled(to_settle)
    except (NumericalError, ParameterError):
        return best
    return settled if math.isfinite(settled.evidence) else best


def _lessened(info: SystemInfo, start: Mapping[str, float]) -> dict[str, float]:
    """The same start with little of the effect."""
    amplitudes = {name for name in start if info.parameter(name).purpose == "amplitude"}
    return {name: LESSENED * value if name in amplitudes else value for name, value in start.items()}


def more_evident(best: Fitted | None, fit: Fitted) -> Fitted:
    """Whichever of two fits has more evidence. A fit whose derivatives exploded has none that counts: without another
    one it raises NumericalError."""
    if not math.isfinite(fit.evidence):
        if best is None:
            raise NumericalError(EXPLODED)
        return best
    return fit if best is None or fit.counted().evidence > best.counted().evidence else best


def restarted(fitter: Fitter, base: Fitted, leader: Fitted, fit: Fitted) -> Fitted:
    """The better of `fit` and a fit of the same model from where the `leader`, another extension of `base`, ended: two
    effects that say the same must not differ by the optimum that each of them found."""
    there = leader.system.parameters  # a whole friction takes the place of others, parameters and all
    shared = {f.name: there[f.name] for f in base.free if f.name in there and f.name in fit.system.parameters}
    try:
        system = fit.system.with_parameters(shared)
        again = fitter.settled(fitter.fit(system, added=fit.added, initial=leader.initial))
    except (NumericalError, ParameterError):
        return fit
    return more_evident(fit, again)


def _fit(
    fitter: Fitter,
    base: Fitted,
    effect: str,
    start: Mapping[str, float],
    best: Fitted | None,
    *,
    pace: float,
    from_nominal: bool = False,
) -> tuple[Fitted, Fitted | None]:
    """`base` refitted with `effect`, whose parameters begin at `start`: what the fit is worth under the noise that it
    leaves, and the fit itself, which is None where it is only a sketch: far behind the rival or `best`.

    `from_nominal`: start at the nominal values of the simulator instead of the tuned ones. Raises NumericalError or
    ParameterError where that fails."""
    added = (*base.added, effect)
    needed = _needed(base, best, pace)
    goal = _goal(fitter, base, needed)
    if from_nominal:
        system, initial = _annealed(fitter, base, extended(base.system, {effect: start}), added)
    else:
        system, initial = followed(fitter, base, effect, start)
    fit = fitter.fit(system, added=added, initial=initial, max_iterations=MAX_ITERATIONS, goal=goal, goal_within=SKETCH)
    worth = fitter.releveled(fit)
    if fit.cost <= goal:
        return worth, fit
    if worth.counted().evidence - base.counted().evidence < needed:
        return worth, None
    # Beliefs that the base strains, and noise that differs, count otherwise in cost than in evidence.
    fit = fitter.fit(fit.system, added=added, initial=fit.initial, max_iterations=MAX_ITERATIONS)
    return fitter.releveled(fit), fit


def _needed(base: Fitted, best: Fitted | None, pace: float) -> float:
    """Nats over the base that a sketch must gain, or it lies too far behind the rival or the best fit so far."""
    here = base.counted().evidence
    rival = CATCH_UP * (pace - here)
    return rival if best is None else max(rival, best.counted().evidence - BEHIND - here)


def _goal(fitter: Fitter, base: Fitted, needed: float) -> float:
    """About the cost above which a sketch gains less than that."""
    if fitter.floor.repeated:
        return base.cost - needed
    rows = sum(len(run.residual) for run in base.runs)  # a gain under noise of one's own, in cost under the base's
    return base.cost * math.exp(min(-2.0 * needed / rows, MOST))


def strained(fitter: Fitter, base: Fitted) -> bool:
    """Whether a nominal parameter was tuned further than its prior makes believable. It then compensates for a missing
    effect, and its value is a poor start once the effect is there."""
    stated = fitter.case.dataset.parameters
    return any(abs(x - f.mean) > STRAINED * f.sd for f, x in zip(base.free, base.x, strict=True) if f.name in stated)


def at_believed_values(fitter: Fitter, base: Fitted) -> tuple[Fitter, Fitted]:
    """The `base` with what was stated back at its prior mean, not refitted, under noise as large as its misfit; and the
    fitter under that noise. Raises NumericalError where it cannot be simulated."""
    system = _believed(fitter, base, base.system)
    misfit = fitter.fit(system, added=base.added, initial=base.initial, solve=False).whitened_square
    under = fitter.under(max(1.0, misfit))
    return under, under.fit(system, added=base.added, initial=base.initial, solve=False)


def _believed(fitter: Fitter, base: Fitted, system: System) -> System:
    """The `system` with every free parameter of `base` that was stated at its prior mean."""
    stated = fitter.case.dataset.parameters
    free = [f for f in base.free if f.name in stated and f.name in system.parameters]
    return system.with_parameters({f.name: f.value(f.mean) for f in free})


def _annealed(
    fitter: Fitter, base: Fitted, system: System, added: Sequence[str]
) -> tuple[System, tuple[tuple[float, ...], ...]]:
    """A start from the nominal values."""
    believed = _believed(fitter, base, system)
    there = annealed(pose(fitter.case, fitter.floor, believed, added=added), fitter.cancel)
    return there.system, there.initial

"""One candidate refitted: from the tuned simulator, and from what was believed of it where tuning strained it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from tendonlab.diagnosis.search.halves import NEAR_FLOOR
from tendonlab.diagnosis.search.screen import Lead
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.fitting.fitted import Fitted, Fitter
from tendonlab.simulation.system import System

SKETCH = 5  # iterations after which a fit that cannot catch up is abandoned
CATCH_UP = 0.5
STRAINED = 3.0  # sd from what was believed, to which a parameter was tuned: it makes up for something
COOLINGS = 6  # fits under noise as large as the misfit, at the most


def refit(fitter: Fitter, best: Fitted, lead: Lead, *, rival: float | None) -> Fitted | None:
    """The best fit of `best` with the effect of `lead` over its starts, None where none succeeds; one that lies far
    behind `rival`, an evidence gained, is not finished."""
    found: Fitted | None = None
    for values in lead.starts if lead.simulated else ():
        found = _better(found, fitter, best, {lead.effect: values}, rival=rival)
    if strained(fitter, best) and (found is None or found.mean_square > NEAR_FLOOR):
        found = _better(found, fitter, best, {lead.effect: lead.starts[0]}, rival=rival, believed=True)
    return found


def _better(
    found: Fitted | None,
    fitter: Fitter,
    best: Fitted,
    effect: Mapping[str, Mapping[str, float]],
    *,
    rival: float | None,
    believed: bool = False,
) -> Fitted | None:
    """`found`, or the fit of `best` with `effect` where that has more evidence; after a sketch, one that lies far
    behind `rival` is not finished. `believed`: from what was believed of the simulator, not from what it was tuned
    to."""
    added = (*best.added, *effect)
    try:
        system, initial = best.system.with_effects(effect), best.initial
        if believed:
            system, initial = _cooled(fitter, best, system, added)
        fitted = fitter.fit(system, added=added, initial=initial, max_iterations=SKETCH)
        behind = rival is not None and fitted.evidence - best.evidence < CATCH_UP * rival
        worse = found is not None and fitted.evidence < found.evidence - 50
        if not (fitted.converged or behind or worse):
            fitted = fitter.fit(fitted.system, added=added, initial=fitted.initial, max_iterations=40)
    except (NumericalError, ParameterError):
        return found
    if not math.isfinite(fitted.evidence):  # derivatives that explode tell nothing, and would outbid everything
        return found
    return fitted if found is None or fitted.evidence > found.evidence else found


def strained(fitter: Fitter, best: Fitted) -> bool:
    """Was a nominal parameter tuned further than is believable? It makes up for what is missing, and once that is
    there, its value is no good place to start from."""
    known = fitter.case.dataset.parameters
    return any(abs(x - f.mean) > STRAINED * f.sd for f, x in zip(best.free, best.x, strict=True) if f.name in known)


def _cooled(
    fitter: Fitter, best: Fitted, system: System, added: Sequence[str]
) -> tuple[System, tuple[tuple[float, ...], ...]]:
    """A start from the believed values: fits under noise as large as the misfit, so that what the data say little of
    stays where it is believed, as long as each fit halves the misfit."""
    known = fitter.case.dataset.parameters
    system = system.with_parameters({f.name: f.value(f.mean) for f in best.free if f.name in known})
    fitted = fitter.fit(system, added=added, solve=False)
    misfit = fitted.mean_square
    for _ in range(COOLINGS):
        level = max(1.0, misfit)
        fitted = fitter.under(level).fit(fitted.system, added=added, initial=fitted.initial, max_iterations=SKETCH)
        misfit = level * fitted.mean_square
        if misfit > 0.5 * level or misfit < NEAR_FLOOR:
            break
    return fitted.system, fitted.initial

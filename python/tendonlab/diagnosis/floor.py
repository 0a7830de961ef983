"""The noise floor that a diagnosis judges under: the first one, and a new one after each effect that was added."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from tendonlab import _core
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case, fine_enough
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.floor import Sensitivities, estimate, friction_groups, sensitivities, with_steady_starts
from tendonlab.fitting.noise import Floor
from tendonlab.fitting.problem import Fitter


def under_noise_floor(case: Case, rough: Fitted, pool: ThreadPoolExecutor, cancel: _core.Cancel) -> Fitter:
    """The fitter under the noise floor: from repeats, else from the residuals of a rough fit.

    Friction then varies from run to run as the floor says, and the simulator is as exact as the floor requires."""
    floor, seen = first_floor(case, rough, pool)
    groups = tuple((tuple(group), floor.tau) for group in friction_groups(case.system, with_added=True))
    case = fine_enough(case, np.fmax(case.noise, np.fmin(floor.rms, floor.sd)))
    return Fitter(replace(case, scatter=groups), floor, cancel, seen)


def first_floor(case: Case, rough: Fitted, pool: ThreadPoolExecutor) -> tuple[Floor, list[Sensitivities]]:
    """The noise floor that the residuals of a rough fit, or their differences between repeats, show; and what was seen
    of every experiment."""
    seen = _sensitivities(case, rough, pool)
    return estimate(case, with_steady_starts(case, seen, _at_belief(case, rough, pool)), case.train), seen


def _at_belief(case: Case, rough: Fitted, pool: ThreadPoolExecutor) -> dict[int, Sensitivities]:
    """Of each repeat from what is believed of its initial state; nothing is known of one that cannot be simulated."""

    def seen(i: int) -> Sensitivities:
        return _seen(case, rough, i, case.own_mean(i).tolist(), required=False)

    repeats = [i for i, experiment in enumerate(case.experiments) if experiment.repeat is not None]
    return dict(zip(repeats, pool.map(seen, repeats), strict=True))


def renewed(fitter: Fitter, model: Fitted, pool: ThreadPoolExecutor) -> tuple[Fitter, Fitted]:
    """The fitter for the search beyond `model`, and the model settled under it.

    Repeats determine the noise once and for all. Without them, noise is what each model leaves."""
    model = fitter.settled(model)
    if fitter.floor.repeated:
        return fitter, model
    under = fitter.left_by(model)
    model = under.settled(under.fit(model.system, added=model.added, initial=model.initial))
    return replace(under.left_by(model), seen=_sensitivities(fitter.case, model, pool)), model


def _sensitivities(case: Case, fitted: Fitted, pool: ThreadPoolExecutor) -> list[Sensitivities]:
    """Of every experiment at a model; nothing is known of a held-out one that cannot be simulated."""
    initial = dict(zip(case.train, fitted.initial, strict=True))

    def seen(i: int) -> Sensitivities:
        start = initial.get(i, case.own_mean(i).tolist())
        return _seen(case, fitted, i, start, required=i in initial)

    return list(pool.map(seen, range(len(case.experiments))))


def _seen(case: Case, fitted: Fitted, i: int, own: Sequence[float], *, required: bool) -> Sensitivities:
    """Of experiment i; nothing is known of one that cannot be simulated, or if it is `required`, that is an error."""
    try:
        return sensitivities(case, fitted.system, i, own)
    except NumericalError:
        if required:
            raise
        return Sensitivities.unknown(case.prepared[i].measured)

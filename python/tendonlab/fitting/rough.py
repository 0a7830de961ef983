"""A rough fit: before anything is known of the noise but what the sensors say."""

from __future__ import annotations

from tendonlab import _core
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import Fitter, pose
from tendonlab.fitting.starts import annealed

ROUGH, NEARLY = 8, 1e-4  # iterations and tolerance of fits under the sensors' white noise


def rough_fit(case: Case, cancel: _core.Cancel) -> Fitted:
    """A fit under the sensors' white noise alone, before the floor is known. Where that drives a parameter to a bound,
    under noise as large as the misfit: so little noise believes a wrong model against all that is stated."""
    fitter = Fitter(case, white(case.noise), cancel)
    fit = fitter.fit(case.system, max_iterations=ROUGH, tolerance=NEARLY)
    problem = pose(case, fitter.floor, fit.system, initial=fit.initial)
    fit = problem.reseated(fit, cancel, max_iterations=ROUGH, tolerance=NEARLY)
    return annealed(pose(case, fitter.floor, case.system), cancel).linearise() if any(fit.at_bound) else fit

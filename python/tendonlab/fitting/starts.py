"""Starts that lead a fit to its best optimum: sticking gives the cost of one fit many optima."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from tendonlab.fitting.noise import NEAR_FLOOR

if TYPE_CHECKING:
    from tendonlab import _core
    from tendonlab.fitting.fitted import Fitted, Run
    from tendonlab.fitting.problem import Problem

NUM_COOLINGS, STEPS = 6, 5  # fits under noise as large as the misfit, at the most, and iterations of each
COOLED = 0.01  # relative change of the cost at which a cooling ends: all that counts is whether it halves the misfit
NUM_RESTARTS = 3
BETTER = 0.99  # share of a run's cost that its own unknowns must at most leave to start again from them


def cooled(problem: Problem, cancel: _core.Cancel) -> Problem:
    """The problem where fits under noise as large as the misfit end, as long as each halves the misfit.

    Under so much noise, parameters that the data hardly determine stay at their starts, and no single event of sticking
    decides. Raises NumericalError where a simulation fails at the start."""
    fit = problem.linearise()
    misfit = fit.whitened_square
    for _ in range(NUM_COOLINGS):
        level = max(1.0, misfit)
        there = problem.under(level).at(fit.system, fit.initial)
        fit = there.solve(cancel=cancel, max_iterations=STEPS, tolerance=COOLED)
        misfit = level * fit.whitened_square
        if misfit > 0.5 * level or misfit < NEAR_FLOOR:
            break
    return problem.at(fit.system, fit.initial)


def reseated(problem: Problem, fit: Fitted, cancel: _core.Cancel, *, steps: int = 2 * STEPS) -> Fitted:
    """The `fit`, again with the initial states of some runs found anew from what is believed of them: early steps of a
    fit may leave a run that starts at rest in a place where stiction holds it. `steps`: iterations for these states."""
    for _ in range(NUM_RESTARTS):
        if cancel.is_set() or not any(len(run.own) for run in fit.runs):
            return fit
        alone = replace(problem, free=(), system=fit.system, initial=())
        fresh = alone.solve(cancel=cancel, max_iterations=steps) if steps else alone.linearise()
        better = [_cost(new) < BETTER * _cost(old) for new, old in zip(fresh.runs, fit.runs, strict=True)]
        if not any(better):
            return fit
        own = [new if b else old for new, old, b in zip(fresh.initial, fit.initial, better, strict=True)]
        again = problem.at(fit.system, own).solve(cancel=cancel)
        if not again.cost < fit.cost:
            return fit
        fit = again
    return fit


def _cost(run: Run) -> float:
    return float(run.residual @ run.residual + run.own @ run.own)

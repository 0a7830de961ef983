"""Starts that lead a fit to its best optimum: sticking gives the cost of one fit many optima."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tendonlab.fitting.noise import NEAR_FLOOR

if TYPE_CHECKING:
    from tendonlab import _core
    from tendonlab.fitting.problem import Problem

NUM_COOLINGS, STEPS = 6, 5  # fits under noise as large as the misfit, at the most, and iterations of each
COOLED = 0.01  # relative change of the cost at which a cooling ends: all that counts is whether it halves the misfit


def annealed(problem: Problem, cancel: _core.Cancel) -> Problem:
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

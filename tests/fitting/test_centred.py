"""Friction that all runs share belongs to the parameters: the same residuals, better beliefs."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tendonlab._core import Free
from tendonlab.fitting.centred import _best_shift, centred
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import pose


def started_off(twin_case: Any, shift: float) -> Any:
    """The fit's problem at friction of the joint that is too strong by `shift`, which every run's factor undoes."""
    names = ("joint_coulomb", "joint_viscous")
    system = twin_case.system
    group = tuple(k for k, row in enumerate(system.info.parameters) if row.name in names)
    case = replace(twin_case, scatter=((group, 0.008),))
    stronger = system.with_parameters({n: np.exp(shift) * system.parameters[n] for n in names})
    problem = pose(case, white(case.noise), system)
    own = [[*case.own_mean(i)[:-1], -shift] for i in case.train]
    return problem.at(stronger, own)


@pytest.mark.parametrize("shift", [0.1, -0.1])
def test_a_common_factor_goes_to_the_parameters_and_changes_no_residual(twin_case: Any, shift: float) -> None:
    problem = started_off(twin_case, shift)
    fit = problem.linearise()
    there = centred(problem.case, fit, problem.tightness)
    assert there is not None
    again = problem.at(*there).linearise()
    factors = np.array([own[-1] for own in again.initial])
    assert np.all(np.abs(factors) < 0.002)
    for old, new in zip(fit.runs, again.runs, strict=True):
        np.testing.assert_allclose(new.residual, old.residual, rtol=0, atol=1e-6 * np.abs(old.residual).max())
    gained = 0.5 * len(factors) * (shift / (0.008 * problem.tightness)) ** 2
    assert fit.cost - again.cost == pytest.approx(gained, rel=0.1)
    assert centred(problem.case, again, problem.tightness) is None


def test_friction_that_is_stated_in_a_run_stays(twin_case: Any) -> None:
    """Its factor cannot be undone there."""
    problem = started_off(twin_case, 0.1)
    k = problem.case.train[0]
    experiments = list(problem.case.experiments)
    experiments[k] = replace(experiments[k], conditions={"joint_coulomb": 0.05})
    stated = replace(problem.case, experiments=tuple(experiments))
    assert centred(stated, problem.linearise(), problem.tightness) is None


@pytest.mark.parametrize(("value", "factor"), [(1.0, 0.5), (1.0, -0.5), (-1.0, 0.5), (-1.0, -0.5)])
def test_friction_stays_within_its_bounds(value: float, factor: float) -> None:
    """Wherever the factors want it to go, on either side of zero."""
    bounds = (0.8, 1.2) if value > 0 else (-1.2, -0.8)
    free = Free(name="friction", index=0, log=value > 0, scale=1.0, start=0.0, lower=bounds[0], upper=bounds[1])
    shift, gain = _best_shift([free], {"friction": value}, np.full(4, factor), 0.008)
    assert shift == pytest.approx(np.log(1.2 if factor > 0 else 0.8), abs=1e-4)
    assert gain > 0.0

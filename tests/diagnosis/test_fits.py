"""What a fit is worth: leaving out by one Newton step against fitting again, run-to-run factors."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.diagnosis.answer import notes
from tendonlab.diagnosis.search.select import Search
from tendonlab.fitting import noise
from tendonlab.fitting.fitted import Fitter


@pytest.mark.cpu(10)
def test_leaving_out_by_a_newton_step_is_near_a_fit_without_it(fitter: Fitter, twin_case: Any) -> None:
    full = fitter.fit(twin_case.system)
    others = [i for k, i in enumerate(twin_case.train) if k != 2]
    initial = [s for k, s in enumerate(full.initial) if k != 2]
    again = replace(fitter, case=twin_case.training_on(others)).fit(full.system, initial=initial)
    step = full.without(2)
    moved = max(abs(again.system.parameters[f.name] / full.system.parameters[f.name] - 1) for f in full.free)
    assert moved > 1e-3
    for f in full.free:
        sd = f.slope(0.0) * np.sqrt(full.covariance[full.free.index(f), full.free.index(f)])
        assert step.parameters[f.name] == pytest.approx(again.system.parameters[f.name], abs=0.5 * abs(sd))


def test_what_the_experiments_state_themselves_is_not_informed(fitter: Fitter, twin_case: Any) -> None:
    """Of gravity, which every experiment knows, no residual says anything; nor is it proposed to be anything else."""
    known = tuple(replace(e, conditions={**e.conditions, "gravity_torque": 1.0}) for e in twin_case.experiments)
    case = replace(twin_case, experiments=known)
    fitted = replace(fitter, case=case).fit(case.system, max_iterations=3)
    assert fitted.not_informed == ("gravity_torque",)
    assert fitted.system.parameters["gravity_torque"] == pytest.approx(case.system.parameters["gravity_torque"])
    search = Search(fitter, tuned=fitted, steps=(), rounds=())
    warning = "not informed by these data and held at the nominal value: gravity_torque"
    assert warning in notes.warnings(case, fitter.floor, search)
    rows = notes.details(case, fitter.floor, fitted, search)["parameters"]
    assert [name for name, row in rows.items() if not row["informed"]] == ["gravity_torque"]


def test_factors_from_run_to_run_are_found(twin_case: Any) -> None:
    """One experiment whose joint friction is 10 % larger, simulated and fitted: its factor takes it up."""
    case = replace(twin_case, scatter=tuple((tuple(g), 0.05) for g in noise.friction_groups(twin_case.system)))
    i = case.train[0]
    own = [*case.prepared[i].initial_mean, 0.0, np.log(1.1)]
    values, active = case.at(i, case.system, own)
    core = noise.started(case, i, own)
    outputs = _core.simulate(case.system.kind, values, active, core, [], case.settings)["outputs"]
    ready = replace(case.prepared[i], measured=outputs)
    case = replace(case, prepared=(*case.prepared[:i], ready, *case.prepared[i + 1 :])).training_on([i])
    floor = noise.white(case)
    found = Fitter(case, noise.whitenings(case, floor), floor, _core.Cancel()).fit(case.system, known=True)
    motor, joint = found.initial[0][-2:]
    assert joint == pytest.approx(np.log(1.1), rel=0.02)
    assert motor == pytest.approx(0.0, abs=0.005)

"""What a fit is worth: leaving out by one Newton step against fitting again, run-to-run factors, one interval."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.fitting.floor import friction_groups
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import Fitter, initial_state, pose


@pytest.fixture(scope="module")
def fitter(twin_case: Any) -> Fitter:
    floor = white(twin_case.noise)
    floor = replace(floor, sd=[20 * s for s in floor.sd])  # loose enough for the model to be about right
    return Fitter(twin_case, floor, _core.Cancel())


@pytest.mark.cpu(15)
def test_leaving_out_by_a_newton_step_is_near_a_fit_without_it(fitter: Fitter, twin_case: Any) -> None:
    full = fitter.fit(twin_case.system)
    others = [i for k, i in enumerate(twin_case.train) if k != 2]
    initial = [s for k, s in enumerate(full.initial) if k != 2]
    fewer = replace(fitter, case=twin_case.training_on(others)).fit(full.system, initial=initial)
    step = full.leaving_out(2)
    moved = max(abs(fewer.system.parameters[f.name] / full.system.parameters[f.name] - 1) for f in full.free)
    assert moved > 1e-3
    for f, sd in zip(full.free, full.uncertainty.sd, strict=True):
        assert step.parameters[f.name] == pytest.approx(fewer.system.parameters[f.name], abs=0.5 * sd)


@pytest.mark.cpu(15)
def test_a_left_out_block_is_predicted_with_the_uncertainty_of_the_others(fitter: Fitter, twin_case: Any) -> None:
    """A normal density about the step's prediction, its covariance 1 + J C J', where C is that without the block."""
    fit = replace(fitter, case=twin_case.training_on(twin_case.train[:2])).fit(twin_case.system, max_iterations=5)
    b = max(range(len(fit.blocks)), key=lambda k: fit.scores[k] - fit.left_out[k])
    block = fit.blocks[b]
    others = fit.precision - block.jacobian.T @ block.jacobian
    step = np.linalg.solve(others, block.jacobian.T @ block.residual)
    predicted = block.residual + block.jacobian @ step
    covariance = np.eye(len(predicted)) + block.jacobian @ np.linalg.solve(others, block.jacobian.T)
    plain = fit.scores[b] + 0.5 * block.residual @ block.residual
    _, volume = np.linalg.slogdet(covariance)
    density = plain - 0.5 * (predicted @ np.linalg.solve(covariance, predicted) + volume)
    assert volume > 1.0
    assert fit.left_out[b] == pytest.approx(density, rel=1e-5)


@pytest.mark.parametrize("slope", [1e20, 1e200])  # whose square is a number, or none
def test_a_fit_whose_derivatives_exploded_has_no_evidence(slope: float, fitter: Fitter, twin_case: Any) -> None:
    fit = replace(fitter, case=twin_case.training_on(twin_case.train[:1])).fit(twin_case.system, max_iterations=1)
    (run,) = fit.runs
    away = replace(fit, runs=(replace(run, jacobian=slope * np.ones_like(run.jacobian)),))
    assert away.exploded
    assert away.evidence == -np.inf
    assert np.all(away.left_out == -np.inf)


def test_what_the_experiments_state_themselves_is_not_informed(fitter: Fitter, twin_case: Any) -> None:
    """Of gravity, which every experiment knows, no residual says anything."""
    known = tuple(replace(e, conditions={**e.conditions, "gravity_torque": 1.0}) for e in twin_case.experiments)
    case = replace(twin_case, experiments=known).training_on(twin_case.train[:2])
    fit = replace(fitter, case=case).fit(case.system, max_iterations=3)
    assert fit.not_informed == ("gravity_torque",)
    assert fit.system.parameters["gravity_torque"] == pytest.approx(case.system.parameters["gravity_torque"])


def test_factors_from_run_to_run_are_found(twin_case: Any) -> None:
    """One experiment whose joint friction is 10 % larger, simulated and fitted: its factor takes it up."""
    case = replace(twin_case, scatter=tuple((tuple(g), 0.05) for g in friction_groups(twin_case.system)))
    i = case.train[0]
    own = [*case.prepared[i].initial_mean, 0.0, np.log(1.1)]
    case = _measured(case, i, case.run(i, case.system, own)["outputs"]).training_on([i])
    fit = Fitter(case, white(case.noise), _core.Cancel()).fit(case.system, known=True)
    motor, joint = fit.initial[0][-2:]
    assert joint == pytest.approx(np.log(1.1), rel=0.02)
    assert motor == pytest.approx(0.0, abs=0.005)


def test_an_added_effect_scales_with_the_friction_of_its_element(twin_case: Any) -> None:
    """One experiment whose joint friction, Stribeck excess included, is 10 % larger: one factor takes all of it up."""
    groups = friction_groups(twin_case.system, with_added=True)
    case = replace(twin_case, scatter=tuple((tuple(group), 0.05) for group in groups))
    system = case.system.with_effects({"joint:stribeck": {"joint_static_excess": 0.2, "joint_stribeck_velocity": 0.1}})
    own = ("joint_coulomb", "joint_viscous", "joint_static_excess")
    larger = system.with_parameters({name: 1.1 * system.parameters[name] for name in own})
    i = case.train[0]
    case = _measured(case, i, case.run(i, larger)["outputs"]).training_on([i])
    fit = Fitter(case, white(case.noise), _core.Cancel()).fit(system, known=True)
    motor, joint = fit.initial[0][-2:]
    assert joint == pytest.approx(np.log(1.1), rel=0.02)
    assert motor == pytest.approx(0.0, abs=0.005)
    assert fit.whitened_square < 0.01


def test_the_initial_state_is_found_in_the_first_fifth_of_a_second(twin_case: Any) -> None:
    """Noise of a later sample does not matter, and a start away from the prior's mean is found."""
    i = twin_case.train[0]
    own = twin_case.own_mean(i) + 0.5 * twin_case.own_sd(i)
    outputs = twin_case.run(i, twin_case.system, own)["outputs"]
    outputs[:, np.asarray(twin_case.prepared[i].core.time) > 0.5] += 1.0
    fitted = initial_state(_measured(twin_case, i, outputs), twin_case.system, i)
    assert fitted == pytest.approx(own, rel=1e-3, abs=1e-3 * float(np.min(twin_case.own_sd(i))))


@pytest.mark.cpu(15)
def test_identify_and_a_diagnosis_state_the_same_value_and_interval(twin_case: Any) -> None:
    """Of the same model, which lacks nothing, fitted to the same experiments under the same noise, from a start nearby:
    what a model lacks makes several optima."""
    effect = "joint:stribeck"
    table = tl.identify(twin_case.dataset, effects=[effect], progress=False).parameters
    found = {str(name): float(value) for name, value in table["value"].items()}
    excess = {name: found[name] for name in ("joint_static_excess", "joint_stribeck_velocity")}
    start = twin_case.system.with_effects({effect: excess}).with_parameters(
        {n: 1.05 * found[n] for n in ("joint_coulomb", "joint_inertia")}
    )
    fit = pose(twin_case, white(twin_case.noise), start, added=(effect,)).solve()
    assert [f.name for f in fit.free] == list(table.index)
    for name, row in table.iterrows():
        value, (low, high) = fit.value(str(name))
        assert value == pytest.approx(row["value"], abs=0.1 * row["sd"])
        assert high - low == pytest.approx(row["ci95_upper"] - row["ci95_lower"], rel=0.02)


def _measured(case: Any, i: int, outputs: np.ndarray) -> Any:
    """The case with these outputs measured in experiment i."""
    ready = replace(case.prepared[i], measured=outputs)
    return replace(case, prepared=(*case.prepared[:i], ready, *case.prepared[i + 1 :]))

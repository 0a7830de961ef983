"""The fit on simulated rigs whose parameters are known."""

import subprocess
import sys
import threading
import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

from tendonlab import _core
from tendonlab.errors import NumericalError, ParameterError

FRICTION = ("motor_coulomb", "joint_coulomb", "joint_viscous", "cable_stiffness", "joint_inertia")
TRUE = {
    "motor_coulomb": 0.06,
    "joint_coulomb": 0.33,
    "joint_viscous": 0.25,
    "cable_stiffness": 95.0,
    "joint_inertia": 0.33,
}


def sd_of_values(found: dict[str, Any], free: list[Any]) -> np.ndarray:
    """Standard deviations of the fitted values where the model is right: s of the whitened noise is 1."""
    jacobian = np.vstack(found["jacobian"])
    sd = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    return sd * np.array([f.slope(x) for f, x in zip(free, found["x"], strict=True)])


@pytest.mark.parametrize(
    ("name", "true"),
    [("joint", {"inertia": 0.6, "gravity_torque": 1.2, "coulomb": 0.25, "viscous": 0.5}), ("drive", TRUE)],
)
def test_parameters_of_noisy_runs_are_found(request: Any, name: str, true: dict[str, float]) -> None:
    rig = request.getfixturevalue(name)
    free = rig.free(*true)
    found = rig.fit(rig.tasks(**true), free)
    assert found["converged"], found["message"]
    errors = np.array([found["values"][rig.index(n)] - v for n, v in true.items()])
    assert np.all(np.abs(errors) < 4 * sd_of_values(found, free))
    rows = sum(len(r) for r in found["residuals"])
    assert 2 * found["cost"] == pytest.approx(rows, abs=5 * np.sqrt(2 * rows))  # chi-squared


def test_the_gradient_of_the_cost_vanishes_at_the_optimum(drive: Any) -> None:
    """At 1e-7 runs move the cost by hundredths from step to step, which hides a tenth of a sigma; at 1e-10 not."""
    drive = replace(drive, settings=_core.Settings(tolerance=1e-10))
    found = drive.fit(drive.tasks(**TRUE), drive.free(*FRICTION), tolerance=1e-12)
    gradient = sum(j.T @ r for j, r in zip(found["jacobian"], found["residuals"], strict=True))
    norm = np.linalg.norm(np.vstack(found["jacobian"]), axis=0)
    assert np.all(np.abs(gradient) < 0.1 * norm)  # a tenth of a standard deviation of each parameter


def test_a_fit_of_parameters_that_do_the_same_ends_where_least_squares_does(joint: Any) -> None:
    """The command's scale and both others' are known to 10 %: torque, inertia, gravity and friction have one scale in
    common, which only the priors fix."""
    names = ("inertia", "gravity_torque", "torque_constant", "coulomb", "viscous")
    tasks = joint.tasks(inertia=0.6, gravity_torque=1.2, coulomb=0.25, viscous=0.5)
    free = [f for n in names for f in joint.free(n, mean=0.0, sd=0.1)]
    found = joint.fit(tasks, free, tolerance=1e-14)

    def at(x: np.ndarray) -> dict[str, Any]:
        return joint.linearise(tasks, [f.started(f.value(v)) for f, v in zip(free, x, strict=True)])

    def residual(x: np.ndarray) -> np.ndarray:
        return np.concatenate([*at(x)["residuals"], x / 0.1])

    def jacobian(x: np.ndarray) -> np.ndarray:
        return np.vstack([*at(x)["jacobian"], np.eye(len(x)) / 0.1])

    whole = np.vstack(found["jacobian"])
    assert np.linalg.svd(whole / np.linalg.norm(whole, axis=0), compute_uv=False)[-1] < 1e-6
    best = least_squares(residual, np.zeros(len(names)), jacobian, xtol=1e-14, ftol=1e-14)
    assert found["cost"] == pytest.approx(best.cost, rel=1e-6)
    np.testing.assert_allclose(found["x"], best.x, atol=1e-3)


def test_bounds_hold_and_are_told(joint: Any) -> None:
    tasks = joint.tasks(coulomb=0.5)
    found = joint.fit(tasks, [*joint.free("coulomb", upper=0.4), *joint.free("viscous")])
    assert found["at_bound"] == [True, False]
    assert found["values"][joint.index("coulomb")] == pytest.approx(0.4, rel=1e-12)


@pytest.mark.parametrize("bound", [0.4, 0.3])
def test_along_a_bound_the_others_are_fitted_to_the_end(joint: Any, bound: float) -> None:
    """At a bound of 0.3 the fit starts. Either way it ends where it ends with that value known."""
    tasks = joint.tasks(inertia=0.6, gravity_torque=1.2, coulomb=0.6, viscous=0.5)
    others = joint.free("inertia", "gravity_torque", "viscous")
    found = joint.fit(tasks, [*joint.free("coulomb", upper=bound), *others])
    joint = replace(joint, system=joint.system.with_parameters({"coulomb": bound}))
    known = joint.fit(tasks, others)
    assert found["converged"], found["message"]
    assert found["at_bound"] == [True, False, False, False]
    assert found["cost"] == pytest.approx(known["cost"], abs=0.1)
    np.testing.assert_allclose(found["x"][1:], known["x"], atol=1e-3)


def test_a_fit_too_slow_for_its_goal_ends_early(joint: Any) -> None:
    """No inertia makes up for friction: no cost near 0 is in reach. One that is changes nothing."""
    tasks, free = joint.tasks(coulomb=0.5), joint.free("inertia")
    whole = joint.fit(tasks, free, tolerance=1e-14)
    early = joint.fit(tasks, free, tolerance=1e-14, goal=0.0, goal_within=50)
    assert early["iterations"] < whole["iterations"]
    assert not early["converged"]
    assert "the cost was still falling" in early["message"]
    reached = joint.fit(tasks, free, tolerance=1e-14, goal=1.01 * whole["cost"], goal_within=50)
    assert reached["x"] == whole["x"]


def test_a_fit_that_misses_its_goal_in_time_ends_there(joint: Any) -> None:
    tasks, free = joint.tasks(coulomb=0.5), joint.free("inertia")
    whole = joint.fit(tasks, free, tolerance=1e-14)
    late = joint.fit(tasks, free, tolerance=1e-14, goal=1.000001 * whole["cost"], goal_within=1)
    assert late["iterations"] == 1
    assert late["cost"] > 1.000001 * whole["cost"]


def test_a_start_at_a_bound_that_the_data_leave_is_left(joint: Any) -> None:
    tasks = joint.tasks(coulomb=0.25, viscous=0.5)
    free = [*joint.free("coulomb", upper=0.3), *joint.free("viscous", lower=0.4)]
    found = joint.fit(tasks, free)
    assert found["converged"], found["message"]
    assert found["at_bound"] == [False, False]
    assert found["values"][joint.index("coulomb")] == pytest.approx(0.25, rel=0.05)
    assert found["values"][joint.index("viscous")] == pytest.approx(0.5, rel=0.05)


def test_a_prior_weighs_against_the_data_as_its_sd_says(joint: Any) -> None:
    """One parameter near its optimum: the posterior mean is the weighted mean of prior and data."""
    tasks = joint.tasks(viscous=0.42)
    free = joint.free("viscous", log=False, scale=1.0)
    alone = joint.fit(tasks, free)
    sd = sd_of_values(alone, free)[0]
    prior = alone["x"][0] + 2 * sd
    found = joint.fit(tasks, joint.free("viscous", log=False, scale=1.0, mean=prior, sd=sd))
    assert found["x"][0] == pytest.approx(alone["x"][0] + sd, abs=0.02 * sd)
    assert found["prior_cost"] == pytest.approx(0.5, rel=0.05)


def test_conditions_and_additions_act_where_they_are_stated(joint: Any) -> None:
    """The first run has a known coulomb of 0.1, the second a load of 0.2 kg m^2 added to the unknown inertia."""
    coulomb, inertia = joint.index("coulomb"), joint.index("inertia")
    first = joint.simulate(0, coulomb=0.1, inertia=0.55)["outputs"]
    second = joint.simulate(1, coulomb=0.35, inertia=0.75)["outputs"]
    tasks = [
        _core.Task(joint.experiment(0), joint.whitening(first), fixed={coulomb: 0.1}),
        _core.Task(joint.experiment(1), joint.whitening(second), added={inertia: 0.2}),
    ]
    found = joint.fit(tasks, joint.free("coulomb", "inertia"), tolerance=1e-12)
    assert found["values"][coulomb] == pytest.approx(0.35, rel=1e-5)
    assert found["values"][inertia] == pytest.approx(0.55, rel=1e-5)


def test_initial_states_are_nuisances(joint: Any) -> None:
    tasks = []
    for e, angle in enumerate((0.03, -0.02)):
        outputs = joint.simulate(e, position=[angle], viscous=0.45)["outputs"]
        task = _core.Task(joint.experiment(e), joint.whitening(outputs), initial=[("position", 0)], initial_sd=[0.5])
        tasks.append(task)
    found = joint.fit(tasks, joint.free("viscous", "coulomb"), tolerance=1e-12)
    np.testing.assert_allclose(
        np.ravel(found["initial"]), [0.03, -0.02], atol=1e-5
    )  # the prior pulls by 1e-5 of its sd
    assert found["values"][joint.index("viscous")] == pytest.approx(0.45, rel=1e-4)
    assert [j.shape[1] for j in found["jacobian_initial"]] == [1, 1]


def test_an_unmeasured_output_is_left_out(drive: Any) -> None:
    rig = type(drive)(**{**vars(drive), "unmeasured": ("joint_angle", "cable_torque")})
    found = rig.fit(rig.tasks(**TRUE), rig.free("motor_coulomb"))
    assert {len(r) for r in found["residuals"]} == {500}


def test_cancelled_fit_returns_at_once_and_says_so(drive: Any) -> None:
    cancel = _core.Cancel()
    cancel.set()
    start = drive.free(*FRICTION)
    found = drive.fit(drive.tasks(**TRUE), start, cancel=cancel)
    assert (found["converged"], found["message"]) == (False, "cancelled")
    np.testing.assert_allclose(found["x"], [f.coordinate(f.start) for f in start])


def test_cancel_from_another_thread_stops_a_running_fit(drive: Any) -> None:
    cancel = _core.Cancel()
    tasks = drive.tasks(**TRUE) * 40
    found: dict[str, Any] = {}
    fit = threading.Thread(
        target=lambda: found.update(drive.fit(tasks, drive.free(*FRICTION), tolerance=1e-15, cancel=cancel))
    )
    fit.start()
    time.sleep(0.3)
    cancel.set()
    fit.join(timeout=20)
    assert not fit.is_alive()
    assert found["message"] == "cancelled"


def test_a_fit_out_of_iterations_says_so(drive: Any) -> None:
    found = drive.fit(drive.tasks(**TRUE), drive.free(*FRICTION), max_iterations=1)
    assert not found["converged"]
    assert found["message"] == "stopped after 1 iterations while the cost was still falling"


def test_same_input_same_bits(drive: Any) -> None:
    first, second = (drive.fit(drive.tasks(**TRUE), drive.free(*FRICTION)) for _ in range(2))
    assert first["x"] == second["x"]
    assert all(np.array_equal(a, b) for a, b in zip(first["jacobian"], second["jacobian"], strict=True))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"start": 0.5, "upper": 0.4}, r"start of coulomb = 0.5: expected a value in"),
        ({"scale": 0.0}, "scale of coulomb = 0"),
        ({"sd": 0.0}, "prior sd of coulomb = 0"),
        ({"lower": 1.0, "upper": 1.0}, "expected lower < upper"),
        ({"index": 1000}, "free index = 1000"),
    ],
)
def test_what_cannot_be_fitted_is_told(joint: Any, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        joint.fit(joint.tasks(), joint.free("coulomb", **changes))


def test_a_failing_start_raises_what_the_simulation_says(joint: Any) -> None:
    impatient = type(joint)(**{**vars(joint), "settings": _core.Settings(max_attempts=3)})
    with pytest.raises(NumericalError, match="after 3 step attempts"):
        impatient.fit(joint.tasks(), joint.free("coulomb"))


def test_a_fit_writes_nothing() -> None:
    """Neither a good fit nor one whose trial steps fail: Ceres has a log of its own."""
    script = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "import conftest\n"
        "from tendonlab import _core\n"
        "joint = conftest.make_joint()\n"
        "tasks = joint.tasks(coulomb=0.5)\n"
        "joint.fit(tasks, joint.free('coulomb', 'viscous'))\n"
        "steps = joint.simulate(0)['attempts'] + 3\n"
        "impatient = type(joint)(**{**vars(joint), 'settings': _core.Settings(tolerance=1e-7, max_attempts=steps)})\n"
        "impatient.fit(tasks[:1], joint.free('coulomb', 'viscous'))\n"
    )
    folder = __file__.rpartition("/")[0]
    done = subprocess.run(
        [sys.executable, "-c", script, folder], capture_output=True, text=True, timeout=120, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")

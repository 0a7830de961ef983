"""`identify` on datasets that the library simulates itself, so that the truth is known."""

import copy
import json
import pickle
import signal
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tendonlab._core import Free
from tendonlab.cli.text import identification_text
from tendonlab.data import Dataset, Experiment, NominalParameter, SignalSpec
from tendonlab.errors import DatasetError, NumericalError, ParameterError
from tendonlab.fitting.priors import LOG_SD
from tendonlab.fitting.problem import Problem
from tendonlab.identification import identify as output_error
from tendonlab.identification.identify import identify
from tendonlab.identification.samples import samples
from tendonlab.simulation.system import System

TRUE = {"inertia": 0.55, "gravity_torque": 1.1, "coulomb": 0.26, "viscous": 0.48, "torque_constant": 1.0}
NOMINAL = {"inertia": 0.5, "gravity_torque": 1.0, "coulomb": 0.3, "viscous": 0.4}
EFFECTS = ("joint:coulomb", "joint:viscous")
TIME = np.arange(0.0, 3.0, 0.005)
NOISE = 2e-3


def measure(name: str, k: int, *, seed: int, changes: dict[str, float] | None = None, **about: Any) -> Experiment:
    """One run of the true rig, its angle measured with noise."""
    system = System(kind="rigid_joint", parameters={**TRUE, **(changes or {})}, effects=EFFECTS)
    torque = (1.5 + 0.3 * k) * np.sin(2 * np.pi * (0.6 + 0.17 * k) * TIME) * np.sin(0.9 * TIME + 0.3 * k)
    frame = pd.DataFrame({"motor_torque": torque}, index=pd.Index(TIME, name="t"))
    angle = system.simulate(frame, tolerance=1e-8)["joint_angle"].to_numpy()
    frame["joint_angle"] = angle + NOISE * np.random.default_rng([seed, k]).normal(size=len(TIME))
    return Experiment(name=name, data=frame, initial={"joint_angle": 0.0, "joint_velocity": 0.0}, **about)


def rig(*experiments: Experiment, seed: int = 1, **nominal: NominalParameter) -> Dataset:
    """A dataset of these experiments, or of four plain ones."""
    runs = experiments or tuple(measure(f"run-{k}", k, seed=seed) for k in range(4))
    parameters = {name: NominalParameter(value) for name, value in NOMINAL.items()}
    parameters["torque_constant"] = NominalParameter(1.0, 0.0)
    signals = {
        "motor_torque": SignalSpec("motor_torque", "u", "N*m", "input", True),
        "joint_angle": SignalSpec("joint_angle", "q", "rad", "output", False, noise_sd=NOISE),
    }
    return Dataset(
        name="joint", description="", kind="rigid_joint", axis="rotary", nominal_effects=EFFECTS,
        parameters={**parameters, **nominal}, controller=None, signals=signals, experiments=runs, path=Path(),
    )  # fmt: skip


def test_of_runs_whose_initial_state_is_known_or_not_each_may_be_among_the_others() -> None:
    """Fits of initial states alone, which come first, have nothing to fit in a run that states its own."""
    known, *others = rig().experiments
    found = identify(rig(known, *(replace(e, initial={}) for e in others)), progress=False)
    assert found.converged, found.message
    for name, value in found.values.items():
        assert abs(value - TRUE[name]) < 4 * found.parameters["sd"][name]


@pytest.fixture(scope="module")
def fit() -> Any:
    return identify(rig(), progress=False)


def test_the_truth_is_within_a_few_standard_deviations(fit: Any) -> None:
    assert fit.converged, fit.message
    assert set(fit.values) == set(NOMINAL)
    for name, value in fit.values.items():
        assert abs(value - TRUE[name]) < 4 * fit.parameters["sd"][name]
        low, high = fit.ci95(name)
        assert low < value < high
    assert fit.system.parameters["coulomb"] == fit.values["coulomb"]
    rms = np.sqrt(np.mean(np.concatenate([frame["joint_angle"] for frame in fit.residuals.values()]) ** 2))
    assert rms == pytest.approx(1.0, abs=0.06)  # four standard errors of 2400 residuals


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    """Four parameters of eight measurements: 95 % intervals miss more than five of the 32 once in 200 times."""
    missed = 0
    for seed in range(8):
        found = identify(rig(seed=100 + seed), progress=False)
        missed += sum(not low <= TRUE[n] <= high for n in NOMINAL for low, high in [found.ci95(n)])
    assert missed <= 5


def test_model_error_widens_the_intervals(fit: Any) -> None:
    """Coulomb friction that differs between runs: the sd sees it, that of independent noise would not."""
    runs = [measure(f"run-{k}", k, seed=1, changes={"coulomb": 0.26 * s}) for k, s in enumerate((0.7, 0.9, 1.1, 1.3))]
    found = identify(rig(*runs), progress=False)
    assert found.parameters["sd"]["coulomb"] > 5 * fit.parameters["sd"]["coulomb"]
    assert abs(found.values["coulomb"] - 0.26) < 0.05


def test_parameters_known_exactly_stay(fit: Any) -> None:
    found = identify(rig(inertia=NominalParameter(0.55, 0.0)), progress=False)
    assert "inertia" not in found.values
    assert found.parameters["sd"]["gravity_torque"] < fit.parameters["sd"]["gravity_torque"]


def test_a_stated_prior_holds_against_weak_data() -> None:
    found = identify(rig(viscous=NominalParameter(0.4, 1e-4)), progress=False)
    assert found.values["viscous"] == pytest.approx(0.4, rel=0.01)


def test_stated_bounds_are_kept_and_told() -> None:
    found = identify(rig(coulomb=NominalParameter(0.3, None, 0.28, 0.4)), progress=False)
    assert found.at_bound == ("coulomb",)
    assert found.values["coulomb"] == pytest.approx(0.28)
    assert found.converged, found.message
    held = identify(rig(coulomb=NominalParameter(0.28, 0.0)), progress=False)
    for name, value in held.values.items():
        assert found.values[name] == pytest.approx(value, abs=0.02 * held.parameters["sd"][name])
        assert found.parameters["sd"][name] == pytest.approx(held.parameters["sd"][name], rel=0.02)


def test_a_value_at_its_bound_is_as_uncertain_as_without_it(fit: Any) -> None:
    """Its interval ends at the bound, and its profile rises from there."""
    found = identify(rig(coulomb=NominalParameter(0.3, None, 0.28, 0.4)), progress=False)
    assert found.parameters["sd"]["coulomb"] > 0.5 * fit.parameters["sd"]["coulomb"]
    low, high = found.ci95("coulomb")
    assert low == pytest.approx(0.28)
    assert high > 0.28
    profile = found.profile("coulomb", num_points=5)
    assert len(profile) >= 3
    assert profile["value"].min() == pytest.approx(0.28)
    assert profile["cost"].iloc[0] == pytest.approx(0.0, abs=0.05)
    assert (np.diff(profile["cost"]) > 0).all()


def test_conditions_and_additions() -> None:
    runs = (
        measure("known-friction", 0, seed=2, changes={"coulomb": 0.1}, conditions={"coulomb": 0.1, "room": 21.0}),
        measure("load", 1, seed=2, changes={"inertia": 0.75}, add={"inertia": 0.2}),
        measure("plain", 2, seed=2),
    )
    found = identify(rig(*runs), progress=False)
    for name, value in found.values.items():
        assert abs(value - TRUE[name]) < 4 * found.parameters["sd"][name]


def test_an_added_effect_is_fitted_with_the_rest() -> None:
    found = identify(rig(), effects=["joint:asymmetry"], progress=False)
    assert "joint:asymmetry" in found.system.effects
    assert abs(found.values["joint_level_asymmetry"]) < 5 * found.parameters["sd"]["joint_level_asymmetry"]


def test_the_profile_is_a_parabola_where_the_model_is_right(fit: Any) -> None:
    profile = fit.profile("inertia", num_points=5, reach=2.0)
    information = 1 / np.linalg.inv(_information(fit))[0, 0]
    free = fit.problem.free[0]
    x = np.array([free.coordinate(v) for v in profile["value"]]) - free.coordinate(fit.values["inertia"])
    assert free.name == "inertia"
    np.testing.assert_allclose(profile["cost"], 0.5 * information * x**2, rtol=0.1, atol=0.02)
    sd = fit.parameters["sd"]["inertia"] / free.slope(free.coordinate(fit.values["inertia"]))
    np.testing.assert_allclose(x, sd * np.array([-2.0, -1.0, 0.0, 1.0, 2.0]), atol=1e-6 * sd)


def _information(fit: Any) -> np.ndarray:
    stacked = np.vstack([run.jacobian for run in fit.problem.solve().runs])
    return np.asarray(stacked.T @ stacked + np.diag([f.sd**-2.0 for f in fit.problem.free]))


def test_samples_have_the_spread_of_the_fit_and_keep_its_bounds(fit: Any) -> None:
    drawn = fit.samples(4000, seed=1)
    assert list(drawn.columns) == list(fit.values)
    assert drawn.equals(fit.samples(4000, seed=1))
    free = {f.name: f for f in fit.problem.free}
    for name, row in fit.parameters.iterrows():
        assert drawn[name].between(free[name].lower, free[name].upper).all()
        # the mean of 4000 strays by sd / 63, the sd by 1.1 %; logarithms bend both a little
        assert drawn[name].mean() == pytest.approx(row["value"], abs=0.1 * row["sd"])
        assert drawn[name].std() == pytest.approx(row["sd"], rel=0.1)
    coordinates = pd.DataFrame({name: [free[name].coordinate(v) for v in drawn[name]] for name in drawn})
    away = coordinates.corr() - fit.correlations.loc[list(drawn), list(drawn)]
    assert np.abs(away.to_numpy()).max() < 0.08  # five of their sd


def test_samples_hold_what_the_data_do_not_move(fit: Any) -> None:
    name = str(fit.parameters.index[0])
    table = fit.parameters.assign(at_bound=fit.parameters.index == name)
    drawn = replace(fit, parameters=table).samples(50)
    assert (drawn[name] == fit.values[name]).all()
    assert (drawn.drop(columns=name).std() > 0).all()
    with pytest.raises(ParameterError, match="num_points = 0: expected a whole number of at least 1"):
        fit.samples(0)


def test_samples_of_parameters_that_all_stay_are_their_values(fit: Any) -> None:
    drawn = replace(fit, parameters=fit.parameters.assign(at_bound=True)).samples(3)
    assert (drawn[list(fit.values)] == pd.Series(fit.values)).all(axis=None)


def test_samples_outside_the_bounds_are_drawn_anew() -> None:
    free = Free(name="coulomb", index=0, log=False, scale=0.5, start=0.1, lower=0.0, upper=0.3)
    wide = samples([free], np.array([0.1]), np.array([0.2]), np.eye(1), num=500, random=np.random.default_rng(0))
    assert ((wide >= 0.0) & (wide <= 0.3)).all()
    assert len(np.unique(wide)) == 500  # none is clipped to a bound
    with pytest.raises(NumericalError, match="samples: 0 of 2000 draws were within the bounds, 2 expected"):
        samples([free], np.array([-9.0]), np.array([0.2]), np.eye(1), num=2, random=np.random.default_rng(0))


def test_more_starts_agree_and_repeat(fit: Any) -> None:
    first, second = (identify(rig(), num_starts=3, seed=7, progress=False) for _ in range(2))
    assert first.values == second.values
    assert first.cost == pytest.approx(fit.cost, rel=1e-6)


def test_further_starts_scatter_as_the_priors_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """About the nominal values, by the standard deviation that is stated."""
    drawn: list[Problem] = []
    starts = output_error._starts

    def noted(problem: Problem, num_starts: int, rng: np.random.Generator) -> list[Problem]:
        drawn.extend(starts(problem, num_starts, rng))
        return drawn[:1]

    monkeypatch.setattr(output_error, "_starts", noted)
    identify(rig(gravity_torque=NominalParameter(1.0, 0.05)), num_starts=101, seed=1, progress=False)
    values = np.array([start.system.parameters["gravity_torque"] for start in drawn])
    assert len(values) == 101
    assert np.mean(values) == pytest.approx(1.0, abs=0.015)
    assert np.std(values) == pytest.approx(0.05, rel=0.2)


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Ctrl-C interrupts, also where tests run in the background of a shell, which ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
def test_interrupt_keeps_what_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C while fits run, each of which waits for it: none can end before, however fast or busy the machine is."""
    solve = Problem.solve

    def running(problem: Problem, *, cancel: Any, **options: Any) -> Any:
        ends = time.monotonic() + 60.0
        while not cancel.is_set() and time.monotonic() < ends:
            time.sleep(0.001)
        return solve(problem, cancel=cancel, **options)

    def interrupted(jobs: Any) -> Any:
        while not any(job.running() for job in jobs):
            time.sleep(0.001)
        signal.raise_signal(signal.SIGINT)
        return as_completed(jobs)

    monkeypatch.setattr(Problem, "solve", running)
    monkeypatch.setattr(output_error, "as_completed", interrupted)
    found = identify(rig(), num_starts=5, progress=False)
    assert not found.converged
    assert found.message == "cancelled"


def stated(*, seed: int = 4) -> tuple[Experiment, ...]:
    """Runs that state their gravity torque, so that none depends on the simulator's."""
    return tuple(measure(f"run-{k}", k, seed=seed, conditions={"gravity_torque": 1.1}) for k in range(4))


@pytest.mark.parametrize("num_starts", [1, 3])
@pytest.mark.parametrize("sd", [None, 0.25])
def test_what_no_sample_depends_on_is_held_and_told(num_starts: int, sd: float | None) -> None:
    found = identify(rig(*stated(), gravity_torque=NominalParameter(1.0, sd)), num_starts=num_starts, progress=False)
    row = found.parameters.loc["gravity_torque"]
    prior = LOG_SD if sd is None else sd
    assert found.not_informed == ("gravity_torque",)
    assert found.system.parameters["gravity_torque"] == row["value"] == 1.0
    assert row["sd"] == pytest.approx(prior)
    assert found.ci95("gravity_torque") == pytest.approx((1.0 - 1.96 * prior, 1.0 + 1.96 * prior), rel=1e-4)
    others = identify(rig(*stated(), gravity_torque=NominalParameter(1.0, 0.0)), progress=False)
    for name, value in others.values.items():
        assert found.values[name] == pytest.approx(value, rel=1e-4)
        assert found.parameters["sd"][name] == pytest.approx(others.parameters["sd"][name], rel=1e-3)


def test_what_is_not_informed_is_told_wherever_results_are_shown() -> None:
    found = identify(rig(*stated()), progress=False)
    told = "not informed by these data: gravity_torque"
    assert repr(found).endswith(f"; {told})")
    assert "gravity_torque = " not in repr(found)
    assert told in found._repr_html_()
    assert found.to_dict()["parameters"]["gravity_torque"]["informed"] is False
    assert found.to_dict()["parameters"]["inertia"]["informed"] is True
    assert "held: a small change has no effect" in identification_text(found)
    assert "Converged after 1 iteration;" in identification_text(replace(found, num_iterations=1))


def test_a_nominal_value_at_its_bound_that_nothing_informs_is_not_at_its_bound() -> None:
    found = identify(rig(*stated(), gravity_torque=NominalParameter(1.0, 0.25, 1.0, 2.0)), progress=False)
    assert found.at_bound == ()
    assert found.not_informed == ("gravity_torque",)
    assert found.parameters["sd"]["gravity_torque"] == pytest.approx(0.25)


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda fit: pickle.loads(pickle.dumps(fit))], ids=["copy", "pickle"])
def test_a_copy_of_a_result_is_the_same_and_works(fit: Any, copied: Any) -> None:
    other = copied(fit)
    assert other == fit
    assert replace(other, noise_sd={name: 2.0 * sd for name, sd in fit.noise_sd.items()}) != fit
    pd.testing.assert_frame_equal(other.parameters, fit.parameters)
    assert other.to_dict() == fit.to_dict()
    first, second = (one.profile("viscous", num_points=3) for one in (fit, other))
    np.testing.assert_array_equal(first.to_numpy(), second.to_numpy())  # the same bits


def test_everything_is_informed_where_it_is_seen(fit: Any) -> None:
    assert fit.not_informed == ()
    assert fit.parameters["informed"].all()


def test_results_come_as_plain_types_and_pictures(fit: Any) -> None:
    plain = json.loads(json.dumps(fit.to_dict(), allow_nan=False))
    assert plain["parameters"]["coulomb"]["unit"] == "N*m"
    assert plain["converged"] is True
    assert repr(fit).startswith("Identification(rigid_joint, converged; inertia = 0.5")
    assert "<table" in fit._repr_html_()
    axes = fit.plot(experiment="run-2")
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time (s)", "residual (noise sd)")


def test_fits_that_run_at_once_give_the_same_bits() -> None:
    """Unknown initial states are summed in the same order, wherever they lie in memory."""
    runs = [replace(run, initial={}) for run in (measure(f"run-{k}", k, seed=1) for k in range(8))]
    with ThreadPoolExecutor(4) as pool:
        found = pool.map(lambda _: tuple(identify(rig(*runs), progress=False).values.values()), range(8))
    assert len(set(found)) == 1


def test_an_experiment_that_did_not_measure_the_motor_is_named() -> None:
    runs = [measure(f"run-{k}", k, seed=1) for k in range(4)]
    blind = replace(runs[2], data=runs[2].data.assign(joint_angle=np.nan))
    with pytest.raises(DatasetError, match="run-2: joint_angle: fewer than 2 measured samples"):
        identify(rig(*runs[:2], blind, runs[3]), progress=False)


def test_records_of_a_few_samples_are_fitted_with_what_they_say() -> None:
    runs = [measure(f"run-{k}", k, seed=1) for k in range(4)]
    found = identify(rig(*(replace(run, data=run.data.iloc[:3]) for run in runs)), progress=False)
    assert (found.parameters["sd"] > 0).all()


def test_a_fit_says_how_near_it_came(fit: Any) -> None:
    """The noise is all that is left, of an angle that moves by much more."""
    error, spread, unit = fit.errors.loc["joint_angle"]
    seen = [e.data["joint_angle"] for e in rig()]
    assert error == pytest.approx(NOISE, rel=0.06)
    assert spread == pytest.approx(np.sqrt(np.mean(np.concatenate([y - y.mean() for y in seen]) ** 2)))
    assert unit == "rad"
    assert fit.missed == ()
    assert fit.to_dict()["errors"]["joint_angle"]["rms_error"] == error


def test_a_fit_that_explains_nothing_says_so_even_where_it_converged() -> None:
    """Friction that nothing overcomes: the joint stands still, and no small change of a value moves it."""
    stuck = {name: NominalParameter(value, 0.0) for name, value in NOMINAL.items()}
    stuck |= {"coulomb": NominalParameter(50.0, 0.0), "viscous": NominalParameter(0.4, 0.1)}
    found = identify(rig(**stuck), progress=False)
    assert found.converged
    assert found.missed == ("joint_angle",)
    assert "hardly better than a constant: joint_angle" in repr(found)
    assert "hardly better than a constant</b>: joint_angle" in found._repr_html_()
    assert "joint_angle is predicted hardly better than by a constant" in " ".join(identification_text(found).split())


def test_what_cannot_be_identified_is_told(fit: Any) -> None:
    with pytest.raises(ParameterError, match="joint:stribek"):
        identify(rig(), effects=["joint:stribek"], progress=False)
    with pytest.raises(DatasetError, match="no training experiment"):
        identify(rig(replace(measure("a", 0, seed=1), split="test")), progress=False)
    with pytest.raises(DatasetError, match="no experiment 'nine'"):
        identify(rig(), experiments=["nine"], progress=False)
    with pytest.raises(ParameterError, match="num_starts = 0: expected at least 1"):
        identify(rig(), num_starts=0, progress=False)
    for given, told in (
        ({"num_starts": 1.5}, "num_starts = 1.5: expected at least 1"),
        ({"effects": "joint:stribeck"}, r"effects = 'joint:stribeck': expected a list, such as \['joint:stribeck'\]"),
        ({"experiments": "run-1"}, "experiments = 'run-1': expected a list"),
        ({"experiments": ["run-1", "run-2", "run-1"]}, "experiments: duplicate 'run-1'"),
    ):
        with pytest.raises(ParameterError, match=told):
            identify(rig(), progress=False, **given)  # type: ignore[arg-type]
    with pytest.raises(ParameterError, match="dataset = 'rig-42': expected a Dataset"):
        identify("rig-42", progress=False)  # type: ignore[arg-type]
    for given, told in (({"num_points": 1}, "num_points = 1"), ({"reach": 0.0}, "reach = 0.0: expected a positive")):
        with pytest.raises(ParameterError, match=told):
            fit.profile("inertia", **given)
    with pytest.raises(ParameterError, match="'torque_constant' was not fitted"):
        fit.ci95("torque_constant")

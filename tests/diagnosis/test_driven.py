"""Inputs that are proposed where nothing holds a position: within what the logs show, and worth their time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from diagnosis.bowden_bench import bench
from tendonlab.diagnosis.answer.driven import Driven, drives
from tendonlab.diagnosis.answer.motions import RATE, instants
from tendonlab.diagnosis.answer.next_experiments import _gain, _separation, advise
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter


@pytest.fixture(scope="module")
def fitter(tmp_path_factory: pytest.TempPathFactory) -> Fitter:
    return bench(tmp_path_factory.mktemp("bench"))


def as_logged(fitter: Fitter) -> Driven:
    """The inputs of the first training experiment again."""
    log = fitter.case.experiments[fitter.case.train[0]]
    inputs = {n: np.interp(instants(), log.time, log.data[n]) for n in ("input_torque", "input_velocity")}
    return Driven("as logged", inputs, fitter.case.train[0])


def steepest(values: np.ndarray, rate: float) -> float:
    return float(np.max(np.abs(np.diff(values)))) * rate


def test_inputs_stay_within_the_range_and_the_rate_of_change_of_the_logs(fitter: Fitter) -> None:
    runs = [e.data for e in fitter.case.experiments]
    planned = drives(fitter.case, rests=True)
    assert len({plan.words for plan in planned}) == len(planned) > 5
    for plan in planned:
        for name, values in plan.inputs.items():
            seen = [run[name].to_numpy() for run in runs]
            low, high = min(map(np.min, seen)), max(map(np.max, seen))
            spare = 0.01 * (high - low)
            assert low - spare <= values.min() <= values.max() <= high + spare, (plan.words, name)
            assert steepest(values, RATE / plan.slower) <= 1.1 * max(steepest(run, 50.0) for run in seen), (
                plan.words,
                name,
            )


def test_every_plan_moves_as_its_words_say(fitter: Fitter) -> None:
    """What a plan is said to sweep is swept: no input is slowed until next to nothing of its path is left."""
    for plan in drives(fitter.case):
        way = np.ptp(np.cumsum(plan.inputs["input_velocity"])) * plan.slower / RATE
        span = float(plan.words.split("±")[1].split(" ")[0])
        assert way > 0.6 * span, plan.words
        torques = np.concatenate([e.data["input_torque"] for e in fitter.case.experiments])
        swept = np.ptp(plan.inputs["input_torque"]) > 0.5 * np.ptp(torques)
        assert swept == (" while the " in plan.words), plan.words


def with_torque(fitter: Fitter, torque: Callable[[np.ndarray, int], np.ndarray]) -> Case:
    """The bench with other torques in its logs."""
    runs = tuple(
        replace(e, data=e.data.assign(input_torque=torque(e.time, k))) for k, e in enumerate(fitter.case.experiments)
    )
    return replace(fitter.case, experiments=runs)


def test_a_weight_that_hangs_all_run_is_held(fitter: Fitter) -> None:
    """No log shows how fast such an input may change."""
    case = with_torque(fitter, lambda time, k: np.full(len(time), 1.0 + k))
    planned = drives(case)
    assert planned
    assert all(np.ptp(plan.inputs["input_torque"]) == 0.0 for plan in planned)
    assert not any(" while the " in plan.words for plan in planned)


def test_each_begins_where_the_first_log_begins_and_ends_no_further_than_the_logs(fitter: Fitter) -> None:
    first = fitter.case.experiments[fitter.case.train[0]].data
    gone = [np.cumsum(e.data["input_velocity"].to_numpy()) * 0.02 for e in fitter.case.experiments]
    for plan in drives(fitter.case):
        assert plan.inputs["input_torque"][0] == pytest.approx(first["input_torque"].iloc[0], abs=1e-6)
        assert plan.inputs["input_velocity"][0] == 0.0  # the least velocity has a sense, and friction with it
        way = np.cumsum(plan.inputs["input_velocity"]) * plan.slower / RATE
        assert min(map(np.min, gone)) - 0.03 <= way.min() <= way.max() <= max(map(np.max, gone)) + 0.03, plan.words


def test_the_reference_reads_back_in_the_units_of_the_logs_and_simulates(fitter: Fitter, tmp_path: Path) -> None:
    case = fitter.case
    plan = next(p for p in drives(case) if "follows the motion" in p.words)
    plan.reference(case).to_csv(tmp_path / "next-1.csv", index=False, float_format="%.9g")
    read = pd.read_csv(tmp_path / "next-1.csv")
    assert list(read.columns) == ["t", "u", "w (deg/s)"]
    inputs = {"input_torque": read["u"].to_numpy(), "input_velocity": np.radians(read["w (deg/s)"].to_numpy())}
    again = case.system.simulate(pd.DataFrame(inputs, index=read["t"])).outputs["output_torque"]
    log = plan.played(case, case.system).log
    late = log.time > 1.0  # the two begin at another reading
    expected = log.data["output_torque"].to_numpy()[late]
    off = np.interp(log.time[late], read["t"], again.to_numpy()) - expected
    assert np.sqrt(np.mean(off**2)) < 0.02 * np.ptp(expected)  # a reversal lies between samples of the log


def explained_by(fitter: Fitter, effect: str, parameter: str, value: float) -> Fitted:
    system = fitter.case.system.with_effects({effect: {parameter: value}})
    return fitter.fit(system, added=(effect,), solve=False)


def test_advised_inputs_separate_a_tie_better_than_the_first_experiment_again(fitter: Fitter) -> None:
    """Friction that grows with the load, and a drive that gives less than it says, both take a share of the torque: the
    first experiment carries too little to tell."""
    loaded = explained_by(fitter, "sheath:load_dependence", "load_dependence", 0.02)
    weak = explained_by(fitter, "actuation:gain_error", "gain_error", -0.02)
    found = advise(fitter.case, fitter.case.replay, fitter.floor, loaded, weak)
    again = _separation(fitter.case, fitter.floor, loaded, weak, as_logged(fitter))
    assert "input torque" in found[0]["description"]
    assert found[0]["separates"] == ["actuation:gain_error", "sheath:load_dependence"]
    assert found[0]["expected_gain"] > 10.0 * again > 0.0
    assert [row["expected_gain"] for row in found] == sorted((row["expected_gain"] for row in found), reverse=True)


def test_no_log_speaks_against_the_model_that_made_it(fitter: Fitter) -> None:
    """Its first sample may be far from what the model makes again: at rest friction may point either way."""
    own = explained_by(fitter, "sheath:load_dependence", "load_dependence", 0.02)
    log = as_logged(fitter).played(fitter.case, own.system).log
    log.data.loc[log.data.index[0], "output_torque"] += 5.0
    assert _gain(fitter.case, fitter.floor, own, own, log) == pytest.approx(0.0, abs=1e-9)


def test_inputs_that_lead_an_output_out_of_its_range_are_not_proposed(fitter: Fitter) -> None:
    far = as_logged(fitter)
    with pytest.raises(NumericalError, match="output_torque would leave the range that the logs show"):
        Driven("far", {**far.inputs, "input_torque": 30.0 * far.inputs["input_torque"]}, 0).played(
            fitter.case, fitter.case.system
        )


def test_conditions_of_other_logs_are_proposed_and_stated(fitter: Fitter) -> None:
    runs = list(fitter.case.experiments)
    runs[2] = replace(runs[2], add={"wrap_angle": -1.8})
    case = replace(fitter.case, experiments=tuple(runs))
    *usual, other = drives(case)
    assert other.words.endswith("at a wrap angle of 2.4 rad")
    assert other.stated(case) == {"add": {"wrap_angle": -1.8}}
    assert [plan.stated(case) for plan in usual] == [{}] * len(usual)
    assert all(plan.words.endswith("under the nominal conditions") for plan in usual)
    freer, bent = (plan.played(case, case.system).log for plan in (other, usual[4]))
    assert freer.add == {"wrap_angle": -1.8}
    torque = [log.data["output_torque"].to_numpy() for log in (freer, bent)]
    assert np.max(np.abs(torque[0] - torque[1])) > 0.1  # less friction over less wrap

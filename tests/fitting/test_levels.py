"""Without repeats the noise is a parameter of each model: levels, shares of rows that count, halves of the samples."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.cli.demo import bundled
from tendonlab.fitting.case import make_case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import Fitter
from tendonlab.fitting.replay import choose_replay


@pytest.fixture(scope="module")
def fitter(twin_case: Any) -> Fitter:
    """Under the noise of the sensors alone, which is all that is known of a rig without repeats."""
    floor = white(twin_case.noise)
    return Fitter(twin_case, replace(floor, known=tuple(floor.sd)), _core.Cancel())


@pytest.fixture(scope="module")
def nominal(fitter: Fitter) -> Fitted:
    return fitter.fit(fitter.case.system, solve=False)


def dense_evidence(fit: Fitted, shares: np.ndarray) -> float:
    """log of the normal density of all rows, unknowns of runs and parameters marginalised, by its definition."""
    prior = np.array([f.sd for f in fit.free])
    away = (fit.x - np.array([f.mean for f in fit.free])) / prior
    information, misfit, volume = np.diag(1.0 / prior**2), float(away @ away), 0.0
    for run in fit.runs:
        weight = shares[run.output]
        rows, own, slopes = run.residual - run.by_own @ run.own, run.by_own, run.jacobian
        inner = np.eye(own.shape[1]) + own.T @ (weight[:, None] * own)
        misfit += float(_product(rows[:, None], rows[:, None], weight, own)[0, 0])
        information += _product(slopes, slopes, weight, own)
        volume += float(np.linalg.slogdet(inner)[1]) + float(np.sum(weight * 2.0 * np.log(fit.levels[run.output])))
    scaled = prior[:, None] * information * prior
    return -0.5 * (misfit + volume + float(np.linalg.slogdet(scaled)[1]))


def _product(a: np.ndarray, b: np.ndarray, weight: np.ndarray, own: np.ndarray) -> np.ndarray:
    """a' (1/weight + own own')^-1 b."""
    inner = np.eye(own.shape[1]) + own.T @ (weight[:, None] * own)
    left, right = own.T @ (weight[:, None] * a), own.T @ (weight[:, None] * b)
    return np.asarray(a.T @ (weight[:, None] * b) - left.T @ np.linalg.solve(inner, right))


@pytest.mark.parametrize("share", [1.0, 0.02])
def test_rows_count_as_their_share_of_independent_ones(nominal: Fitted, share: float) -> None:
    shares = share * np.array([1.0, 0.5, 0.3])
    assert nominal.counted(shares).evidence == pytest.approx(dense_evidence(nominal, shares), rel=1e-9)


def test_beliefs_that_all_rows_overrule_cost_little_where_few_rows_count(nominal: Fitted) -> None:
    """Where the data say nothing, a step of Newton goes back to what was believed, by at most 1 in each coordinate."""
    blind = replace(nominal, runs=tuple(replace(run, jacobian=0.0 * run.jacobian) for run in nominal.runs))
    sd, share = np.array([f.sd for f in blind.free]), 0.02
    for away in (0.5, 5.0):
        moved = replace(blind, x=blind.x + np.eye(len(sd))[0] * away)
        back = min(1.0, (1.0 - share) * away)
        won = (1.0 - share) * away * back - 0.5 * back**2
        cost = 0.5 * away**2 / sd[0] ** 2 - won / sd[0] ** 2
        lost = blind.counted(share * np.ones(3)).evidence - moved.counted(share * np.ones(3)).evidence
        assert lost == pytest.approx(cost, rel=1e-6)
        assert blind.counted().evidence - moved.counted().evidence == pytest.approx(0.5 * away**2 / sd[0] ** 2)


@pytest.mark.cpu(20)
def test_unknowns_of_a_run_weigh_as_the_rows_that_count(fitter: Fitter, nominal: Fitted) -> None:
    """100 rows that count as one push friction and initial states as far as one of a tenth of its precision."""
    floor = replace(fitter.floor, sd=nominal.own_levels.tolist())
    fewer = replace(fitter, floor=replace(floor, shares=(0.01, 0.01, 0.01)))
    noisier = replace(fitter, floor=replace(floor, sd=[10.0 * sd for sd in floor.sd]))
    one, other = (f.fit(fitter.case.system, known=True) for f in (fewer, noisier))
    for a, b in zip(one.runs, other.runs, strict=True):
        np.testing.assert_allclose(a.own, b.own, atol=1e-4)
        np.testing.assert_allclose(a.by_own, 10.0 * b.by_own, rtol=1e-3, atol=1e-3)
    assert max(np.max(np.abs(run.own)) for run in one.runs) > 0.01


def test_what_friction_may_leave_from_run_to_run_is_counted(nominal: Fitted) -> None:
    """By friction that differs 2.5 times as much as its default; initial states are no excuse."""
    exact, groups = replace(nominal, levels=1.0001 * nominal.known), 2
    runs = [
        replace(run, residual=np.sqrt(1.0 + 2.5**2 * np.sum(run.by_own[:, -groups:] ** 2, axis=1)))
        for run in exact.runs
    ]
    assert replace(exact, runs=tuple(runs)).over_scatter(groups) == pytest.approx(1.0, rel=1e-3)


def test_a_model_that_leaves_twice_the_residual_has_twice_the_level(nominal: Fitted) -> None:
    doubled = replace(nominal, runs=tuple(replace(run, residual=2.0 * run.residual) for run in nominal.runs))
    assert (nominal.own_levels > nominal.known).all()
    np.testing.assert_allclose(doubled.own_levels, 2.0 * nominal.own_levels)
    assert doubled.mean_square == pytest.approx(4.0 * nominal.mean_square)


def test_a_fit_under_other_noise_is_the_one_that_is_simulated_there(fitter: Fitter, nominal: Fitted) -> None:
    levels = nominal.levels * np.array([2.0, 3.0, 0.5])
    there = replace(fitter, floor=replace(fitter.floor, sd=levels.tolist()))
    again = there.fit(nominal.system, initial=nominal.initial, solve=False)
    moved = nominal.under(levels)
    assert moved.cost == pytest.approx(again.cost)
    assert moved.evidence == pytest.approx(again.evidence)
    for a, b in zip(moved.runs, again.runs, strict=True):
        np.testing.assert_allclose(a.jacobian, b.jacobian, rtol=1e-6, atol=1e-6 * np.abs(b.jacobian).max())


@pytest.mark.cpu(20)
def test_a_settled_fit_leaves_the_noise_that_it_assumes(fitter: Fitter, nominal: Fitted) -> None:
    unrepeated = replace(fitter, floor=replace(fitter.floor, sd=nominal.own_levels.tolist()))
    fit = unrepeated.settled(unrepeated.fit(nominal.system))
    np.testing.assert_allclose(fit.levels, fit.own_levels, rtol=0.05)
    assert fit.whitened_square == pytest.approx(1.0, rel=0.1)
    assert (fit.shares < 1.0).all()


def test_the_halves_share_no_sample_and_miss_none(twin_case: Any) -> None:
    odd, even = (twin_case.on_half(odd=odd) for odd in (True, False))
    for whole, a, b in zip(twin_case.prepared, odd.prepared, even.prepared, strict=True):
        first, second = np.isfinite(a.measured), np.isfinite(b.measured)
        assert not (first & second).any()
        np.testing.assert_array_equal(first | second, np.isfinite(whole.measured))


def test_the_injection_is_softer_for_a_noisier_sensor(twin_case: Any) -> None:
    """Its stiffness is a hundredth of the command's rms over the sensor's noise."""
    dataset = replace(twin_case.dataset, controller=None)
    command = np.concatenate([e.data["motor_torque"].to_numpy() for e in dataset.train])
    for noise in (2e-3, 8e-3):
        signal = replace(dataset.signals["motor_angle"], noise_sd=noise, resolution=None)
        noisy = replace(dataset, signals={**dataset.signals, "motor_angle": signal})
        replay = choose_replay(noisy, twin_case.system)
        assert replay.kind == "injection"
        assert replay.kp == pytest.approx(0.01 * np.sqrt(np.mean(command**2)) / noise)


@pytest.mark.parametrize(("rate", "omega"), [(200.0, 50.0), (100.0, 25.0), (60.0, 25.0), (40.0, 20.0)])
def test_the_injection_is_as_stiff_as_the_samples_resolve(twin_case: Any, rate: float, omega: float) -> None:
    """A quarter of a radian a sample; in slow logs up to twice that, as far as logs at 100 Hz go."""
    dataset = replace(twin_case.dataset, controller=None)
    signal = replace(dataset.signals["motor_angle"], noise_sd=1e-9, resolution=None)
    slower = []
    for experiment in dataset.experiments:
        index = pd.Index(np.arange(len(experiment.time)) / rate, name=experiment.data.index.name)
        slower.append(replace(experiment, data=experiment.data.set_axis(index)))
    noiseless = replace(dataset, experiments=tuple(slower), signals={**dataset.signals, "motor_angle": signal})
    replay = choose_replay(noiseless, twin_case.system)
    assert 2.0 * replay.kp / replay.kd == pytest.approx(omega)


def test_shares_are_those_of_each_output_alone(nominal: Fitted) -> None:
    """Residuals of the first output stay for ten rows and those of the second are independent; the third has none."""
    random = np.random.default_rng(0)
    slow, quick = np.repeat(random.standard_normal(300), 10), random.standard_normal(3000)
    run = replace(
        nominal.runs[0],
        residual=np.concatenate([slow, quick]),
        output=np.repeat([0, 1], 3000),
        block=np.zeros(6000, dtype=int),
    )
    three = replace(nominal, runs=(run, run), levels=np.array([2.0, 3.0, 4.0]), known=np.array([0.1, 9.0, 0.1]))
    assert three.own_shares == pytest.approx([0.1, 1.0, 1.0], rel=0.25)
    assert three.own_levels == pytest.approx([2.0, 9.0, 4.0], rel=0.1)  # of the second more noise is known


def test_records_of_a_single_block_are_halved_in_time() -> None:
    """Whatever the length of a record, both halves hold samples of every experiment, and no sample is in both. Nor
    where all that was measured lies in one block of two."""
    rig = tl.load(bundled())
    short = tuple(replace(e, data=e.data.iloc[:500]) for e in rig.experiments)
    lost = [e.data.iloc[:2200].copy() for e in rig.experiments]
    for frame in lost:
        frame.loc[frame.index[1000:], rig.outputs] = np.nan
    assert_halved(make_case(replace(rig, experiments=short)))
    assert_halved(make_case(replace(rig, experiments=tuple(map(with_data, rig.experiments, lost)))))


def with_data(experiment: tl.Experiment, data: pd.DataFrame) -> tl.Experiment:
    return replace(experiment, data=data)


def assert_halved(case: Any) -> None:
    for odd, even in zip(case.on_half(odd=True).prepared, case.on_half(odd=False).prepared, strict=True):
        first, second = np.isfinite(odd.measured[0]), np.isfinite(even.measured[0])
        assert first.sum() == second.sum() > 0
        assert not (first & second).any()

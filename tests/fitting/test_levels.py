"""Without repeats the noise is a parameter of each model: levels, shares of rows that count, halves of the samples."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
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


def test_a_model_that_leaves_twice_the_residual_has_twice_the_level(nominal: Fitted) -> None:
    doubled = replace(nominal, runs=tuple(replace(run, residual=2.0 * run.residual) for run in nominal.runs))
    assert (nominal.own_levels > nominal.known).all()
    np.testing.assert_allclose(doubled.own_levels, 2.0 * nominal.own_levels)
    assert doubled.mean_square == pytest.approx(4.0 * nominal.mean_square)


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
        signal = replace(dataset.signals["motor_angle"], noise_sd=noise)
        noisy = replace(dataset, signals={**dataset.signals, "motor_angle": signal})
        replay = choose_replay(noisy, twin_case.system)
        assert replay.kind == "injection"
        assert replay.kp == pytest.approx(0.01 * np.sqrt(np.mean(command**2)) / noise)


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
    """Whatever the length of a record, both halves hold samples of every experiment, and no sample is in both."""
    rig = tl.load(bundled())
    short = tuple(replace(e, data=e.data.iloc[:500]) for e in rig.experiments)
    case = make_case(replace(rig, experiments=short))
    for odd, even in zip(case.on_half(odd=True).prepared, case.on_half(odd=False).prepared, strict=True):
        first, second = np.isfinite(odd.measured[0]), np.isfinite(even.measured[0])
        assert first.sum() == second.sum() > 0
        assert not (first & second).any()

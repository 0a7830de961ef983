"""Noise of the outputs, on records whose answers are known."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.signal import lfilter

from tendonlab.data.dataset import Dataset, Experiment, NominalParameter, SignalSpec
from tendonlab.errors import DatasetError
from tendonlab.fitting.floor import LARGEST, _autoregression, _run_to_run, friction_groups
from tendonlab.fitting.noise import RUN_TO_RUN_UNKNOWN, Floor, blocks_of, integrated_time, remembered, sensor_noise
from tendonlab.simulation.prepare import Replay, prepare

TIME = np.arange(0.0, 4.0, 0.002)
NOMINAL = {"inertia": 0.5, "gravity_torque": 0.0, "torque_constant": 1.0}
MOTION = 0.5 * np.sin(2 * np.pi * TIME)


def noise_of(angle: np.ndarray, *, noise_sd: float | None = None, resolution: float | None = None) -> float:
    """The noise of a joint's angle recorded as `angle`."""
    frame = pd.DataFrame({"motor_torque": 0.0 * TIME, "joint_angle": angle}, index=pd.Index(TIME, name="t"))
    signals = {
        "motor_torque": SignalSpec("motor_torque", "u", "N*m", "input", True),
        "joint_angle": SignalSpec("joint_angle", "q", "rad", "output", False, noise_sd=noise_sd, resolution=resolution),
    }
    dataset = Dataset(
        name="joint", description="", kind="rigid_joint", axis="rotary", nominal_effects=(), controller=None,
        parameters={n: NominalParameter(v) for n, v in NOMINAL.items()}, signals=signals,
        experiments=(Experiment(name="run", data=frame),), path=Path(),
    )  # fmt: skip
    system = dataset.system()
    return float(sensor_noise(dataset, system, [prepare(e, system, Replay("free")) for e in dataset])[0])


def test_white_noise_is_seen_beneath_the_motion() -> None:
    measured = MOTION + 1e-3 * np.random.default_rng(2).normal(size=len(TIME))
    assert noise_of(measured) == pytest.approx(1e-3, rel=0.1)  # three standard errors of a median over 2000 samples
    assert noise_of(measured, noise_sd=3e-3) == 3e-3


def test_rounding_counts_once() -> None:
    """Readings that move by more than a step per sample hold their rounding as white noise of step/√12."""
    step = 1e-4
    found = noise_of(step * np.round(MOTION / step), resolution=step)
    assert found == pytest.approx(step / np.sqrt(12), rel=0.25)  # differences are whole steps: their median is coarse


def test_readings_that_repeat_are_as_noisy_as_their_rounding() -> None:
    step = 0.1
    assert noise_of(step * np.round(MOTION / step), resolution=step) == pytest.approx(step / np.sqrt(12))
    assert noise_of(step * np.round(MOTION / step), noise_sd=1e-9, resolution=step) == pytest.approx(step / np.sqrt(12))


def test_a_computed_record_is_no_more_exact_than_its_spread_allows_wherever_it_lies() -> None:
    assert noise_of(MOTION) == pytest.approx(1e-7 * np.std(MOTION))
    assert noise_of(MOTION + 100.0) == pytest.approx(1e-7 * np.std(MOTION))


def test_what_never_moves_and_what_was_not_measured() -> None:
    assert noise_of(0.0 * TIME) == 1.0
    with pytest.raises(DatasetError, match="joint: no output of rigid_joint was measured; expected one of joint_angle"):
        noise_of(np.nan * TIME)


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.9])
def test_integrated_time_of_an_autoregression(memory: float) -> None:
    """1 + 2 sum of a^k = (1 + a)/(1 - a)."""
    rng = np.random.default_rng(3)
    times = [integrated_time(lfilter([1.0], [1.0, -memory], rng.normal(size=20_000))) for _ in range(8)]
    assert np.mean(times) == pytest.approx((1 + memory) / (1 - memory), rel=0.12)


def test_integrated_time_of_nothing() -> None:
    assert integrated_time(np.zeros(50)) == 1.0


def test_rows_of_a_whitening_are_the_samples_that_count() -> None:
    """An autoregression of order two needs two samples before each one that counts, also after a gap."""
    measured = np.ones((3, 20))
    measured[0, 8] = np.nan
    measured[2] = np.nan
    floor = Floor(np.ones(3), [[0.5, 0.1], [], []], [1.0, 2.0, 0.0], 0.0, repeated=True)
    whitening = floor.whitening(measured)
    outputs, samples = whitening.cells()
    assert outputs.tolist() == [0] * 15 + [1] * 20
    assert samples.tolist() == [*range(2, 8), *range(11, 20), *range(20)]
    assert whitening.rows() == 35


def test_an_experiment_that_did_not_measure_an_output_is_whitened_without_it() -> None:
    measured = np.ones((2, 20))
    measured[1] = np.nan
    assert Floor(np.ones(2), [[], []], [1.0, 1.0], 0.0, repeated=False).whitening(measured).rows() == 20


@pytest.mark.parametrize(("duration", "lengths"), [(1.0, [100]), (3.9, [390]), (6.0, [200, 200, 200])])
def test_blocks_are_at_least_2_s_long_and_equal(duration: float, lengths: list[int]) -> None:
    time = 5.0 + np.linspace(0.0, duration, int(100 * duration), endpoint=True)
    assert np.bincount(blocks_of(time)).tolist() == pytest.approx(lengths, abs=1)


def test_friction_of_an_element_scales_together(twin_case: Any) -> None:
    names = [p.name for p in twin_case.system.info.parameters]
    groups = [{names[k] for k in group} for group in friction_groups(twin_case.system)]
    assert groups == [{"motor_coulomb", "motor_viscous"}, {"joint_coulomb", "joint_viscous"}]
    added = [{names[k] for k in group} for group in friction_groups(twin_case.system, with_added=True)]
    assert {"motor_coulomb", "motor_static_excess"} < added[0]
    assert {"joint_coulomb", "joint_static_excess"} < added[1]
    assert len(added) == 2
    assert not {"motor_level_asymmetry", "joint_level_asymmetry"} & (added[0] | added[1])  # shares of what scales


def test_runs_that_do_not_repeat_at_all_are_not_put_down_to_friction() -> None:
    assert _run_to_run([np.array([40.0]), np.array([-30.0])]) == LARGEST
    assert 0.0 < _run_to_run([np.array([0.02]), np.array([-0.01])]) < 0.02


def test_one_pair_of_repeats_hardly_tells_how_far_friction_of_another_run_differs() -> None:
    """One that differs by little may be chance; many tell."""

    def unseen(differences: int) -> float:
        told = Floor(np.array([1.0]), [[]], [1.0], 0.002, repeated=differences > 0, differences=differences)
        return told.tau_unseen

    assert unseen(0) == 0.002
    assert unseen(1) == pytest.approx(np.sqrt((0.002**2 + RUN_TO_RUN_UNKNOWN**2) / 2.0))
    assert 0.002 < unseen(100) < 0.003


def test_friction_that_scales_from_run_to_run_stays_within_its_bounds(twin_case: Any) -> None:
    case = replace(
        twin_case, scatter=tuple((tuple(g), 0.1) for g in friction_groups(twin_case.system, with_added=True))
    )
    strong = case.system.with_effects({"joint:load_dependence": {"load_dependence": 0.99}})
    k = [p.name for p in strong.info.parameters].index("joint_load_dependence")
    i = case.train[0]
    values, _ = case.at(i, strong, [*case.prepared[i].initial_mean, 0.0, 0.2])
    assert values[k] == 1.0
    values, _ = case.at(i, strong, [*case.prepared[i].initial_mean, 0.0, -0.2])
    assert values[k] == pytest.approx(0.99 * np.exp(-0.2))


COLOURED = lfilter([1.0], [1.0, -0.8], np.random.default_rng(5).normal(size=20_000))  # innovations of sd 1


SCATTERED = np.random.default_rng(6).random(20_000) < 0.05


@pytest.mark.parametrize("lost", [slice(10_000, None), slice(5_000, 9_000), SCATTERED])
def test_samples_that_were_not_measured_do_not_lower_the_noise(lost: Any) -> None:
    record = COLOURED.copy()
    record[lost] = np.nan
    ar, innovation = _autoregression([record])
    assert innovation == pytest.approx(1.0, rel=0.05)
    assert ar[0] == pytest.approx(0.8, abs=0.05)


def test_noise_is_taken_as_white_where_samples_stand_alone() -> None:
    """At every second stamp no sample follows on six others, and no colour can be told."""
    record = COLOURED.copy()
    record[::2] = np.nan
    ar, sd = _autoregression([record])
    assert ar == []
    assert sd == pytest.approx(np.nanstd(record))
    floor = Floor(np.array([sd]), [[0.8]], [1.0], 0.0, repeated=True)
    measured = record[None, :200]
    assert len(floor.whitening(measured).residual(np.zeros((1, 200)))) == np.isfinite(measured).sum()


@pytest.mark.parametrize("memory", [(), (0.97,), (0.5, 0.2, -0.1)])
def test_noise_with_memory_is_that_of_the_recursive_filter(memory: tuple[float, ...]) -> None:
    driving = np.random.default_rng(0).normal(size=300)
    np.testing.assert_allclose(
        remembered(driving, memory), lfilter([1.0], [1.0, *(-a for a in memory)], driving), atol=1e-12
    )

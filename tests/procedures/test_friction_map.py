"""Map points and maps: what they average, and how their uncertainty falls with the number of runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tendonlab.errors import ParameterError
from tendonlab.procedures import MapPoint, friction_map, map_point

TIME = np.arange(0.0, 4.0, 1e-3)


@settings(max_examples=50, deadline=None)
@given(speed=st.floats(-100.0, 100.0).filter(lambda w: abs(w) > 0.1), torque=st.floats(-1.0, 1.0))
def test_a_clean_run_gives_its_speed_and_torque(speed: float, torque: float) -> None:
    point = map_point(TIME, 3.0 + speed * TIME, np.full(len(TIME), torque))
    assert point.speed == pytest.approx(speed, rel=1e-10)
    assert point.torque == pytest.approx(torque, rel=1e-12, abs=1e-15)
    assert point.sd == pytest.approx(0.0, abs=1e-12)
    assert point.num_samples == 3200


def test_only_the_segment_counts() -> None:
    """Ramps and the torque that they cost are outside; sd is that of the samples inside."""
    torque = np.where((TIME > 1.0) & (TIME < 3.0), 0.1 + 0.02 * np.sin(2.0 * np.pi * 10.0 * TIME), 5.0)
    point = map_point(TIME, 7.0 * TIME, torque, segment=slice(1100, 2900))
    assert point.torque == pytest.approx(0.1, abs=1e-6)
    assert point.sd == pytest.approx(0.02 / np.sqrt(2.0), rel=1e-3)  # of a sine
    assert point.to_dict() == {"speed": point.speed, "torque": point.torque, "sd": point.sd, "num_samples": 1800}


@pytest.mark.parametrize("speed", [1.0, -16.0, 60.0, 105.0])
def test_speeds_of_runs_are_the_commanded_ones(bench_run: Callable[..., Any], speed: float) -> None:
    """S0 asks for 0.5 %; a straight line through the encoder's steps is far better."""
    run = bench_run(speed)
    assert map_point(run.time, run.measured, np.zeros(len(run.time))).speed == pytest.approx(speed, rel=1e-4)


def test_noise_of_a_point_falls_with_the_root_of_its_samples() -> None:
    """300 points each: the sd of their sds is 4 %, so four sd are 16 % of the ratio 4, times root 2."""
    rng = np.random.default_rng(11)

    def spread(num: int) -> float:
        time = np.arange(num) * 1e-3
        runs = [map_point(time, time, rng.normal(size=num), segment=slice(0, num)) for _ in range(300)]
        return float(np.std([run.torque for run in runs]))

    assert spread(100) / spread(1600) == pytest.approx(4.0, rel=0.23)


def noisy_runs(num_runs: int, rng: np.random.Generator) -> list[MapPoint]:
    """The bench repeated: sd 3 % + 1 mN m a run (reconstructed), about 0.17 N m at 16.1 rad/s."""
    torque = 0.17 + (0.03 * 0.17 + 1e-3) * rng.normal(size=num_runs)
    return [MapPoint(16.1 * (1.0 + 1e-3 * rng.normal()), float(t), 0.01, 1000) for t in torque]


def test_uncertainty_of_a_map_falls_with_the_root_of_its_runs() -> None:
    """400 maps each: what they scatter by is known to 3.5 %; and it is what `sd_of_mean` says."""
    rng = np.random.default_rng(12)
    scatter, told = {}, {}
    for num_runs in (5, 20, 80):
        maps = [friction_map(noisy_runs(num_runs, rng)).iloc[0] for _ in range(400)]
        scatter[num_runs] = np.std([row["torque"] for row in maps])
        told[num_runs] = np.sqrt(np.mean([row["sd_of_mean"] ** 2 for row in maps]))
        assert told[num_runs] == pytest.approx(scatter[num_runs], rel=0.16)
    assert scatter[20] == pytest.approx(6.1e-3 / np.sqrt(20.0), rel=0.14)
    assert scatter[5] / scatter[20] == pytest.approx(2.0, rel=0.2)
    assert scatter[20] / scatter[80] == pytest.approx(2.0, rel=0.2)


def test_runs_in_any_order_are_gathered_by_configuration_speed_and_sense() -> None:
    points = {
        "D": [MapPoint(w * (1.0 + e), 0.1 * np.sign(w) + e, 0.0, 10) for e in (-1e-3, 1e-3) for w in (5, 105, -5, 100)],
        "D2M": [MapPoint(5.0, 0.2, 0.0, 10)],
    }
    found = friction_map(points)
    assert list(found.columns) == ["configuration", "speed", "torque", "sd", "sd_of_mean", "num_runs"]
    assert list(found["configuration"]) == ["D"] * 4 + ["D2M"]
    assert found["speed"].to_numpy() == pytest.approx([-5.0, 5.0, 100.0, 105.0, 5.0], rel=1e-12)
    assert found["torque"].to_numpy() == pytest.approx([-0.1, 0.1, 0.1, 0.1, 0.2], rel=1e-12)
    assert list(found["num_runs"]) == [2, 2, 2, 2, 1]
    assert found["sd"].to_numpy()[:4] == pytest.approx(2e-3 / np.sqrt(2.0), rel=1e-9)  # two values 2e-3 apart
    assert found["sd"].isna().tolist() == [False] * 4 + [True]  # one run says nothing of their spread


def test_the_order_of_runs_does_not_matter() -> None:
    runs = [*noisy_runs(20, np.random.default_rng(3)), MapPoint(20.0, 0.16, 0.01, 10)]
    pd.testing.assert_frame_equal(friction_map(runs), friction_map(reversed(runs)))


def test_bad_input_is_named() -> None:
    with pytest.raises(ParameterError, match=r"runs is empty: expected at least one MapPoint"):
        friction_map([])
    with pytest.raises(ParameterError, match=r"speed = nan: expected a value in"):
        friction_map({"D": [MapPoint(np.nan, 0.1, 0.0, 1)]})
    with pytest.raises(ParameterError, match=r"tolerance = 1.0: expected a value in \[0, 1\)"):
        friction_map([MapPoint(1.0, 0.1, 0.0, 1)], tolerance=1.0)
    with pytest.raises(ParameterError, match=r"segment = slice\(5000, 6000, None\): expected at least 2 of the 4000"):
        map_point(TIME, TIME, TIME, segment=slice(5000, 6000))
    with pytest.raises(ParameterError, match=r"torque has 3999 samples: expected 4000"):
        map_point(TIME, TIME, TIME[1:])

"""Noise of steady points: the same whatever the order of their rows, on maps whose noise is known."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.data.dataset import Dataset, Experiment, NominalParameter, SignalSpec
from tendonlab.fitting.noise import sensor_noise
from tendonlab.fitting.set_points import Points, noise_of_points
from tendonlab.simulation.prepare import Replay, prepare

SPEEDS = np.concatenate([-np.geomspace(0.01, 10.0, 16), np.geomspace(0.01, 10.0, 16)])
NOISE = 2e-3


def torque(speed: np.ndarray, *, excess: float = 0.1) -> np.ndarray:
    """Friction with a Stribeck part that falls over 0.3 rad/s."""
    level = 0.2 + excess * np.exp(-np.square(speed / 0.3)) + 0.03 * np.abs(speed)
    return np.asarray(np.sign(speed) * level)


def points(speed: np.ndarray, seed: int, scale: float = 1.0) -> Points:
    order = np.random.default_rng(seed).permutation(len(speed))
    noise = NOISE * np.random.default_rng(seed + 1000).normal(size=len(speed))
    return Points(speed[order, None], scale * torque(speed[order]) + noise)


def test_points_at_equal_speeds_tell_the_noise() -> None:
    """Friction that differs by 5 % from run to run is no noise: 128 differences, known to 6 %."""
    taken = [points(np.repeat(SPEEDS, 2), seed, 1.0 + 0.05 * seed) for seed in range(4)]
    assert noise_of_points(taken) == pytest.approx(NOISE, rel=0.2)


@pytest.mark.parametrize("draw", ["own", "measured", "one"])
def test_neighbours_tell_it_where_no_speed_returns(draw: str) -> None:
    """Speeds drawn anew in each run, set points that are measured with an error, and one run alone."""
    random = np.random.default_rng(5)
    speeds = {
        "own": [random.uniform(-5.0, 5.0, 40) for _ in range(4)],
        "measured": [np.repeat(np.linspace(0.5, 5.0, 12), 3) * (1.0 + 1e-3 * random.normal(size=36)) for _ in range(4)],
        "one": [np.concatenate([-np.linspace(0.1, 5.0, 60), np.linspace(0.1, 5.0, 60)])],
    }[draw]
    found = noise_of_points([points(speed, seed) for seed, speed in enumerate(speeds)])
    assert 0.7 * NOISE < found < 1.4 * NOISE


def test_equal_speeds_of_different_runs_are_compared_where_neighbours_are_far() -> None:
    """Ten speeds over three decades: what lies between neighbours is ten times the noise."""
    taken = [points(np.geomspace(0.01, 10.0, 10), seed) for seed in range(5)]
    assert noise_of_points(taken) == pytest.approx(NOISE, rel=0.3)


def test_loads_are_told_apart() -> None:
    """Two loads in one run, or as a condition of two runs, differ by far more than the noise."""
    speed = np.tile(np.linspace(0.5, 5.0, 30), 2)
    load = np.repeat([1.0, 3.0], 30)
    values = load * torque(speed) + NOISE * np.random.default_rng(6).normal(size=60)
    assert noise_of_points([Points(np.column_stack([speed, load]), values)]) == pytest.approx(NOISE, rel=0.35)
    assert noise_of_points([Points(speed[:, None], values)]) > 20.0 * NOISE


def test_coarse_readings_are_as_noisy_as_their_rounding_and_few_points_tell_nothing() -> None:
    speed = np.tile(np.linspace(0.5, 5.0, 10), 4)
    coarse = 0.05 * np.round(torque(speed) / 0.05)
    assert noise_of_points([Points(speed[:, None], coarse)]) == pytest.approx(0.05 / np.sqrt(12.0))
    assert noise_of_points([Points(speed[:3, None], torque(speed[:3]))]) == 0.0


def friction_map(seed: int | None, *, excess: float = 0.1) -> Dataset:
    """Six runs with each speed twice; rows are shuffled by `seed`, or sorted."""
    runs = []
    for k in range(6):
        speed = np.repeat(np.sort(SPEEDS), 2)
        read = torque(speed, excess=excess) + NOISE * np.random.default_rng(k).normal(size=64)
        rows = np.arange(64) if seed is None else np.random.default_rng(seed + k).permutation(64)
        index = pd.Index(np.arange(64.0), name="t")
        data = pd.DataFrame({"speed": speed[rows], "friction_torque": read[rows]}, index=index)
        runs.append(Experiment(name=f"run-{k}", data=data, split="train" if k < 4 else "test"))
    stated = {"contact_coulomb": (0.22, 0.05), "contact_viscous": (0.035, 0.01), "relative_load": (1.0, 0.0)}
    return Dataset(
        name="map", description="", kind="friction_map", axis="rotary", controller=None, path=Path(),
        nominal_effects=("contact:coulomb", "contact:viscous"), experiments=tuple(runs),
        parameters={name: NominalParameter(*given) for name, given in stated.items()},
        signals={
            "speed": SignalSpec("speed", "w", "rad/s", "input", True),
            "friction_torque": SignalSpec("friction_torque", "T", "N*m", "output", False),
        },
    )  # fmt: skip


def test_the_order_of_rows_means_nothing() -> None:
    found = []
    for seed in (None, 1, 2):
        dataset = friction_map(seed)
        system = dataset.system()
        found += list(sensor_noise(dataset, system, [prepare(e, system, Replay("free")) for e in dataset]))
    assert found == pytest.approx([found[0]] * 3, rel=1e-9)
    assert found[0] == pytest.approx(NOISE, rel=0.2)


@pytest.mark.parametrize(
    ("excess", "verdict", "selected"),
    [
        (0.0, "parameters_only", ()),
        (0.1, "effect", ("contact:stribeck",)),
    ],
)
def test_shuffled_maps_are_diagnosed(excess: float, verdict: str, selected: tuple[str, ...]) -> None:
    found = tl.diagnose(friction_map(3, excess=excess), progress=False)
    assert (found.verdict, found.selected) == (verdict, selected)


@pytest.mark.parametrize("num", [5, 6])
def test_few_points_tell_the_size_of_their_noise(num: int) -> None:
    """Never none: a floor of 0 would make the least misfit certain."""
    few = np.concatenate([-np.geomspace(0.5, 5.0, num), np.geomspace(0.5, 5.0, num)])
    found = [noise_of_points([points(few, seed)]) for seed in range(20)]
    assert min(found) > 0.05 * NOISE
    assert np.median(found) < 5.0 * NOISE

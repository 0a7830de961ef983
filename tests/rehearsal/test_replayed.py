"""Noise of the sensors that leaves, once replayed, what the logs of the rig leave."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.fitting.case import make_case
from tendonlab.rehearsal.build import simulated_rig
from tendonlab.rehearsal.replayed import GRID, as_replayed, spectrum
from tendonlab.rehearsal.rig import SimulatedRig
from tendonlab.rehearsal.sensors import Noise, Sensor, floor_of_logs, noise_of_rig

SLOW = Sensor("joint_angle", 2e-4, (0.97,))  # 0.8 mrad, a memory of 33 samples


def repeated_rig(pendulum: Path, label: str | None = "A") -> SimulatedRig:
    """Six repeats of one motion, without a controller, of a rig whose sensor has slow noise. `label`: None where the
    dataset does not say that they repeat."""
    rig = tl.load(pendulum)
    rigs = simulated_rig(rig)
    runs = tuple(replace(rigs.runs[0], name=f"repeat-{k}", repeat=label, split="train") for k in range(6))
    rigs = replace(rigs, runs=runs, noise=Noise((SLOW,), 0.008, repeated=label is not None))
    return replace(rigs, rig=rigs.noisy(np.random.default_rng(7), rigs.system))


def slow_power(noise: Noise) -> float:
    """Mean power below a 64th of the rate."""
    return float(np.mean(spectrum(noise.sensors[0].noise, noise.sensors[0].memory)[: GRID // 64]))


@pytest.mark.cpu(20)
@pytest.mark.parametrize("label", ["A", None])
def test_slow_noise_that_the_replay_follows_is_given_back(pendulum: Path, label: str | None) -> None:
    """The floor of the logs alone holds a fraction of its power."""
    rigs = repeated_rig(pendulum, label)
    case = make_case(rigs.rig)
    floor = floor_of_logs(rigs.rig, case)
    assert floor is not None
    assert floor.repeated == (label is not None)
    once = noise_of_rig(rigs.rig, case, floor)
    true = slow_power(Noise((SLOW,), 0.0, repeated=True))
    assert slow_power(once) < 0.5 * true
    mended = as_replayed(replace(rigs, noise=once), floor, np.random.default_rng(0))
    assert slow_power(once) < 0.7 * slow_power(mended)
    assert 0.4 < slow_power(mended) / true < 2.0
    assert mended.scatter == once.scatter


@pytest.mark.cpu(20)
def test_repeats_may_be_held_out_and_a_sensor_silent(pendulum: Path) -> None:
    """No noise stays no noise."""
    rigs = repeated_rig(pendulum)
    case = make_case(rigs.rig)
    floor = floor_of_logs(rigs.rig, case)
    assert floor is not None
    held = tuple(replace(run, split="test") for run in rigs.runs)
    noise = as_replayed(replace(rigs, runs=held), floor, np.random.default_rng(0))
    assert noise.sensors[0].noise > 0.0
    silent = Noise((Sensor("joint_angle", 0.0),), 0.008, repeated=True)
    assert as_replayed(replace(rigs, noise=silent), floor, np.random.default_rng(0)).sensors[0].noise == 0.0


@pytest.mark.cpu(30)
@pytest.mark.parametrize("read", [0.0, 0.02])
def test_noise_of_a_logged_command_is_no_noise_of_the_sensor(pendulum: Path, read: float) -> None:
    """The rig does not feel that noise, a replay by the logged command does."""
    rigs = repeated_rig(pendulum)
    white = Sensor("joint_angle", 2e-4)
    rigs = replace(rigs, noise=Noise((white,), 0.008, repeated=True, command=read))
    logs = rigs.noisy(np.random.default_rng(8), rigs.system)
    found = simulated_rig(logs).noise
    assert found.command == pytest.approx(read, rel=0.1)
    assert 0.5 < found.sensors[0].total / white.noise < 2.5  # without it ten times as much, to drift as the replay does


@pytest.mark.cpu(20)
def test_outliers_are_no_noise(pendulum: Path) -> None:
    """A diagnosis leaves them out, so a rehearsal must not need effects to be larger for them."""
    rig, random = tl.load(pendulum), np.random.default_rng(5)
    spoilt = []
    for e in rig:
        angle = e.data["joint_angle"].to_numpy(copy=True)
        angle[random.choice(len(angle), 3, replace=False)] += 0.3
        spoilt.append(replace(e, data=e.data.assign(joint_angle=angle)))
    clean, with_spikes = (
        simulated_rig(of).noise.sensors[0].total for of in (rig, replace(rig, experiments=tuple(spoilt)))
    )
    assert with_spikes == pytest.approx(clean, rel=0.2)


def test_the_mean_power_is_the_variance() -> None:
    sensor = Sensor("q", 0.1, (0.6, 0.2))
    read = sensor.drawn(200_000, np.random.default_rng(1))
    assert np.mean(spectrum(sensor.noise, sensor.memory)) == pytest.approx(read.var(), rel=0.03)

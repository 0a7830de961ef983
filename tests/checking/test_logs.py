"""Smoothed logs: what scaling, shifting and thinning do to signals whose derivatives are known, and what is clear."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from checking.pendulum import record
from tendonlab.checking import smoothing
from tendonlab.checking.logs import TIME, Logs, _Record, read_logs

STEP = 0.01
CLOCK = STEP * np.arange(300)


def sines(time: np.ndarray) -> np.ndarray:
    """Position, velocity and acceleration of sin(3 t)."""
    return np.array([np.sin(3 * time), 3 * np.cos(3 * time), -9 * np.sin(3 * time)])


def driven(time: np.ndarray) -> np.ndarray:
    """Value, rate and integral of sin(3 t)."""
    return np.array([np.sin(3 * time), 3 * np.cos(3 * time), (1 - np.cos(3 * time)) / 3])


@pytest.fixture
def logs() -> Logs:
    """Two experiments of the same motion, end to end."""
    moving = {"q": np.tile(sines(CLOCK), 2), "p": 2.0 * np.tile(sines(CLOCK), 2)}
    driving = {"u": np.tile(driven(CLOCK), 2)}
    run, time = np.repeat([0, 1], len(CLOCK)), np.tile(CLOCK, 2)
    clear = np.arange(len(time)) % 3 > 0
    return Logs(moving, driving, {"f": np.tile(sines(CLOCK)[:1], 2)}, run, time, STEP, clear)


def test_a_scale_divides_a_signal_with_its_derivatives_and_no_other(logs: Logs) -> None:
    scaled = logs.scaled(["q", "u"], 4.0)
    np.testing.assert_allclose(scaled.moving["q"], logs.moving["q"] / 4.0)
    np.testing.assert_allclose(scaled.driving["u"], logs.driving["u"] / 4.0)
    np.testing.assert_allclose(scaled.moving["p"], logs.moving["p"])
    np.testing.assert_allclose(scaled.others["f"], logs.others["f"])


def test_a_clock_that_runs_ten_times_too_far_makes_rates_ten_times_too_small(logs: Logs) -> None:
    slow = logs.scaled([TIME], 10.0)
    for k in range(3):
        np.testing.assert_allclose(slow.moving["q"][k], 10.0**k * logs.moving["q"][k])
    value, rate, travel = logs.driving["u"]
    np.testing.assert_allclose(slow.driving["u"], [value, 10.0 * rate, travel / 10.0])
    np.testing.assert_allclose(slow.others["f"], logs.others["f"])


def test_an_output_is_taken_earlier_in_one_experiment_alone(logs: Logs) -> None:
    """The value at t + by, by a spline; past the end of the record its last value."""
    by = np.array([0.0, 0.037])
    moved = logs.earlier({"q": by}).moving["q"]
    np.testing.assert_array_equal(moved[:, :300], logs.moving["q"][:, :300])
    np.testing.assert_allclose(moved[:, 300:590], sines(CLOCK + 0.037)[:, :290], atol=2e-5)  # spline of 10 ms steps
    np.testing.assert_allclose(moved[:, -1], logs.moving["q"][:, -1])
    np.testing.assert_allclose(
        logs.earlier({"f": by}).others["f"][0, 300:590], np.sin(3 * (CLOCK + 0.037))[:290], atol=1e-6
    )
    early = logs.earlier({"p": np.array([-0.05, 0.0])}).moving["p"]
    np.testing.assert_allclose(early[:, 5:300], 2.0 * sines(CLOCK - 0.05)[:, 5:], atol=2e-5)


def test_a_small_shift_is_the_derivative_times_its_length(logs: Logs) -> None:
    moved, back = logs.nudged("q", 1e-5).moving["q"], logs.nudged("f", -1e-5).others["f"]
    inside = slice(2, 298)
    np.testing.assert_allclose(moved[:, inside], sines(CLOCK + 1e-5)[:, inside], rtol=0, atol=3e-7)
    assert np.all(moved[0] != logs.moving["q"][0])
    np.testing.assert_allclose(back[:, inside], sines(CLOCK - 1e-5)[:1, inside], rtol=0, atol=1e-8)
    np.testing.assert_array_equal(logs.nudged("q", 1e-5).moving["p"], logs.moving["p"])


def test_whole_steps_are_rolled_without_a_way_round_the_ends(logs: Logs) -> None:
    ahead, behind = logs.rolled(["q"], 7), logs.rolled(["q"], -7)
    np.testing.assert_array_equal(ahead.moving["q"][:, :-7], logs.moving["q"][:, 7:])
    np.testing.assert_array_equal(ahead.moving["q"][:, -7:], np.repeat(logs.moving["q"][:, -1:], 7, axis=1))
    np.testing.assert_array_equal(behind.moving["q"][:, 7:], logs.moving["q"][:, :-7])
    np.testing.assert_array_equal(ahead.moving["p"], logs.moving["p"])


@pytest.mark.parametrize("most", [7, 100, 133, 400, 1000])
def test_thinned_logs_are_clear_even_and_few_enough(logs: Logs, most: int) -> None:
    thin = logs.thinned(most)
    assert thin.clear.all()
    assert min(most, 400) / 2 <= len(thin.run) <= most
    assert thin.moving["q"].shape == (3, len(thin.run)) == (3, len(thin.time))
    np.testing.assert_allclose(thin.moving["q"], sines(thin.time))
    np.testing.assert_allclose(thin.driving["u"], driven(thin.time))


def test_a_sample_that_is_alone_of_its_experiment_is_left_out(logs: Logs) -> None:
    run = logs.run.copy()
    run[np.flatnonzero(logs.clear)[-1]] = 2
    kept = replace(logs, run=run).regular(10_000)
    assert len(kept) == logs.clear.sum() - 1
    assert set(run[kept]) == {0, 1}


def test_logs_of_a_pendulum_hold_its_derivatives(tmp_path: Path) -> None:
    """The acceleration is that of the motion that was logged; the input is as it was written."""
    logs = record()
    time = np.arange(2001) / 250
    runs = {name: (time, np.sin(2 * time + phase), np.cos(time)) for name, phase in (("a", 0.0), ("b", 1.0))}
    rig = replace(logs, runs=runs).write(tmp_path)
    found = read_logs(rig, rig.system().info)
    assert found is not None
    late = 0.5 * (max(1, int(found.step * 250 / smoothing.BLOCK)) - 1) / 250  # blocks stand for their middle
    for i, phase in enumerate((0.0, 1.0)):
        own = (found.run == i) & (found.time > 0.2) & (found.time < 7.8)
        at = 2 * (found.time[own] + late) + phase
        expected = np.array([np.sin(at), 2 * np.cos(at), -4 * np.sin(at)])
        np.testing.assert_allclose(found.moving["joint_angle"][:, own], expected, atol=0.01)
        torque = rig.signals["motor_torque"]
        assert torque.role == "input"
        value, _, travel = found.driving["motor_torque"][:, own]
        seen = found.time[own] + late - 0.5 / 250
        np.testing.assert_allclose(value, np.cos(seen), atol=2e-3)
        np.testing.assert_allclose(travel - travel[0], np.sin(seen) - np.sin(seen[0]), atol=2e-3)
    np.testing.assert_allclose(np.diff(found.time[found.run == 0]), found.step)


def test_samples_near_ends_gaps_and_standstill_are_not_clear(tmp_path: Path) -> None:
    logs = record()
    time = np.arange(3000) / 250
    angle = np.where(time < 8.0, np.sin(2 * time), np.sin(16.0))  # comes to rest at 8 s
    angle = angle + 1e-4 * np.random.default_rng(0).standard_normal(len(time))
    kept = (time < 3.0) | (time > 3.4)
    rig = replace(logs, runs={"a": (time[kept], angle[kept], np.cos(time[kept]))}).write(tmp_path)
    found = read_logs(rig, rig.system().info)
    assert found is not None
    clear = found.time[found.clear]
    assert len(clear) > 0.5 * 7.0 / found.step
    assert clear.min() > 0.0
    assert np.sum(clear > 8.1) <= 2  # of 240 samples of noise, beyond 3 sd
    assert not np.any((clear > 3.0) & (clear < 3.4))
    assert np.any((clear > 2.5) & (clear < 3.0))
    assert np.any((clear > 3.4) & (clear < 3.9))
    turns = np.pi / 4 + np.arange(3) * np.pi / 2  # where sin(2 t) turns round
    assert np.min(np.abs(clear[:, None] - turns)) > 0.5 * found.step


def test_logs_at_rest_or_without_a_position_are_none(tmp_path: Path) -> None:
    logs, time = record(), np.arange(500) / 250
    noise = 1e-3 * np.random.default_rng(0).standard_normal(500)
    rest = replace(logs, runs={"a": (time, noise, np.sin(time))}).write(tmp_path)
    assert read_logs(rest, rest.system().info) is None
    short = replace(logs, runs={"a": (time[:31], np.sin(time[:31]), time[:31])}).write(tmp_path / "short")
    assert read_logs(short, short.system().info) is None
    just = replace(logs, runs={"a": (time[:33], np.sin(9 * time[:33]), time[:33])}).write(tmp_path / "just")
    assert read_logs(just, just.system().info) is not None


def test_a_gap_is_marked_from_its_first_to_its_last_sample(tmp_path: Path) -> None:
    logs, time = record(), np.arange(500) / 250
    kept = np.delete(np.arange(500), np.arange(200, 210))
    angle = np.sin(5 * time)
    rig = replace(logs, runs={"a": (time[kept], angle[kept], angle[kept])}).write(tmp_path)
    whole = _Record.of(rig.system().info, rig["a"], 1 / 250, {}).whole
    assert len(whole) == 500
    assert np.flatnonzero(~whole).tolist() == list(range(199, 211))

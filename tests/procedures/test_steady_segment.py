"""The steady part of a run: inside the plateau, all of it but the trim, whatever the speed, noise or rest."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.procedures import steady_segment

TIME = np.arange(0.0, 10.0, 1e-3)


@pytest.mark.parametrize("speed", [1.0, -1.0, 5.0, 16.0, -35.0, 60.0, 105.0])
def test_it_lies_in_the_plateau_and_has_most_of_it(bench_run: Callable[..., Any], speed: float) -> None:
    """Every kept sample moves at the commanded speed; of 80 % of the plateau at least 70 % remain (the acceleration
    needs a window of 5 % of the record, which costs the edges)."""
    run = bench_run(speed)
    kept = steady_segment(run.time, run.measured)
    plateau = np.flatnonzero(run.speed == speed)
    np.testing.assert_allclose(run.speed[kept], speed, rtol=1e-12)
    assert 0.70 * len(plateau) < kept.stop - kept.start <= 0.80 * len(plateau) + 2


def test_a_run_that_is_steady_throughout_is_kept_but_for_the_trim() -> None:
    assert steady_segment(TIME, 3.0 * TIME) == slice(1000, 9000)
    assert steady_segment(TIME, 3.0 * TIME, trim=0.25) == slice(2500, 7500)
    for num in (10_000, 9_999, 25):  # whatever is left over after the blocks
        assert steady_segment(TIME[:num], 3.0 * TIME[:num], trim=0.0) == slice(0, num)


def test_a_long_rest_is_no_steady_motion() -> None:
    """Seven seconds of rest, two of motion."""
    speed = np.where((TIME > 7.0) & (TIME < 9.0), 2.0, 0.0)
    kept = steady_segment(TIME, np.cumsum(speed) * 1e-3 + 1e-4 * np.random.default_rng(0).normal(size=len(TIME)))
    assert 7.0 < TIME[kept][0] < TIME[kept][-1] < 9.0


def test_of_two_plateaus_the_longer_is_taken() -> None:
    speed = np.where(TIME < 4.0, 1.0, 2.0)
    kept = steady_segment(TIME, np.cumsum(speed) * 1e-3)
    assert TIME[kept][0] > 4.0


def test_the_tolerance_decides_what_is_steady() -> None:
    """Speed rises by 0.05 rad/s^2 throughout: within 0.06, not within 0.04."""
    position = TIME + 0.025 * TIME**2
    assert steady_segment(TIME, position, tolerance=0.06, trim=0.0) == slice(0, 10_000)
    with pytest.raises(ParameterError, match=r"position is steady for 0 samples at most: .* a tolerance above 0.04 "):
        steady_segment(TIME, position, tolerance=0.04)


def test_noise_of_the_acceleration_is_no_acceleration() -> None:
    """300 samples, noise of 1 % of the travel: it alone has 25 times the acceleration that would be allowed without."""
    time = np.arange(300) * 1e-3
    for seed in range(20):
        noisy = time / 0.3 + 0.01 * np.random.default_rng(seed).normal(size=300)
        kept = steady_segment(time, noisy, trim=0.0)
        assert kept.stop - kept.start > 250


def test_what_is_never_steady_is_refused() -> None:
    """A swing has no acceleration for an instant only; and noise about rest is no motion."""
    with pytest.raises(
        ParameterError, match=r"position is steady for \d+ samples at most: expected at least 5% of 10000"
    ):
        steady_segment(TIME, np.sin(TIME))
    with pytest.raises(ParameterError, match=r"position stays within .*: expected one that moves"):
        steady_segment(TIME, np.random.default_rng(0).normal(size=len(TIME)))


def test_long_records_are_cut_at_the_same_times() -> None:
    """A million samples or ten thousand: the ends agree within two blocks of a two-thousandth of the record."""
    ends = []
    for interval in (1e-3, 1e-5):
        time = np.arange(0.0, 10.0, interval)
        speed = np.clip(np.minimum(time, 10.0 - time), 0.0, 1.0)
        ends.append(time[steady_segment(time, np.cumsum(speed) * interval)][[0, -1]])
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=0.01)


def test_units_do_not_matter(bench_run: Callable[..., Any]) -> None:
    run = bench_run(10.0)
    kept = steady_segment(run.time, run.measured)
    assert steady_segment(run.time + 1e3, 1e-6 * run.measured) == kept
    assert steady_segment(run.time * 60.0, run.measured) == kept


@pytest.mark.parametrize(
    ("time", "position", "options", "message"),
    [
        (TIME[:19], TIME[:19], {}, "time has 19 samples: expected at least 20"),
        (TIME, TIME[:-1], {}, "position has 9999 samples: expected 10000"),
        (TIME, np.full(10_000, 2.0), {}, "position stays within .* of 2: expected one that moves"),
        (TIME, TIME, {"trim": 0.5}, "trim = 0.5: expected a value in"),
        (TIME, TIME, {"trim": -0.1}, "trim = -0.1: expected a value in"),
        (TIME, TIME, {"tolerance": 0.0}, "tolerance = 0.0: expected a value in"),
        (np.sort(np.random.default_rng(0).uniform(size=99)), np.arange(99.0), {}, "expected even sampling"),
    ],
)
def test_bad_input_is_named(time: Any, position: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        steady_segment(time, position, **options)

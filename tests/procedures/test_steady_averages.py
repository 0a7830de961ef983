"""One row a plateau, and gravity taken off by its opposite."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.procedures import steady_averages

TIME = np.arange(0.0, 60.0, 1e-3)
RAMP = 0.1  # s
PLATEAUS = [  # speed, rad/s, from, to, s; the way back passes the positions of the way out
    (1.0, 1.0, 5.0),
    (-1.0, 6.0, 10.0),
    (3.0, 12.0, 16.0),
    (3.5, 16.1, 18.0),
    (-3.5, 20.0, 21.9),
    (-3.0, 22.0, 26.0),
    (0.2, 28.0, 38.0),
    (-0.2, 40.0, 50.0),
]


def log() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Velocity, position, and a torque of constant and viscous friction and of a swinging weight."""
    velocity = sum(s * np.clip(np.minimum((TIME - b) / RAMP, (e - TIME) / RAMP), 0.0, 1.0) for s, b, e in PLATEAUS)
    velocity = np.asarray(velocity)
    position = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1])) * 1e-3])
    return velocity, position, 0.3 * np.sin(position) + 0.05 * np.sign(velocity) + 0.02 * velocity


VELOCITY, POSITION, TORQUE = log()
SPEEDS = [s for s, _, _ in PLATEAUS]


def test_every_plateau_has_a_row_between_its_ramps() -> None:
    found = steady_averages(TIME, VELOCITY, TORQUE)
    assert list(found.columns) == ["start", "end", "speed", "torque", "sd", "num_samples"]
    assert found["speed"].to_numpy() == pytest.approx(SPEEDS, rel=1e-9)
    for row, (_, begin, end) in zip(found.itertuples(), PLATEAUS, strict=True):
        assert begin + RAMP < row.start < row.end < end - RAMP
        assert row.end - row.start > 0.6 * (end - begin - 2.0 * RAMP)
        assert row.num_samples == pytest.approx((row.end - row.start) / 1e-3 + 1.0)


def test_without_weight_the_average_is_the_friction() -> None:
    friction = 0.05 * np.sign(VELOCITY) + 0.02 * VELOCITY
    found = steady_averages(TIME, VELOCITY, friction)
    assert found["torque"].to_numpy() == pytest.approx([0.05 * np.sign(s) + 0.02 * s for s in SPEEDS], abs=1e-12)
    assert found["sd"].max() < 1e-12


def test_half_the_difference_of_opposite_plateaus_is_friction_half_the_sum_is_gravity() -> None:
    """Exact but for the straight lines between samples: (v h)^2 / 8 of the weight's curvature, 5e-7 N m at 3.5 rad/s.
    Gravity is the mean of 0.3 sin(q) over the positions q that both plateaus pass."""
    found = steady_averages(TIME, VELOCITY, TORQUE, position=POSITION)
    assert found["friction"].to_numpy() == pytest.approx([0.05 * np.sign(s) + 0.02 * s for s in SPEEDS], abs=1e-6)
    assert np.abs(found["torque"] - found["friction"]).min() > 0.02  # the plain average is far from it
    for out, back in ((0, 1), (2, 5), (3, 4), (6, 7)):
        ends = np.interp(found.loc[[out, back], ["start", "end"]], TIME, POSITION)
        lower, upper = ends.min(axis=1).max(), ends.max(axis=1).min()
        mean = 0.3 * (np.cos(lower) - np.cos(upper)) / (upper - lower)
        assert found["gravity"][[out, back]].to_numpy() == pytest.approx([mean, mean], abs=2e-6)


def test_noise_of_the_averages_is_that_of_a_mean() -> None:
    """Torque noise of 0.05 N m over some 3000 samples: 0.9 mN m, so four sd are 4 mN m. The velocity's noise of
    0.02 rad/s, a tenth of the slowest speed, hides no plateau."""
    rng = np.random.default_rng(0)
    noisy = VELOCITY + 0.02 * rng.normal(size=len(TIME)), TORQUE + 0.05 * rng.normal(size=len(TIME))
    found = steady_averages(TIME, *noisy, position=POSITION + 1e-3 * rng.normal(size=len(TIME)))
    assert found["speed"].to_numpy() == pytest.approx(SPEEDS, abs=0.003)
    assert found["friction"].to_numpy() == pytest.approx([0.05 * np.sign(s) + 0.02 * s for s in SPEEDS], abs=0.004)


def test_a_slow_ramp_is_no_plateau_unless_tolerated() -> None:
    """The speed grows by a tenth in half a second."""
    growing = np.exp(0.2 * TIME[:5000])
    with pytest.raises(ParameterError, match=r"shortest = 0.5 s: expected a plateau of that length"):
        steady_averages(TIME[:5000], growing, growing)
    assert len(steady_averages(TIME[:5000], growing, growing, tolerance=0.2)) == 1


def test_short_stretches_are_no_plateaus() -> None:
    """Of 3.8 s and of 1.7 s only the former last three."""
    found = steady_averages(TIME, VELOCITY, TORQUE, shortest=3.0)
    assert set(np.round(found["speed"], 6)) == {1.0, -1.0, 3.0, -3.0, 0.2, -0.2}


def test_a_plateau_without_its_opposite_is_named() -> None:
    """Cut before the way back; or the way back elsewhere."""
    cut = slice(0, 20_000)
    with pytest.raises(ParameterError, match=r"velocity = 3 about 14 s: expected a plateau at the opposite speed"):
        steady_averages(TIME[cut], VELOCITY[cut], TORQUE[cut], position=POSITION[cut])
    elsewhere = POSITION + np.where(TIME > 5.5, 20.0, 0.0) + np.where(TIME > 11.0, -20.0, 0.0)
    with pytest.raises(ParameterError, match=r"velocity = 1 about 3.* s: expected .* passes the same positions"):
        steady_averages(TIME, VELOCITY, TORQUE, position=elsewhere)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"tolerance": 0.0}, r"tolerance = 0.0: expected a value in \(0, 1\)"),
        ({"shortest": 0.001}, "shortest = 0.001: expected a value in"),
        ({"shortest": 100.0}, "shortest = 100.0: expected a value in"),
        ({"trim": 0.5}, r"trim = 0.5: expected a value in \[0, 0.5\)"),
        ({"position": POSITION[1:]}, "position has 59999 samples: expected 60000"),
    ],
)
def test_bad_input_is_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        steady_averages(TIME, VELOCITY, TORQUE, **options)

"""Outliers are found in motion, alone and in pairs, and corners of a motion are none."""

import numpy as np
import pytest

from tendonlab.checking.spikes import _are_kicks, outliers

TIME = np.arange(0.0, 10.0, 0.01)
CHIRP = 0.5 * np.sin(2 * np.pi * (0.1 * TIME + 0.1 * TIME**2))  # up to 2.1 Hz: 0.07 rad from sample to sample
NOISE = 1e-4 * np.random.default_rng(3).standard_normal(len(TIME))


def test_outliers_are_found_in_fast_motion() -> None:
    at = [120, 431, 780, 905, 906, 950, 981, 982]  # two pairs
    wrong = CHIRP + NOISE
    wrong[at] += [0.1, -0.3, 0.12, 0.4, -0.5, 0.2, 0.3, 0.25]
    assert np.flatnonzero(outliers(wrong)).tolist() == at


def test_an_outlier_does_not_hide_the_next_but_one() -> None:
    """Both to the same side, as in a corner of the motion."""
    wrong = CHIRP + NOISE
    wrong[[718, 720]] += [0.25, 0.37]
    assert np.flatnonzero(outliers(wrong)).tolist() == [718, 720]


def test_an_outlier_at_the_end_is_no_noise() -> None:
    """The last sample whose path is known from both sides: no copy of it tells how large the noise is."""
    wrong = CHIRP[:979] + NOISE[:979]  # ends in a fast part
    wrong[-3] -= 0.3
    assert np.flatnonzero(outliers(wrong)).tolist() == [976]


def test_an_outlier_at_either_end_is_found() -> None:
    """The path of the first two and the last two samples is known from one side only."""
    for at in (0, 1, 998, 999):
        wrong = CHIRP + NOISE
        wrong[at] += 0.1
        assert np.flatnonzero(outliers(wrong)).tolist() == [at]


def test_noise_and_jumps_at_the_ends_are_none() -> None:
    for seed in range(50):
        assert not outliers(np.random.default_rng(seed).standard_normal(300)).any()
    step = np.where(np.arange(300) < 3, 0.0, 1.0) + NOISE[:300]
    assert not outliers(step).any()


def test_smooth_motion_has_none() -> None:
    assert not outliers(CHIRP + NOISE).any()


def test_noise_where_a_motion_turns_is_none() -> None:
    """While it moves on each sample is the median of its neighbours: noise shows at the turns alone."""
    for seed in (16, 31):
        noise = 0.12 * np.random.default_rng(seed).standard_normal(len(TIME))
        assert not outliers(np.round(20.0 * np.sin(2.0 * TIME) + noise, 2)).any()


def test_a_corner_is_none() -> None:
    """A joint that hits a stop turns at once."""
    stopped = np.minimum(2.0 * TIME, 7.0) + NOISE
    bounced = 7.0 - 2.0 * np.abs(TIME - 3.5) + NOISE
    assert not outliers(stopped).any()
    assert not outliers(bounced).any()


def test_a_record_of_fewer_than_three_windows_has_none() -> None:
    """21 samples: with fewer the median of seven says nothing of the rest."""
    line = np.linspace(0.0, 1.0, 40)
    line[10] += 5.0
    assert np.flatnonzero(outliers(line)).tolist() == [10]
    assert not outliers(line[:20]).any()


def test_what_is_frequent_belongs_to_the_signal() -> None:
    """At most 3 % of a record are outliers."""
    few, many = CHIRP + NOISE, CHIRP + NOISE
    few[20:960:34] += 0.5  # 28 of 1000
    many[20:960:28] += 0.5  # 34
    assert outliers(few).sum() == 28
    assert not outliers(many).any()


@pytest.mark.parametrize(
    ("sizes", "kicks"), [([0.5, 0.51, 0.49, 0.5], True), ([0.5, 0.9, 0.2, 0.7], False), ([0.5], False), ([], False)]
)
def test_spikes_of_an_input_that_are_all_of_one_size_are_kicks_of_the_controller(
    sizes: list[float], kicks: bool
) -> None:
    assert _are_kicks(np.array(sizes)) is kicks

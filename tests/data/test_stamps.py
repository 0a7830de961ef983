"""Time stamps that were rounded: even sampling is found under them, and nothing else is changed."""

import numpy as np
import pandas as pd
import pytest

from tendonlab.data import load
from tendonlab.data.stamps import grid_of

SAMPLES = np.arange(3000)


@pytest.mark.parametrize("rate", [300.0, 333.0, 333.3, 99.9])
@pytest.mark.parametrize("offset", [0.0, 1760.0, 1.7e9])
def test_even_sampling_is_found_under_whole_milliseconds(rate, offset):
    """A tenth of the samples is lost, a hundred of them in a row."""
    kept = (np.random.default_rng(1).random(len(SAMPLES)) > 0.1) & ~((SAMPLES > 1500) & (SAMPLES <= 1600))
    kept[0] = True
    grid = grid_of(offset + np.round(1e3 * SAMPLES[kept] / rate) / 1e3)
    assert grid.rounding == pytest.approx(1e-3)
    assert grid.period == pytest.approx(1.0 / rate, abs=1e-3 / len(SAMPLES))  # the rounding over the record's length
    np.testing.assert_array_equal(grid.numbers, SAMPLES[kept])


def test_even_sampling_is_found_under_stamps_nearly_as_coarse_as_its_period():
    grid = grid_of(np.round(1e3 * SAMPLES / 700.0) / 1e3)
    assert grid.period == pytest.approx(1.0 / 700.0, abs=1e-3 / len(SAMPLES))
    np.testing.assert_array_equal(grid.numbers, SAMPLES)


@pytest.mark.parametrize(
    "time",
    [
        SAMPLES * 0.002,
        1.7e9 + SAMPLES * 0.002,
        np.round(SAMPLES / 333.0, 6),  # the rounding is a three thousandth of the period
        SAMPLES / 333.0,
        np.delete(SAMPLES, slice(70, 90)) * 0.01,
        np.round(np.cumsum(np.random.default_rng(2).uniform(2.5, 4.2, 3000))) / 1e3,  # no clock
        np.round(1e3 * (SAMPLES / 300.0 + np.random.default_rng(3).uniform(-0.8e-3, 0.8e-3, 3000))) / 1e3,
        np.array([0.0, 0.003, 0.007, 0.010]),  # too few to tell
    ],
)
def test_stamps_that_are_even_fine_or_truly_uneven_stay(time):
    assert grid_of(time) is None


def test_a_dataset_says_which_experiments_got_their_even_steps_back(draft, write):
    """Two experiments at 300 Hz, one of them stamped in whole milliseconds."""
    num = np.arange(200)
    for name, stamps in (("one.csv", np.round(1e3 * num / 300.0)), ("two.csv", 1e3 * num / 300.0)):
        u = np.sin(0.05 * num)
        draft.frames[name] = pd.DataFrame({"t": stamps, "u": u, "q": u, "dq": u})
    draft.toml["time"] = {"column": "t", "unit": "ms"}
    found = load(write(draft))
    np.testing.assert_allclose(found["one"].time, num / 300.0, atol=1e-3)
    assert np.ptp(np.diff(found["one"].time)) < 1e-12
    np.testing.assert_array_equal(found["two"].time, draft.frames["two.csv"]["t"].to_numpy() * 1e-3)
    assert found["one"].data.index.name == "t"
    (warning,) = found.warnings
    assert warning.startswith("the time stamps of one are rounded to 0.001 s, and fit samples taken every 0.003333 s")

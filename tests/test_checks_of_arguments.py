"""What every procedure refuses, told by name: text, masks, rows of unequal lengths, seeds that cannot be repeated."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tendonlab import procedures
from tendonlab.arguments import reals, samples, within
from tendonlab.errors import ParameterError, nearest_name
from tendonlab.seed import generator

TIME = np.arange(0.0, 1.0, 0.01)
SWING = np.sin(6.0 * TIME)
MARKERS = np.array([[0.0, 0.0], [0.1, 0.01], [0.2, 0.04], [0.3, 0.09]])


@pytest.mark.parametrize("value", ["1", True, None, [1.0], 1j, "one", float("nan")])
def test_a_number_is_no_text_and_no_row(value: Any) -> None:
    with pytest.raises(ParameterError, match=re.escape(f"cutoff = {value!r}: expected a value in (0, inf) Hz")):
        within("cutoff", value, 0.0, np.inf, "Hz", open_lower=True)


@pytest.mark.parametrize("value", [2, 2.0, np.float32(2.0), np.int16(2), np.array(2.0)])
def test_a_number_may_be_of_any_kind(value: Any) -> None:
    assert within("order", value, 0.0, 3.0) == 2.0


@pytest.mark.parametrize(
    ("values", "told"),
    [
        (np.ma.masked_array([1.0, 2.0, 3.0], mask=[False, True, False]), "load[1] is masked"),
        ([[1.0], [1.0, 2.0]], "load holds rows of unequal lengths"),
        (["a", "b"], "load holds <U1"),
        (np.array([1.0 + 1.0j]), "load holds complex128"),
        ([1.0, None], "load[1] = nan"),
        ([], "load has 0 samples"),
        ([[1.0], [2.0]], "load has shape (2, 1)"),
    ],
)
def test_a_row_of_samples_is_told_what_it_is_not(values: Any, told: str) -> None:
    with pytest.raises(ParameterError, match=re.escape(told)):
        samples("load", values)


@pytest.mark.parametrize(("name", "nearest"), [("run-1", "run-01"), ("run1", "run-01"), ("run-010", "run-10")])
def test_the_nearest_name_has_the_same_number(name: str, nearest: str) -> None:
    assert nearest_name(name, [f"run-{k:02d}" for k in range(1, 13)]) == nearest


def test_a_mask_that_hides_nothing_is_no_matter() -> None:
    np.testing.assert_array_equal(reals("load", np.ma.masked_array([1.0, 2.0], mask=False)), [1.0, 2.0])


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: procedures.lowpass(SWING, cutoff="20", sample_rate=100.0), "cutoff = '20'"),
        (lambda: procedures.velocity(TIME, SWING, method=None), "method = None"),
        (lambda: procedures.jumps(TIME, SWING, threshold="1"), "threshold = '1'"),
        (lambda: procedures.LoadCell(gain="2"), "gain = '2'"),
        (lambda: procedures.MapPoint("1", 0.1, 0.0, 5), "speed = '1'"),
        (lambda: procedures.MapPoint(1.0, np.inf, 0.0, 5), "torque = inf"),
        (lambda: procedures.MapPoint(1.0, 0.1, 0.0, 0), "num_samples = 0"),
        (lambda: procedures.pretension_from_load_cells("54", 54.0), "reading_in holds"),
        (lambda: procedures.Shape(["a", "b"], [0.0, 1.0]), "arc_length holds"),
        (lambda: procedures.Shape.even("1", length=1.0), "wrap_angle = '1'"),
        (lambda: procedures.Shape.skewed(1.0, length=1.0, skew="0"), "skew = '0'"),
        (lambda: procedures.Shape.even(1.0, length=1.0, num_samples=1.5), "num_samples = 1.5"),
        (lambda: procedures.MarkerSpline("abc"), "points holds"),
        (lambda: procedures.MarkerSpline(MARKERS, smoothing="1"), "smoothing = '1'"),
        (lambda: procedures.MarkerSpline(MARKERS, kind=3), "kind = 3"),
        (lambda: procedures.wrap_angle_uncertainty(MARKERS, marker_sd=1e-3), "expected a MarkerSpline"),
    ],
)
def test_what_is_given_is_named(call: Callable[[], Any], told: str) -> None:
    with pytest.raises(ParameterError, match=re.escape(told)):
        call()


@pytest.mark.parametrize("seed", [-1, 1.5, "3", None, True, float("nan")])
def test_a_seed_is_a_whole_number(seed: Any) -> None:
    with pytest.raises(ParameterError, match=r"seed = .*: expected a whole number of at least 0"):
        procedures.split(10, contiguous=False, seed=seed)


def test_a_seed_may_be_a_generator() -> None:
    rng = np.random.default_rng(3)
    assert generator(rng) is rng
    assert generator(3).random() == rng.random()

"""Markers of a sheath to its shape: order, noise, rules, and a dataset that states shapes as marker files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.errors import DatasetError, ParameterError
from tendonlab.papers.s3 import paper_shape
from tendonlab.procedures import MarkerSpline, sort_markers, wrap_angle_uncertainty

BUMP = paper_shape(6)


def test_markers_are_sorted_from_the_drive_on() -> None:
    markers = BUMP.markers(15)
    mixed = markers[np.random.default_rng(0).permutation(15)]
    np.testing.assert_array_equal(sort_markers(mixed, proximal=markers[0]), markers)
    np.testing.assert_array_equal(sort_markers(mixed, proximal=np.array([1.0, 0.0])), markers[::-1])


def test_a_straight_sheath_does_not_turn() -> None:
    line = np.column_stack([np.linspace(0.0, 0.5, 7), np.full(7, 0.1), np.linspace(0.0, 0.2, 7)])
    spline = MarkerSpline(line)
    for rule in ("left", "trapezoid", "turning"):
        assert spline.wrap_angle(rule=rule) == pytest.approx(0.0, abs=1e-6)
    assert spline.arc_length()[-1] == pytest.approx(np.hypot(0.5, 0.2), rel=1e-12)


def test_a_plane_curve_in_space_turns_as_much() -> None:
    flat = BUMP.markers(15)
    tilted = np.column_stack([flat[:, 0], 0.6 * flat[:, 1], 0.8 * flat[:, 1]])
    assert MarkerSpline(tilted).wrap_angle() == pytest.approx(MarkerSpline(flat).wrap_angle(), rel=1e-10)


@pytest.mark.parametrize("parameter", ["index", "chord"])
def test_the_shape_is_what_the_model_takes(parameter: str) -> None:
    shape = MarkerSpline(BUMP.markers(15), parameter=parameter).shape(rule="turning")
    assert shape.wrap_angle == pytest.approx(BUMP.wrap_angle, rel=0.01)
    assert shape.length == pytest.approx(0.8, rel=1e-3)


def mean_error(num_markers: int, noise_sd: float, smoothing: float = 0.0) -> float:
    angles = [
        MarkerSpline(BUMP.markers(num_markers, noise_sd=noise_sd, seed=k), smoothing=smoothing).wrap_angle()
        for k in range(30)
    ]
    return float(np.mean(angles)) / BUMP.wrap_angle - 1.0


def test_more_noisy_markers_make_an_interpolating_spline_worse() -> None:
    """1 mm of noise: 2 % too much from 15 markers, 31 % from 30 of them; smoothing repairs it."""
    assert mean_error(15, 0.0) == pytest.approx(0.0074, abs=5e-4)
    few, many = mean_error(15, 1e-3), mean_error(30, 1e-3)
    assert 0.01 < few < 0.04
    assert 0.2 < many < 0.4
    assert abs(mean_error(30, 1e-3, smoothing=1e-3)) < 0.02


def test_uncertainty_by_resampling() -> None:
    """As large as the scatter and the bias over fresh noise."""
    found = wrap_angle_uncertainty(MarkerSpline(BUMP.markers(30)), marker_sd=5e-4, num_resamples=60)
    angles = [MarkerSpline(BUMP.markers(30, noise_sd=5e-4, seed=k)).wrap_angle() for k in range(60)]
    assert found.sd == pytest.approx(np.std(angles, ddof=1), rel=0.35)
    assert found.bias == pytest.approx(np.mean(angles) - found.value, rel=0.35)
    again = wrap_angle_uncertainty(MarkerSpline(BUMP.markers(30)), marker_sd=5e-4, num_resamples=60)
    assert again == found


def test_bad_markers_are_named() -> None:
    markers = BUMP.markers(6)
    with pytest.raises(DatasetError, match="markers 1 and 4 lie at one place"):
        MarkerSpline(markers[[0, 1, 2, 3, 1, 5]])
    with pytest.raises(DatasetError, match="at least 4 finite rows"):
        MarkerSpline(markers[:3])
    with pytest.raises(ParameterError, match="rule = 'simpson'"):
        MarkerSpline(markers).wrap_angle(rule="simpson")
    with pytest.raises(ParameterError, match="smoothing = -1"):
        MarkerSpline(markers, smoothing=-1.0)
    with pytest.raises(ParameterError, match="kind = 'clamped'"):
        MarkerSpline(markers, kind="clamped")


TOML = """
format = "tendonlab-dataset/1"
name = "pair"
[system]
kind = "bowden_pair"
[system.parameters]
friction_coefficient = { value = 0.056 }
static_friction_coefficient = { value = 0.062, sd = 0 }
stribeck_velocity = { value = 0.01, sd = 0 }
threshold_velocity = { value = 0.05 }
threshold_slope = { value = 5000.0, sd = 0 }
input_radius = { value = 0.05, sd = 0 }
output_radius = { value = 0.05, sd = 0 }
sheath_length = { value = 0.8, sd = 0 }
cable_stiffness = { value = 1e5, sd = 0 }
pretension = { value = 264.8, sd = 0 }
wrap_angle = { value = 3.6, sd = 0 }
[signals.input_torque]
column = "tau"
unit = "N*m"
[signals.input_velocity]
column = "v"
unit = "deg/s"
[signals.output_torque]
column = "out"
unit = "N*m"
[[experiments]]
name = "one"
file = "one.csv"
split = "train"
conditions = { pretension = 200.0, shape = "sheath.csv" }
"""


def write(folder: Path, toml: str = TOML) -> Path:
    t = np.arange(200) / 100.0
    table = {"t": t, "tau": np.sin(t), "v": 10.0 * np.cos(t), "out": 0.5 * np.sin(t)}
    pd.DataFrame(table).to_csv(folder / "one.csv", index=False)
    pd.DataFrame(BUMP.markers(15), columns=["x", "y"]).to_csv(folder / "sheath.csv", index=False)
    (folder / "dataset.toml").write_text(toml, encoding="utf-8")
    return folder


def test_a_dataset_may_state_the_shape_as_markers(tmp_path: Path) -> None:
    rig = tl.load(write(tmp_path))
    assert rig["one"].conditions["wrap_angle"] == MarkerSpline(BUMP.markers(15)).wrap_angle()
    assert rig["one"].conditions["pretension"] == 200.0
    assert rig["one"].data["input_velocity"].iloc[0] == pytest.approx(np.deg2rad(10.0))


def test_a_shape_beside_a_wrap_angle_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="stands beside wrap_angle"):
        tl.load(write(tmp_path, TOML.replace("shape =", "wrap_angle = 3.0, shape =")))


def test_a_shape_without_its_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"lost\.csv: no such file"):
        tl.load(write(tmp_path, TOML.replace("sheath.csv", "lost.csv")))

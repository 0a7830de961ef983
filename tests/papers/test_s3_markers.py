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
    for points in (markers[:, 0], markers[:, :1], np.tile(markers, 2), markers[None]):
        with pytest.raises(DatasetError, match="rows of x, y or x, y, z"):
            MarkerSpline(points)
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


def write(folder: Path, toml: str = TOML, markers: np.ndarray | None = None) -> Path:
    t = np.arange(200) / 100.0
    table = {"t": t, "tau": 20.0 * np.sin(t), "v": 10.0 * np.cos(t), "out": 0.5 * np.sin(t)}
    markers = BUMP.markers(15) if markers is None else markers
    pd.DataFrame(table).to_csv(folder / "one.csv", index=False)
    pd.DataFrame(markers, columns=list("xyz")[: markers.shape[1]]).to_csv(folder / "sheath.csv", index=False)
    (folder / "dataset.toml").write_text(toml, encoding="utf-8")
    return folder


def test_a_dataset_may_state_the_shape_as_markers(tmp_path: Path) -> None:
    rig = tl.load(write(tmp_path))
    assert rig["one"].conditions["wrap_angle"] == MarkerSpline(BUMP.markers(15)).wrap_angle()
    assert rig["one"].conditions["curvature_skew"] == pytest.approx(0.0, abs=1e-3)
    assert rig["one"].conditions["pretension"] == 200.0
    assert rig["one"].data["input_velocity"].iloc[0] == pytest.approx(np.deg2rad(10.0))


def quarter_turn_at_the_end(num_markers: int = 40) -> np.ndarray:
    """0.6 m straight, then 90° on 0.2 m, lifted out of the plane: in space, (n, 3)."""
    s = np.linspace(0.0, 0.8, num_markers)
    radius = 0.2 / (np.pi / 2)
    angle = np.maximum(s - 0.6, 0.0) / radius
    x, y = np.minimum(s, 0.6) + radius * np.sin(angle), radius * (1.0 - np.cos(angle))
    return np.column_stack([x, 0.6 * y, 0.8 * y])


def test_a_shape_bent_near_the_load_loses_more_than_one_bent_near_the_drive(tmp_path: Path) -> None:
    """From the folder to the simulator: both turn by 90°, but K_in and the offset differ (S3 eq. 18)."""
    output = {}
    for order in (1, -1):
        rig = tl.load(write(tmp_path, markers=quarter_turn_at_the_end()[::order]))
        conditions = rig["one"].conditions
        assert conditions["wrap_angle"] == pytest.approx(np.pi / 2, rel=0.02)
        assert conditions["curvature_skew"] == pytest.approx(order * 2.25, abs=0.05)  # 3 (1 - 2/8): a kink is smoothed
        run = rig.system().simulate(rig["one"])
        output[order] = run.outputs["output_torque"].to_numpy()[60:100]  # 20 N·m sin(t), sliding
    x = 0.056 * np.pi / 2
    middle = 20.0 * np.sin(np.arange(60, 100) / 100.0)
    wanted = middle * x**2 * 2.25 / 3 - 2 * 0.1 * 200.0 * x**2 / 2 * 2.25 / 3  # leading order of both
    np.testing.assert_allclose(output[1] - output[-1], wanted, rtol=0.1)


def test_noise_of_markers_is_smoothed_where_it_is_stated(tmp_path: Path) -> None:
    """30 markers with 1 mm of noise: a third too much turn as they are, 2 % once the noise is known."""
    noisy = BUMP.markers(30, noise_sd=1e-3, seed=1)
    plain = tl.load(write(tmp_path, markers=noisy))["one"].conditions["wrap_angle"]
    stated = tl.load(write(tmp_path, TOML.replace("shape =", "marker_sd = 1e-3, shape ="), noisy))["one"].conditions
    assert plain > 1.15 * BUMP.wrap_angle
    assert stated["wrap_angle"] == pytest.approx(BUMP.wrap_angle, rel=0.04)


@pytest.mark.parametrize(
    ("toml", "told"),
    {
        "beside its angle": (TOML.replace("shape =", "wrap_angle = 3.0, shape ="), "given together with wrap_angle"),
        "beside its skew": (
            TOML.replace("shape =", "curvature_skew = 0.1, shape ="),
            "given together with curvature_skew",
        ),
        "no file": (TOML.replace("sheath.csv", "lost.csv"), r"lost\.csv: no such file"),
        "no name": (TOML.replace('"sheath.csv"', "3"), "shape"),
        "a negative noise": (TOML.replace("shape =", "marker_sd = -1.0, shape ="), "marker_sd"),
    }.values(),
)
def test_a_shape_that_cannot_be_read_is_refused(toml: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=told):
        tl.load(write(tmp_path, toml))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("x,y\n0,0\n1,0\n2,1\n", r"sheath\.csv: markers of shape \(3, 2\): expected at least 4"),
        ("x,y\n0,0\n1,0\n1,0\n2,1\n3,1\n", r"sheath\.csv: markers 1 and 2 lie at one place"),
        ("x,z\n0,0\n1,0\n2,1\n3,1\n", r"sheath\.csv.*'y'"),
        ("x,y\n0,0\n1,a\n2,1\n3,1\n", r"sheath\.csv.*row 3"),
        ("x,y\n0,0\n1,\n2,1\n3,1\n", r"sheath\.csv: markers.*finite"),
    ],
)
def test_markers_without_a_curve_are_refused(text: str, told: str, tmp_path: Path) -> None:
    folder = write(tmp_path)
    (folder / "sheath.csv").write_text(text, encoding="utf-8")
    with pytest.raises(DatasetError, match=told):
        tl.load(folder)

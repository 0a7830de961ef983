"""Figures draw on the axes they are given, show nothing, and label what they draw with units."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from tendonlab.errors import ParameterError
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.report.figures import draw_all, shown_runs
from tendonlab.report.plot import gap_bars, overlay, ranked_effects, where_map
from tendonlab.report.plot.runs import telling_window

matplotlib.use("Agg")


@pytest.fixture(autouse=True)
def shows_nothing(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    from matplotlib import pyplot

    monkeypatch.setattr(pyplot, "show", lambda *args, **options: pytest.fail("show was called"))
    yield
    pyplot.close("all")


@pytest.mark.parametrize("draw", [gap_bars, ranked_effects])
def test_draws_on_the_axes_given(diagnosis: Diagnosis, draw: object) -> None:
    from matplotlib import pyplot

    ax = Figure().subplots()
    assert draw(diagnosis, ax) is ax  # type: ignore[operator]
    assert ax.get_xlabel()
    assert ax.get_ylabel()
    assert pyplot.get_fignums() == []


@pytest.mark.parametrize("draw", [gap_bars, ranked_effects, Diagnosis.plot])
def test_makes_axes_where_none_are_given(with_effect: Diagnosis, draw: object) -> None:
    from matplotlib import pyplot

    ax = draw(with_effect)  # type: ignore[operator]
    assert [ax.get_figure().number] == pyplot.get_fignums()


def test_bars_have_the_length_of_the_gap_over_its_floor(with_effect: Diagnosis) -> None:
    ax = gap_bars(with_effect, Figure().subplots())
    ends = sorted(round(bar.get_x() + bar.get_width(), 6) for bar in ax.patches)
    assert ends == pytest.approx(sorted([52.5, 23.0, 1.225, 31.0, 22.0, 1.3]))  # by hand, from the gap in conftest
    assert ax.get_xscale() == "log"
    assert "31 mrad" in {text.get_text() for text in ax.texts}


def test_small_gaps_stay_on_a_linear_axis(with_effect: Diagnosis) -> None:
    gap = {"joint_angle": {"noise_floor": 1.0, "nominal": 3.0, "refitted": 2.0, "with_effect": 0.9}}
    assert gap_bars(replace(with_effect, gap=gap), Figure().subplots()).get_xscale() == "linear"


def test_an_output_without_a_floor_is_left_out(with_effect: Diagnosis) -> None:
    gap = {"joint_angle": {"noise_floor": 0.0, "nominal": 3.0, "refitted": 2.0, "with_effect": 0.9}}
    assert len(gap_bars(replace(with_effect, gap=gap), Figure().subplots()).patches) == 0


def test_overlay_has_points_lines_and_a_floor_band(with_effect: Diagnosis) -> None:
    pair = tuple(Figure().subplots(2, 1))
    upper, lower = overlay(with_effect, pair, signal="joint_angle", window=(2.0, 6.0))
    assert (upper, lower) == pair
    points, *lines = upper.lines
    assert points.get_linestyle() == "None"
    assert [line.get_label() for line in lines] == ["Nominal", "Refitted", "With effect"]
    assert all(line.get_xdata().min() >= 2.0 and line.get_xdata().max() <= 6.0 for line in upper.lines)
    assert upper.get_ylabel() == "Joint angle (rad)"
    assert lower.get_ylabel() == "Residual\n(mrad)"
    assert len(lower.patches) == 1


def test_lines_keep_the_peaks_when_thinned(with_effect: Diagnosis) -> None:
    (run,) = with_effect.overlays
    spiked = run.refitted["joint_angle"].copy()
    spiked[777] = 5.0
    changed = replace(with_effect, overlays=(replace(run, refitted={**run.refitted, "joint_angle": spiked}),))
    upper, _ = overlay(changed, tuple(Figure().subplots(2, 1)), signal="joint_angle")
    assert max(line.get_ydata().max() for line in upper.lines if line.get_label() == "Refitted") == 5.0


def test_without_a_selected_effect_its_line_is_not_drawn(with_effect: Diagnosis) -> None:
    upper, _ = overlay(replace(with_effect, selected=()), tuple(Figure().subplots(2, 1)))
    assert "With effect" not in [line.get_label() for line in upper.lines]


def test_every_held_out_run_can_be_drawn_with_its_inputs(with_effect: Diagnosis) -> None:
    (run,) = with_effect.overlays
    push = np.where(run.time < 6.0, 0.5, -2.0)
    two = (run, replace(run, name="push", inputs={"motor_torque": push}))
    drawn = draw_all(replace(with_effect, overlays=two, units={**with_effect.units, "motor_torque": "N*m"}))
    assert {"overlay", "overlay-2"} <= set(drawn)
    assert len(drawn["overlay"].figure.axes) == 2 * len(run.measured)
    *_, last = drawn["overlay-2"].figure.axes
    assert (last.get_ylabel(), last.get_xlabel()) == ("Motor torque\n(N·m)", "Time (s)")
    assert set(last.lines[0].get_ydata()) == {0.5, -2.0}
    upper, _ = overlay(replace(with_effect, overlays=two), tuple(Figure().subplots(2, 1)), experiment="push")
    assert upper.get_ylabel().startswith("Motor angle")


def test_at_most_twelve_held_out_runs_are_drawn(with_effect: Diagnosis) -> None:
    (run,) = with_effect.overlays
    many = tuple(replace(run, name=f"run-{place}") for place in range(14))
    assert [one.name for one in shown_runs(replace(with_effect, overlays=many))] == [f"run-{k}" for k in range(12)]


def test_overlay_names_what_is_missing(with_effect: Diagnosis) -> None:
    with pytest.raises(ParameterError, match="signal = 'torque': expected one of motor_angle, joint_angle"):
        overlay(with_effect, signal="torque")
    with pytest.raises(ParameterError, match="experiment = 'jump': expected one of swing-7"):
        overlay(with_effect, experiment="jump")
    with pytest.raises(ParameterError, match="overlays: none"):
        overlay(replace(with_effect, overlays=()))


def test_a_long_run_is_cut_to_where_the_refitted_residual_is_large(with_effect: Diagnosis) -> None:
    (run,) = with_effect.overlays
    assert telling_window(run) is None
    time = np.arange(0.0, 100.0, 0.01)
    swing = np.sin(2 * np.pi * time)
    worse = swing + 0.3 * ((time > 60) & (time < 65))
    one = {"measured": swing, "nominal": worse, "refitted": worse, "with_effect": swing}
    window = telling_window(
        replace(run, time=time, **{stage: {"joint_angle": values} for stage, values in one.items()})
    )
    assert window is not None
    assert window[0] <= 60.0
    assert window[1] >= 64.9
    assert window[1] - window[0] == pytest.approx(10.0, rel=0.1)  # 20 crossings of a swing of 1 Hz


def test_where_map_shares_one_scale_and_leaves_empty_cells(with_effect: Diagnosis) -> None:
    (where,) = with_effect.where_map
    axes = [where_map(where, Figure().subplots(), stage=stage) for stage in ("refitted", "with_effect")]
    meshes = [ax.collections[0] for ax in axes]
    assert meshes[0].get_clim() == meshes[1].get_clim()
    assert meshes[0].get_clim()[0] == 1.0
    assert np.ma.count_masked(meshes[0].get_array()) == np.isnan(where.refitted).sum()
    assert axes[0].get_xlabel() == "Joint velocity (rad/s)"
    with pytest.raises(ParameterError, match="stage = 'nominal'"):
        where_map(where, stage="nominal")


def test_new_axes_of_a_where_map_have_a_colour_bar(with_effect: Diagnosis) -> None:
    ax = where_map(with_effect.where_map[0])
    assert [other.get_ylabel() for other in ax.get_figure().axes if other is not ax] == ["RMS residual / noise floor"]


def test_svg_keeps_text_as_text(diagnosis: Diagnosis) -> None:
    pictures = draw_all(diagnosis)
    assert ("overlay" in pictures) is bool(diagnosis.overlays)
    assert "Held-out RMS error / noise floor" in pictures["gap"].svg
    assert all(picture.png.startswith(b"\x89PNG") for picture in pictures.values())


def test_matplotlib_is_not_loaded_before_it_is_needed() -> None:
    code = "import sys, tendonlab.report.plot, tendonlab.report.diagnosis; print('matplotlib' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_what_is_ruled_out_is_not_drawn(with_effect: Diagnosis) -> None:
    ax = ranked_effects(with_effect, Figure().subplots())
    assert len(ax.patches) == 3  # the fourth, a delay, has a probability of 0.002


def test_the_likeliest_elements_have_their_maps_drawn(with_effect: Diagnosis) -> None:
    (joint,) = with_effect.where_map
    maps = tuple(replace(joint, element=name, place=name) for name in ("motor", "contact", "joint"))
    drawn = draw_all(replace(with_effect, where_map=maps))["where"].svg
    assert drawn.index("Joint, refitted") < drawn.index("Contact, refitted")
    assert "Motor, refitted" not in drawn

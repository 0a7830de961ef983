"""The curves of S0: stiffness (Figs 4, 5), a run (7), maps (10 to 18), models and their errors (19 to 24).

Points are the twin's maps, reconstructed; lines are models."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from tendonlab.papers.s0.bench import LOADS, Configuration, configuration, loaded
from tendonlab.papers.s0.drive import torsional_stiffness
from tendonlab.papers.s0.maps import FINE, absolute_error
from tendonlab.papers.s0.runs import torque_of
from tendonlab.procedures import steady_segment, velocity, wavelet_denoise

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Model = Callable[[Configuration, np.ndarray], np.ndarray]
COLOURS = {"none": "#1b1f24", "D": "#0072b2", "D2M": "#d55e00", "D4M": "#009e73"}
WORDS = {"none": "no load", "D": "disc", "D2M": "disc and 2 masses", "D4M": "disc and 4 masses"}
HIGHEST = 0.26  # N·m, top of Figs 10 to 16: one scale for all
MARKS = ("o", "s", "^", "D")
SHOWN = 5  # draw every fifth sample of a run: the eye sees no more
SPEED, TORQUE, ERROR = "input speed (rad/s)", "friction torque (N·m)", "absolute error (N·m)"


def stiffness_against_torque(
    ax: Axes, of: Configuration, *, pretensions: Sequence[float] = (60, 100, 150, 200)
) -> Axes:
    """Fig. 4: stiffness falls with the torque transmitted."""
    for pretension in pretensions:
        torque = np.linspace(0.0, 0.9 * pretension * of.pulley.diameter, 60)
        k = [torsional_stiffness(of, load_torque=t, pretension=pretension) for t in torque]
        ax.plot(torque, k, label=f"{pretension:g} N")
    ax.set(xlabel="transmitted torque (N·m)", ylabel="torsional stiffness (N·m/rad)")
    ax.set_title("Fig. 4  Stiffness against torque (reconstructed)")
    ax.legend(title="preload")
    return ax


def stiffness_against_preload(ax: Axes, of: Configuration, *, torques: Sequence[float] = (1, 2, 5, 8)) -> Axes:
    """Fig. 5: stiffness rises with the preload."""
    for torque in torques:
        pretension = np.linspace(1.05 * torque / of.pulley.diameter, 250.0, 80)
        k = [torsional_stiffness(of, load_torque=torque, pretension=t) for t in pretension]
        ax.plot(pretension, k, label=f"{torque:g} N·m")
    ax.set(
        xlabel="preload (N)",
        ylabel="torsional stiffness (N·m/rad)",
        title="Fig. 5  Stiffness against preload (reconstructed)",
    )
    ax.set_ylim(bottom=0)
    ax.legend(title="torque", loc="lower right", ncols=2)
    return ax


def run_figure(axes: tuple[Axes, Axes], run: pd.DataFrame) -> None:
    """Fig. 7: angle and reactive torque of a run; the box marks the steady part that gives the map point."""
    time = run.index.to_numpy(dtype=float)
    angle, torque = run["input_angle"].to_numpy(), torque_of(run)
    kept = steady_segment(time, angle)
    speed = velocity(time, wavelet_denoise(angle, level=None))
    axes[0].plot(time[::SHOWN], angle[::SHOWN], color=COLOURS["D"], label="angle")
    axes[0].set(ylabel="input angle (rad)", title="Fig. 7  A run at 1000 rpm without load (twin)")
    beside = axes[0].twinx()
    beside.plot(time[::SHOWN], speed[::SHOWN], color=COLOURS["D2M"], lw=0.9)
    beside.set_ylabel("input speed (rad/s)", color=COLOURS["D2M"])
    axes[1].plot(time, torque, ".", ms=1.5, color="0.55", rasterized=True, label="from the load cells")
    mean = float(torque[kept].mean())
    axes[1].plot(time[[kept.start, kept.stop - 1]], [mean, mean], color="k", label=f"mean {mean:.4f} N·m")
    axes[1].set(xlabel="time (s)", ylabel="reactive torque (N·m)")
    axes[1].legend(loc="lower left")
    for ax in axes:
        ax.axvspan(time[kept.start], time[kept.stop - 1], color="0.9", zorder=0)


def draw_map(ax: Axes, points: pd.DataFrame, *, label: str, color: str, mark: str = "o") -> None:
    """Points of a map with the sd of their mean."""
    error = points["sd"] / np.sqrt(points["num_runs"])
    ax.errorbar(points["speed"], points["torque"], error, fmt=mark, ms=3.5, lw=0.8, color=color, label=label)


def compare_maps(ax: Axes, maps: Mapping[str, pd.DataFrame], *, title: str) -> Axes:
    """Figs 10 to 16: maps of several configurations on one pair of axes, in the positive direction."""
    for (name, points), color, mark in zip(maps.items(), COLOURS.values(), MARKS, strict=False):
        draw_map(ax, points[points["speed"] > 0], label=name, color=color, mark=mark)
    ax.set(xlabel=SPEED, ylabel=TORQUE, title=title, ylim=(0, HIGHEST))
    ax.legend(loc="lower right")
    return ax


def difference_of_maps(ax: Axes, first: pd.DataFrame, second: pd.DataFrame, *, label: str) -> Axes:
    """Below Figs 10 to 12: the `second` map less the `first`, in the positive direction, with the sd of both means."""
    one, other = (of[of["speed"] > 0] for of in (first, second))
    spread = np.hypot(*(of["sd"].to_numpy() / np.sqrt(of["num_runs"].to_numpy()) for of in (one, other)))
    apart = other["torque"].to_numpy() - one["torque"].to_numpy()
    ax.axhline(0.0, color="0.8", lw=0.8)
    ax.errorbar(one["speed"], 1e3 * apart, 1e3 * spread, fmt="o", ms=3, lw=0.8, color=COLOURS["D2M"])
    ax.set(xlabel=SPEED, ylabel=label)
    return ax


def loads_of(ax: Axes, transmission: str, maps: Mapping[str, pd.DataFrame], *, title: str) -> Axes:
    """Figs 17, 18: one transmission under its four loads, both directions."""
    for load, mark in zip(LOADS, MARKS, strict=True):
        name = loaded(transmission, load).name
        draw_map(ax, maps[name], label=WORDS[load], color=COLOURS[load], mark=mark)
    ax.set(xlabel=SPEED, ylabel=TORQUE, title=title)
    ax.legend()
    return ax


def curve_and_map(ax: Axes, name: str, points: pd.DataFrame, model: Model, *, label: str, title: str) -> Axes:
    """Figs 19, 22: a model over the map of one configuration."""
    draw_map(ax, points, label="map (twin)", color=COLOURS["none"])
    both = np.concatenate([-FINE[::-1], FINE])
    ax.plot(both, model(configuration(name), both), color=COLOURS["D2M"], label=label)
    ax.set(xlabel=SPEED, ylabel=TORQUE, title=title)
    ax.legend(loc="lower right")
    return ax


def errors_of(ax: Axes, transmission: str, maps: Mapping[str, pd.DataFrame], model: Model, *, title: str) -> Axes:
    """Figs 20, 21, 23, 24: absolute error of a model against speed, by load."""
    for load, mark in zip(LOADS, MARKS, strict=True):
        of = loaded(transmission, load)
        points = maps[of.name]
        error = absolute_error(of, model, points[points["speed"] > 0])
        ax.plot(error.index, error, marker=mark, ms=3, lw=0.9, color=COLOURS[load], label=WORDS[load])
    ax.set(xlabel=SPEED, ylabel=ERROR, title=title)
    ax.set_ylim(0, 1.35 * ax.get_ylim()[1])
    ax.legend(ncols=2, loc="upper center")
    return ax

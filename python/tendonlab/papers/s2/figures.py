"""Figures 9 to 12 of S2 on the axes they are given; points are synthetic, curves are the identified models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from tendonlab import _core
from tendonlab.papers.s2.equations import Array
from tendonlab.papers.s2.estimate import Estimate
from tendonlab.papers.s2.identify import bushing_law
from tendonlab.papers.s2.values import Constants
from tendonlab.report.plot.style import COLOURS, INK, MUTED, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RED, BLUE, GREY = COLOURS["with_effect"], COLOURS["refitted"], COLOURS["nominal"]
THINNED, DOTS = 10, 3  # draw every tenth sample of a smooth curve, every third of a noisy one: the eye sees no more


def draw_gear(axes: Sequence[Axes], points: pd.DataFrame, fit: Estimate, printed: Constants) -> Sequence[Axes]:
    """Fig. 9: motor torque against motor speed, mean and sd of each set point, and the fitted arctangent; below, what
    lies above the fit; on two axes."""
    ax, left = axes
    speed = np.linspace(points["speed"].min(), points["speed"].max(), 301)
    of = _core.friction.Arctan
    fitted = of(friction=fit["alpha"], friction_slope=fit["beta"]).force(velocity=speed)
    known = of(friction=printed.alpha, friction_slope=printed.beta).force(velocity=speed)
    at_points = of(friction=fit["alpha"], friction_slope=fit["beta"]).force(velocity=points["speed"].to_numpy())
    mean, spread = 1e3 * points["torque_mean"], 1e3 * points["torque_std"]
    ax.errorbar(
        points["speed"], mean, spread, fmt="o", ms=3, lw=0.8, color=INK, label="set points (synthetic), mean and sd"
    )
    ax.plot(speed, 1e3 * fitted, color=BLUE, label=r"fit, $\alpha\,\arctan(\beta\omega)$")
    ax.plot(speed, 1e3 * known, color=RED, ls="--", lw=1.0, label="Table II")
    left.errorbar(points["speed"], mean - 1e3 * at_points, spread, fmt="o", ms=3, lw=0.8, color=INK)
    left.plot(speed, 1e3 * (known - fitted), color=RED, ls="--", lw=1.0)
    left.axhline(0.0, color=BLUE)
    ax.set(ylabel="motor torque (mN·m)", title="Fig. 9  Friction of the harmonic gear (synthetic points)")
    left.set(xlabel=r"motor speed $\omega$ (rad/s)", ylabel="less the fit (mN·m)")
    ax.legend()
    for one in axes:
        tidy(one)
    return axes


def draw_cable(axes: Sequence[Axes], ramps: pd.DataFrame, fit: Estimate) -> Sequence[Axes]:
    """Fig. 10: force of one cable, measured and estimated, and the residual, against time; on two axes."""
    estimated = fit["F_0"] + fit["K"] * ramps["elongation"] + fit["c"] * ramps["rate"]
    axes[0].plot(ramps.index, ramps["force"], ".", ms=1.5, color=INK, rasterized=True, label="measured (synthetic)")
    axes[0].plot(ramps.index, estimated, color=BLUE, lw=1.0, label="estimated")
    axes[1].plot(ramps.index, ramps["force"] - estimated, ".", ms=1.5, color=MUTED, rasterized=True)
    axes[0].set(ylabel="cable force (N)", title="Fig. 10  Stiffness and damping of the cable (synthetic points)")
    axes[1].set(xlabel="time (s)", ylabel="residual (N)")
    axes[0].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    for ax in axes:
        tidy(ax)
    return axes


def draw_branches(
    axes: Sequence[Axes], loop: pd.DataFrame, branches: Mapping[str, float], *, tension: float, cable: int
) -> Sequence[Axes]:
    """Fig. 11: force of a cable in its bushing against the joint angle, the loop and the four branches of eq. 11;
    below, what lies above the branches; on two axes."""
    ax, left = axes
    ax.plot(loop["theta"], loop["force"], ".", ms=4, color=MUTED, rasterized=True, label="loop (twin)")
    law = bushing_law(branches)
    for sense, colour, text in ((1.0, BLUE, "v > 0"), (-1.0, RED, "v < 0")):
        i = 1 if sense > 0 else 2
        theta = np.sort(np.append(np.linspace(loop["theta"].min(), loop["theta"].max(), 300), branches[f"c{i}"]))
        ax.plot(theta, law.force(velocity=sense, wrap_angle=theta, load=tension), color=colour, lw=1.6, label=text)
        edge = branches[f"c{i}"]
        meets = law.force(velocity=sense, wrap_angle=edge, load=tension)
        ax.plot(edge, meets, "o", mfc="white", mec=colour, ms=5)
        ax.annotate(f"$c_{i}$", (edge, float(meets)), textcoords="offset points", xytext=(6, 5), color=colour)
        one = loop[sense * loop["velocity"] > 0]
        known = law.force(velocity=sense, wrap_angle=one["theta"].to_numpy(), load=tension)
        left.plot(one["theta"], one["force"] - known, ".", ms=3, color=colour, rasterized=True)
    left.axhline(0.0, color=INK, lw=0.6)
    ax.set(ylabel="bushing force (N)", title=f"Fig. 11  Cable {cable}, four branches")
    left.set(xlabel=r"joint angle $\theta$ (rad)", ylabel="less the\nbranches (N)")
    ax.legend(loc="lower left")
    for one_of in axes:
        tidy(one_of)
    return axes


def draw_split(ax: Axes, of: Constants, parts: Sequence[Mapping[str, np.ndarray]], theta: np.ndarray) -> Axes:
    """Friction in eq. 11 (full) and the part that only changes with the angle (dashed), for both cables."""
    for part, colour, name in zip(parts, (BLUE, RED), ("cable 1", "cable 2"), strict=True):
        ax.plot(theta, part["friction"], color=colour, label=f"{name}, friction")
        ax.plot(theta, part["common"], color=colour, ls="--", lw=1.1, label=f"{name}, common part")
    ax.axhline(0.0, color=INK, lw=0.6)
    ax.set(
        xlabel=r"joint angle $\theta$ (rad)",
        ylabel="force (N)",
        title=f"Eq. 11 split into friction and preload, T = {of.T:g} N",
    )
    ax.legend(ncols=2)
    tidy(ax)
    return ax


def draw_force(ax: Axes, measured: pd.Series[float], simulated: pd.Series[float], *, cable: int) -> Axes:
    """Fig. 12a, b: force of a cable at its nut, measured on the twin and simulated, against time."""
    _pair(ax, measured, simulated)
    ax.set(ylabel=f"cable force $F_{cable}$ (N)", title=f"Fig. 12{'ab'[cable - 1]}  Force of cable {cable} (twin)")
    return ax


def draw_difference(ax: Axes, time: pd.Index[float], error: Array, band: tuple[Array, Array], *, cable: int) -> Axes:
    """Below Fig. 12a, b: the measured force less the simulated one, N, and the band that holds 95 % of such samples."""
    ax.fill_between(time, *band, color=RED, alpha=0.35, lw=0, rasterized=True, label="95 % band of a sample")
    ax.plot(time[::DOTS], error[::DOTS], ".", ms=1, color=INK, rasterized=True)
    title = f"Fig. 12{'ab'[cable - 1]}, difference; more than 10 N in the shifts (twin)"
    ax.set(ylabel="difference (N)", ylim=(-10, 10), title=title)
    ax.legend(loc="upper right")
    tidy(ax)
    return ax


def draw_motion(ax: Axes, measured: pd.Series[float], simulated: pd.Series[float], *, letter: str) -> Axes:
    """Fig. 12c, d: velocity or angle of the joint, measured on the twin and simulated, against time."""
    _pair(ax, measured, simulated)
    what, name = ("velocity", r"$\dot\theta$ (rad/s)") if letter == "c" else ("angle", r"$\theta$ (rad)")
    ax.set(ylabel=f"joint {what} {name}", title=f"Fig. 12{letter}  Joint {what} (twin)")
    return ax


def _pair(ax: Axes, measured: pd.Series[float], simulated: pd.Series[float]) -> None:
    ax.plot(measured.index[::DOTS], measured.iloc[::DOTS], color=INK, lw=0.8, rasterized=True, label="measured (twin)")
    ax.plot(simulated.index[::THINNED], simulated.iloc[::THINNED], color=BLUE, lw=1.1, label="simulated")
    ax.legend(loc="best")
    tidy(ax)


def mark_shifts(ax: Axes, shifts: pd.DataFrame) -> Axes:
    """Mark the time between the simulated and the measured jump of a force, T_shift, on `ax`."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.18 * (high - low))
    height, above = high + 0.04 * (high - low), high + 0.07 * (high - low)
    for begin, end in zip(shifts["simulated_time"], shifts["measured_time"], strict=True):
        ax.annotate("", (end, height), (begin, height), arrowprops={"arrowstyle": "<->", "color": RED})
        ax.text(0.5 * (begin + end), above, r"$T_{shift}$", color=RED, ha="center")
    return ax

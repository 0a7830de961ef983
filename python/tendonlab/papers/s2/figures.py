"""Figures 9 to 12 of S2 on the axes they are given; points are synthetic, curves are the identified models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from tendonlab import _core
from tendonlab.papers.s2.estimate import Estimate
from tendonlab.papers.s2.identify import bushing_law
from tendonlab.papers.s2.values import Constants
from tendonlab.report.plot.style import COLOURS, INK, MUTED, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RED, BLUE, GREY = COLOURS["with_effect"], COLOURS["refitted"], COLOURS["nominal"]


def draw_gear(ax: Axes, points: pd.DataFrame, fit: Estimate, printed: Constants) -> Axes:
    """Fig. 9: motor torque against motor speed, mean and sd of each set point, and the fitted arctangent."""
    speed = np.linspace(points["speed"].min(), points["speed"].max(), 301)
    of = _core.friction.Arctan
    fitted = of(friction=fit["alpha"], friction_slope=fit["beta"]).force(velocity=speed)
    known = of(friction=printed.alpha, friction_slope=printed.beta).force(velocity=speed)
    mean, spread = 1e3 * points["torque_mean"], 1e3 * points["torque_std"]
    ax.errorbar(
        points["speed"], mean, spread, fmt="o", ms=3, lw=0.8, color=INK, label="set points (synthetic), mean and sd"
    )
    ax.plot(speed, 1e3 * fitted, color=BLUE, label=r"fit, $\alpha\,\arctan(\beta\omega)$")
    ax.plot(speed, 1e3 * known, color=RED, ls="--", lw=1.0, label="Table II")
    ax.set(
        xlabel=r"motor speed $\omega$ (rad/s)",
        ylabel="motor torque (mN m)",
        title="Fig. 9  Friction of the harmonic gear",
    )
    ax.legend()
    tidy(ax)
    return ax


def draw_cable(axes: Sequence[Axes], ramps: pd.DataFrame, fit: Estimate) -> Sequence[Axes]:
    """Fig. 10: force of one cable, measured and estimated, and the residual, against time; on two axes."""
    estimated = fit["F_0"] + fit["K"] * ramps["elongation"] + fit["c"] * ramps["rate"]
    axes[0].plot(ramps.index, ramps["force"], ".", ms=1.5, color=INK, rasterized=True, label="measured (synthetic)")
    axes[0].plot(ramps.index, estimated, color=BLUE, lw=1.0, label="estimated")
    axes[1].plot(ramps.index, ramps["force"] - estimated, ".", ms=1.5, color=MUTED, rasterized=True)
    axes[0].set(ylabel="cable force (N)", title="Fig. 10  Stiffness and damping of the cable, 200 to 500 N")
    axes[1].set(xlabel="time (s)", ylabel="residual (N)")
    axes[0].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    for ax in axes:
        tidy(ax)
    return axes


def draw_branches(ax: Axes, loop: pd.DataFrame, branches: Mapping[str, float], *, tension: float, cable: int) -> Axes:
    """Fig. 11: force of a cable in its bushing against the joint angle: the loop, and the four branches of eq. 11."""
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
    ax.set(
        xlabel=r"joint angle $\theta$ (rad)", ylabel="bushing force (N)", title=f"Fig. 11  Cable {cable}, four branches"
    )
    ax.legend(loc="lower left")
    tidy(ax)
    return ax


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


def draw_force(
    ax: Axes,
    measured: pd.Series[float],
    simulated: pd.Series[float],
    band: tuple[np.ndarray, np.ndarray],
    *,
    cable: int,
) -> Axes:
    """Fig. 12a, b: force of a cable at its nut, measured on the twin and simulated with its 95 % band, against time."""
    ax.fill_between(simulated.index, *band, color=BLUE, alpha=0.25, lw=0, label="95 % band")
    ax.plot(measured.index, measured, color=INK, lw=0.9, label="measured (twin)")
    ax.plot(simulated.index, simulated, color=BLUE, lw=1.1, label="simulated")
    letter = "ab"[cable - 1]
    ax.set(xlabel="time (s)", ylabel=f"cable force $F_{cable}$ (N)", title=f"Fig. 12{letter}  Force of cable {cable}")
    ax.legend(loc="best")
    tidy(ax)
    return ax


def draw_motion(ax: Axes, measured: pd.Series[float], simulated: pd.Series[float], *, letter: str) -> Axes:
    """Fig. 12c, d: velocity or angle of the joint, measured on the twin and simulated, against time."""
    of_velocity = letter == "c"
    ax.plot(measured.index, measured, color=INK, lw=0.7, label="measured (twin)")
    ax.plot(simulated.index, simulated, color=BLUE, lw=1.2, label="simulated")
    name = r"joint velocity $\dot\theta$ (rad/s)" if of_velocity else r"joint angle $\theta$ (rad)"
    ax.set(xlabel="time (s)", ylabel=name, title=f"Fig. 12{letter}  Joint {'velocity' if of_velocity else 'angle'}")
    ax.legend(loc="best")
    tidy(ax)
    return ax


def mark_shifts(ax: Axes, shifts: pd.DataFrame) -> Axes:
    """Mark the time between the simulated and the measured jump of a force, T_shift, on `ax`."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.18 * (high - low))
    height, above = high + 0.04 * (high - low), high + 0.07 * (high - low)
    for begin, end in zip(shifts["simulated_time"], shifts["measured_time"], strict=True):
        ax.annotate("", (end, height), (begin, height), arrowprops={"arrowstyle": "<->", "color": RED})
        ax.text(0.5 * (begin + end), above, r"$T_{shift}$", color=RED, ha="center")
    return ax

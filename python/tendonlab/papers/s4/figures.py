"""The figures of S4, drawn on axes that the caller brings: measurements as points, predictions as lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from tendonlab.papers.s4.constants import Mechanism
from tendonlab.papers.s4.metrics import synchronous_error
from tendonlab.papers.s4.play import capstan_play
from tendonlab.papers.s4.statics import Tensions, stiffness

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK, MUTED = "#1b1f24", "#8d959d"
BLUE, ORANGE, GREEN, PURPLE = "#0072b2", "#d55e00", "#009e73", "#aa4499"
SECTION = {"T11": BLUE, "T12": ORANGE, "T13": GREEN, "T21": BLUE, "T22": ORANGE, "T23": GREEN}
CONTACT = {"f11": BLUE, "f12": GREEN, "f21": ORANGE, "f22": PURPLE}


def draw_mechanism(ax: Axes) -> Axes:
    """The unit of S4 Figs 2 and 3 as a sketch of our own: two pulleys, two S-shaped cables, six sections."""
    t = np.linspace(0, 2 * np.pi, 200)
    radius, distance = 1.0, 4.2
    lean = np.arcsin(2 * radius / distance)
    for x, name in ((0.0, "joint 1 (passive)\n$\\theta_1$"), (distance, "joint 2 (driven)\n$\\theta_2 = u$")):
        ax.plot(x + radius * np.cos(t), radius * np.sin(t), color=MUTED, lw=1.2)
        ax.plot(x, 0, "o", color=INK, ms=3)
        ax.text(x, -1.25, name, ha="center", va="top")
    for sign, colour, name in ((1.0, BLUE, "1"), (-1.0, ORANGE, "2")):
        start, end = _tangent(0.0, lean, sign, radius), _tangent(distance, lean, -sign, radius)
        ax.plot([start[0], end[0]], [start[1], end[1]], color=colour, lw=1.8)
        for x, side in ((0.0, sign), (distance, -sign)):
            inwards = 1.0 if x == 0.0 else -1.0
            arc = np.linspace(np.pi / 2 - inwards * lean, np.pi / 2 + inwards * 0.5, 60)
            ax.plot(x + radius * np.cos(arc), side * radius * np.sin(arc), color=colour, lw=1.8)
            tip = (x + radius * np.cos(arc[-1]), side * radius * np.sin(arc[-1]))
            along = (-np.sin(arc[-1]) * inwards, side * np.cos(arc[-1]) * inwards)
            ax.plot([tip[0], tip[0] + 1.1 * along[0]], [tip[1], tip[1] + 1.1 * along[1]], color=colour, lw=1.8)
            section = "1" if x == 0.0 else "3"
            ax.text(tip[0] + 1.3 * along[0], tip[1] + 1.2 * along[1], f"$T_{{{name}{section}}}$",
                    color=colour, ha="center", va="center")  # fmt: skip
        quarter = start + (end - start) * 0.28
        ax.text(quarter[0], quarter[1] + 0.28 * sign, f"$T_{{{name}2}}$", color=colour, ha="center", va="center")
    ax.set(xlim=(-2.6, distance + 2.6), ylim=(-2.1, 1.4), aspect="equal")
    ax.axis("off")
    return ax


def _tangent(x: float, lean: float, side: float, radius: float) -> np.ndarray:
    """Where the crossing middle section leaves a pulley at `x`, above (+1) or below (-1)."""
    inwards = 1.0 if x == 0.0 else -1.0
    return np.array([x + inwards * radius * np.sin(lean), side * radius * np.cos(lean)])


def draw_play(ax: Axes, *, mu: float, wrap: float, T_0: float = 50.0) -> Axes:
    """Fig. 5: T_out over T_in with the stages I to IV between A, B, C and D."""
    low, high = np.exp(-mu * wrap), np.exp(mu * wrap)
    stages = [(T_0, T_0 * high), (T_0 * high, 80.0), (80.0, 80.0 * low**2), (80.0 * low**2, 40.0)]
    marks = [(T_0, T_0), (T_0 * high, T_0), (80.0, 80.0 * low), (80.0 * low**2, 80.0 * low)]
    T_out, at = T_0, np.array([35.0, 90.0])
    ax.plot(at, at * low, ":", color=MUTED, lw=1.0)
    ax.plot(at, at * high, ":", color=MUTED, lw=1.0)
    for (begin, end), stage, colour in zip(
        stages, ("I", "II", "III", "IV"), (BLUE, ORANGE, GREEN, PURPLE), strict=True
    ):
        T_in = np.linspace(begin, end, 200)
        out = capstan_play(T_in, T_0=T_out, mu=mu, wrap=wrap)
        ax.plot(T_in, out, color=colour, lw=1.8, label=f"stage {stage}")
        T_out = float(out[-1])
    for (x, y), name in zip(marks, "ABCD", strict=True):
        ax.plot(x, y, "o", color=INK, ms=4)
        ax.annotate(name, (x, y), textcoords="offset points", xytext=(5, 6))
    ax.set(xlabel="$T_{in}$ (N)", ylabel="$T_{out}$ (N)", xlim=(35, 90), ylim=(30, 75))
    ax.legend(loc="lower right")
    return ax


def draw_tensions(ax: Axes, tensions: Tensions) -> Axes:
    """Fig. 6 in numbers: the six tensions as bars."""
    names = list(tensions._fields)
    bars = ax.bar(names, list(tensions), color=[SECTION[name] for name in names], width=0.7)
    ax.bar_label(bars, fmt="%.2f", padding=2, fontsize=8)
    ax.set(ylabel="tension (N)", ylim=(0, 1.15 * max(tensions)))
    return ax


def draw_stiffness(ax: Any, *, mechanism: Mechanism, mu: float, reach: float, speed: float) -> Any:
    """Fig. 7 in three dimensions: stiffness over angle, degrees, and rate of joint 1, one surface per direction."""
    theta = np.linspace(-reach, reach, 41)
    for sign, colour in ((1, ORANGE), (-1, BLUE)):
        x, y = np.meshgrid(np.rad2deg(theta), sign * np.linspace(0.0, speed, 9))
        k = np.tile(stiffness(theta, sign=sign, mechanism=mechanism, mu=mu), (9, 1))
        ax.plot_surface(x, np.rad2deg(y), k, color=colour, alpha=0.75, lw=0)
    ax.set(xlabel=r"$\theta_1$ (°)", ylabel=r"rate of $\theta_1$ (°/s)", xticks=(-10, 0, 10), yticks=(-15, 0, 15))
    ax.set(zticks=(290, 295, 300, 305))
    ax.set_zlabel("stiffness (N·m/rad)", labelpad=4)
    ax.view_init(elev=32, azim=-70)
    return ax


def draw_angles(ax: Axes, run: pd.DataFrame) -> Axes:
    """Fig. 8a, 11a: both joints over time, and on a second axis the synchronous error, in degrees."""
    deg = np.rad2deg
    ax.plot(run.index, deg(run["theta2"]), color=MUTED, lw=2.2, label=r"$\theta_2$ (driven)")
    ax.plot(run.index, deg(run["theta1"]), "--", color=BLUE, lw=1.2, label=r"$\theta_1$")
    ax.set(xlabel="time (s)", ylabel="joint angle (°)")
    other = ax.twinx()
    other.plot(run.index, deg(synchronous_error(run)), color=ORANGE, lw=0.9, label=r"error $\Delta\theta$")
    other.set_ylabel(r"synchronous error $\Delta\theta$ (°)", color=ORANGE)
    other.spines["right"].set_visible(True)
    lines = [*ax.get_lines(), *other.get_lines()]
    ax.legend(lines, [str(line.get_label()) for line in lines], loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
    return other


def draw_loop(ax: Axes, run: pd.DataFrame) -> Axes:
    """Fig. 8b, 11b: the error over theta_2, in degrees: theta_1 over theta_2 with the diagonal taken out, on which the
    loop could not be seen."""
    ax.plot(np.rad2deg(run["theta2"]), np.rad2deg(synchronous_error(run)), color=BLUE, lw=1.2)
    ax.set(xlabel=r"$\theta_2$ (°)", ylabel=r"$\theta_2 - \theta_1$ (°)")
    return ax


def draw_phase(ax: Axes, run: pd.DataFrame) -> Axes:
    """Fig. 8b, 11b as printed: theta_1 over theta_2, in degrees."""
    ax.plot(np.rad2deg(run["theta2"]), np.rad2deg(run["theta1"]), color=BLUE, lw=1.2)
    ax.set(xlabel=r"$\theta_2$ (°)", ylabel=r"$\theta_1$ (°)")
    return ax


def draw_six_tensions(axes: Any, run: pd.DataFrame) -> None:
    """Fig. 9a, 13b: the tensions of each cable, on two axes."""
    for ax, cable in zip(axes, "12", strict=True):
        for section, name in enumerate((f"T{cable}1", f"T{cable}2", f"T{cable}3")):
            label = f"$T_{{{cable}{section + 1}}}$"
            ax.plot(run.index, run[name], color=SECTION[name], lw=0.9 + 0.2 * section, label=label)
        ax.set(ylabel=f"cable {cable}: tension (N)")
        ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes[-1].set_xlabel("time (s)")


def draw_friction(ax: Axes, run: pd.DataFrame, *, without: pd.DataFrame | None = None) -> Axes:
    """Fig. 9b: friction of the four contacts; dotted: `without` the Stribeck excess."""
    for name, colour in CONTACT.items():
        ax.plot(run.index, run[name], color=colour, lw=1.2, label=f"$f_{{{name[1:]}}}$")
        if without is not None:
            ax.plot(without.index, without[name], ":", color=INK, lw=0.9)
    ax.set(xlabel="time (s)", ylabel="contact friction (N)")
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return ax


def draw_excess(ax: Axes, run: pd.DataFrame, without: pd.DataFrame) -> Axes:
    """Below Fig. 9b: friction of the four contacts less that `without` the Stribeck excess."""
    for name, colour in CONTACT.items():
        ax.plot(run.index, run[name] - without[name], color=colour, lw=1.0)
    ax.set(xlabel="time (s)", ylabel="difference (N)")
    return ax


def draw_fit(axes: Sequence[Axes], read: pd.DataFrame, simulated: pd.DataFrame, *, name: str = "T22") -> Sequence[Axes]:
    """Fig. 12: a measured tension and the simulated one, and their difference, on two axes."""
    ax, left = axes
    ax.plot(read.index, read[name], ".", color=INK, ms=1.2, alpha=0.5, rasterized=True, label="measured (twin)")
    ax.plot(simulated.index, simulated[name], color=ORANGE, lw=1.2, label="simulated")
    low, high = float(read[name].min()), float(read[name].max())
    ax.set(ylabel=f"$T_{{{name[1:]}}}$ (N)", ylim=(low - 2, high + 0.45 * (high - low)))
    ax.legend(loc="upper left", markerscale=5)
    left.plot(read.index, read[name] - simulated[name], ".", color=INK, ms=1.2, alpha=0.5, rasterized=True)
    left.axhline(0.0, color=ORANGE, lw=1.2)
    left.set(xlabel="time (s)", ylabel="difference (N)")
    return axes


def draw_coefficient(ax: Axes, time: np.ndarray, mu: np.ndarray, kept: np.ndarray) -> Axes:
    """Fig. 14a: friction coefficient sample by sample; what counts in colour, reversals left out in grey."""
    ax.plot(time, mu, ".", color=MUTED, ms=1.2, rasterized=True, label="all samples")
    ax.plot(time[kept], mu[kept], ".", color=BLUE, ms=1.5, rasterized=True, label="away from reversals")
    ax.set(xlabel="time (s)", ylabel=r"$\mu_{c,21}$ (1)", ylim=(0.0, 0.3))
    ax.legend(loc="upper right", markerscale=6)
    return ax

"""The drawings of S2: the joint with its bushings (Fig. 1) and the forces on a cable in a bushing (Fig. 7)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tendonlab.papers.s2 import equations
from tendonlab.papers.s2.values import Constants
from tendonlab.report.plot.style import COLOURS, INK, MUTED, RULE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

UNIT = 0.5  # length of a force T in the drawing
RED, BLUE = COLOURS["with_effect"], COLOURS["refitted"]


def draw_joint(of: Constants, ax: Axes, *, theta: float = 0.5) -> Axes:
    """Fig. 1, schematic: two links, the second at twice the angle of the first, and two antagonist cables through their
    bushings; lengths in m are those of Table I, the cables' side offset is r."""
    at = equations.positions(of.with_(phi=0.0), theta)
    second = at["P_cm1"] * of.l_1 / of.d_11
    outline = np.stack([[-0.12, 0.0], [0.0, 0.0], second, at["P_ee"]])
    ax.plot(*outline.T, color=MUTED, lw=9, solid_capstyle="round", alpha=0.35, zorder=1)
    turns = np.array([0.0, theta, 2.0 * theta])
    for side, colour, name in ((1.0, BLUE, "cable 1"), (-1.0, RED, "cable 2")):
        stations = [np.array([-0.12, side * of.r])]
        for centre, before, after in ((np.zeros(2), turns[0], turns[1]), (second, turns[1], turns[2])):
            middle = 0.5 * (before + after)
            stations.append(centre + side * of.r * np.array([-np.sin(middle), np.cos(middle)]))
        stations.append(second + 0.1 * _way(turns[2]) + side * of.r * np.array([-np.sin(turns[2]), np.cos(turns[2])]))
        path = np.stack(stations)
        anchor = np.stack([second + 0.1 * _way(turns[2]), stations[-1]])
        ax.plot(*anchor.T, color=MUTED, lw=3, alpha=0.5, zorder=2)
        ax.plot(*path.T, color=colour, lw=1.6, label=name, zorder=3)
        ax.plot(*path[1:3].T, "o", ms=7, mfc="white", mec=colour, mew=1.6, ls="none", zorder=4)
        ax.annotate("", path[0] - np.array([0.07, 0.0]), path[0], arrowprops={"arrowstyle": "-|>", "color": colour})
        ax.text(path[0][0] - 0.06, path[0][1] + 0.012, f"$F_{1 if side > 0 else 2}$", color=colour, ha="center")
    for centre, start, turn, text in ((np.zeros(2), 0.0, theta, r"$\theta$"), (second, theta, theta, r"$\theta$")):
        ax.plot(*np.stack([centre, centre + 0.14 * _way(start)]).T, color=RULE, lw=1.0, ls="--", zorder=0)
        arc = start + np.linspace(0.0, turn, 30)
        ax.plot(*(centre[:, None] + 0.12 * np.stack([np.cos(arc), np.sin(arc)])), color=INK, lw=0.9)
        _label(ax, centre + 0.15 * _way(start + 0.5 * turn), text, ha="center", va="center")
        ax.plot(*centre, "o", ms=8, mfc="white", mec=INK, zorder=5)
    ax.text(0.295, 0.365, "end effector", color=MUTED, ha="right", va="center")
    ax.plot([], [], "o", mfc="white", mec=INK, mew=1.4, ls="none", label="bushing")
    ax.set(aspect="equal", xlim=(-0.26, 0.46), ylim=(-0.13, 0.4), xlabel="x (m)", ylabel="y (m)")
    ax.set_title("Fig. 1  Joint with two cables and bushings (schematic)")
    ax.legend(loc="upper left")
    return ax


def draw_bushing(ax: Axes, *, theta: float = 0.9, tension: float = 1.0) -> Axes:
    """Fig. 7: a cable that turns by `theta`, rad, in a bushing: tensions, reaction (S2 eq. 8), friction.
    Forces are drawn to scale, in units of `tension`."""
    turn = np.linspace(-0.5 * theta, 0.5 * theta, 60) - 0.5 * np.pi
    bend = np.stack([0.6 * np.cos(turn), 0.6 * np.sin(turn)], axis=1)
    along = [
        np.array([-np.cos(0.5 * theta), np.sin(0.5 * theta)]),
        np.array([np.cos(0.5 * theta), np.sin(0.5 * theta)]),
    ]
    ends = [bend[0] + 0.9 * along[0], bend[-1] + 0.9 * along[1]]
    cable = np.vstack([ends[0], bend, ends[1]])
    ax.plot(*cable.T, color=INK, lw=2.2)
    ax.fill(*np.vstack([bend * 0.97, bend[::-1] * 0.8]).T, color=RULE, zorder=0)
    size = float(np.linalg.norm(equations.bushing_reaction(tension, theta))) / tension
    bottom = np.array([0.0, -0.6])
    reaction, friction = rf"$R=2T\sin(\theta/2)={size:.2f}\,T$", r"$F_a=\mu R$"
    arrows = [
        (ends[0], along[0] * UNIT, "T", INK, along[0] * (UNIT + 0.09)),
        (ends[1], along[1] * UNIT, "T", INK, along[1] * (UNIT + 0.09)),
        (bottom, np.array([0.0, -UNIT * size]), reaction, BLUE, np.array([0.72, -UNIT * size])),
        (bend[12] - np.array([0.02, 0.07]), along[0] * UNIT * 0.5 * size, friction, RED, np.array([-0.25, -0.08])),
    ]
    for start, force, text, colour, aside in arrows:
        ax.annotate("", start + force, start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.8})
        _label(ax, start + aside, text, color=colour, ha="center", va="center")
    ax.plot([0.0, 0.0], [-1.3, 0.3], color=MUTED, lw=0.8, ls="-.", zorder=0)
    ax.text(0.03, 0.24, "bisector", color=MUTED, va="center")
    way = ends[1] + np.array([-0.45, -0.02])
    ax.annotate("", way + 0.25 * along[1], way, arrowprops={"arrowstyle": "->", "color": MUTED})
    _label(ax, way + 0.3 * along[1], "v", color=MUTED, ha="center", va="bottom")
    ax.set(xlim=(-1.8, 1.8), ylim=(-1.4, 0.55))
    ax.set(aspect="equal", title=rf"Fig. 7  Forces in a bushing, $\theta$ = {theta:g} rad")
    ax.axis("off")
    return ax


def _label(ax: Axes, at: np.ndarray, text: str, **style: Any) -> None:
    ax.text(float(at[0]), float(at[1]), text, **style)


def _way(angle: float) -> np.ndarray:
    return np.array([np.cos(angle), np.sin(angle)])

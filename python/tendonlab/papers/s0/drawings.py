"""Free-body diagrams and the scheme of the drive (S0 Figs 3, 6, 8, 9), drawn to the dimensions of Table 5."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tendonlab.papers.s0.bearings import Reactions, cable_pull, capstan_reactions, pulley_reactions
from tendonlab.papers.s0.bench import Configuration, Shaft

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PUSH, REACTION, BODY = "C3", "C0", "0.35"
Force = tuple[float, float, str, str]  # at, m; N (upwards positive); label; colour


def motor_diagram(ax: Axes) -> Axes:
    """Fig. 3: the motor's housing held by two load cells; their couple is the torque of the motor."""
    from matplotlib.patches import Circle, Rectangle

    ax.add_patch(Rectangle((-1.6, -0.09), 3.2, 0.18, fc="0.9", ec=BODY))
    ax.add_patch(Circle((0, 0), 0.55, fc="0.8", ec=BODY))
    ax.plot(0, 0, "+", color=BODY, ms=10)
    _arrow(ax, (-1.45, 1.0), (-1.45, 0.1), PUSH)
    _arrow(ax, (1.45, -1.0), (1.45, -0.1), PUSH)
    ax.text(-1.75, 0.75, "$F_1$", color=PUSH)
    ax.text(1.55, -0.85, "$F_2$", color=PUSH)
    ax.annotate(
        "",
        (-0.35, -0.62),
        (0.62, -0.35),
        arrowprops={"arrowstyle": "->", "color": REACTION, "connectionstyle": "arc3,rad=-0.5"},
    )
    ax.text(0.35, -0.85, "$T_m$", color=REACTION)
    for x, name in ((-1.45, "$L_1$"), (1.45, "$L_2$")):
        ax.annotate("", (0, 0.72), (x, 0.72), arrowprops={"arrowstyle": "<->", "color": "0.5", "lw": 0.8})
        ax.text(x / 2, 0.77, name, ha="center", color="0.3")
    ax.text(0, -1.3, "$T_m = F_1 L_1 + F_2 L_2$   (eq. 5)", ha="center")
    ax.set(xlim=(-2.0, 2.0), ylim=(-1.5, 1.15), aspect="equal", title="Fig. 3  Motor on its load cells")
    return _blank(ax)


def pulley_diagram(axes: tuple[Axes, Axes], of: Configuration, *, pretension: float) -> None:
    """Fig. 8: the pulley's shaft in the vertical plane and in the plane of the cable, with reactions in N."""
    found = pulley_reactions(of, pretension=pretension)
    weights = [
        (of.pulley.gravity, -of.pulley.weight, "W", PUSH),
        (of.pulley.disc or 0.0, -of.external.weight, "W_{ext}", PUSH),
    ]
    _shaft(axes, of.pulley, found, weights, cable_pull(of, pretension), "Fig. 8  Pulley shaft")


def capstan_diagram(axes: tuple[Axes, Axes], of: Configuration, *, pretension: float) -> None:
    """Fig. 9: the capstan's shaft likewise."""
    found = capstan_reactions(of, pretension=pretension)
    weights = [(of.capstan.gravity, -of.capstan.weight, "W", PUSH)]
    _shaft(axes, of.capstan, found, weights, cable_pull(of, pretension), "Fig. 9  Capstan shaft")


def drive_scheme(ax: Axes) -> Axes:
    """Fig. 6: parts that turn with the motor, parts that turn with the pulley, and the ratio between (eq. 7)."""
    from matplotlib.patches import FancyBboxPatch

    boxes = (
        (0.0, "motor\n$J_M,\\ B_M$"),
        (2.2, "capstan\n$J_1$"),
        (4.4, "cable\n$1:N$"),
        (6.6, "pulley\n$J_2$"),
        (8.8, "load\n$J_L,\\ B_L$"),
    )
    for x, text in boxes:
        ax.add_patch(FancyBboxPatch((x - 0.7, -0.45), 1.4, 0.9, boxstyle="round,pad=0.05", fc="0.92", ec=BODY))
        ax.text(x, 0, text, ha="center", va="center")
    for x in (0.75, 2.95, 5.15, 7.35):
        ax.plot([x, x + 0.7], [0, 0], color=BODY, lw=2)
    for x, text, color in ((0.0, "$T_M,\\ \\theta_M$", PUSH), (8.8, "$T_L,\\ \\theta_L = \\theta_M/N$", PUSH)):
        _arrow(ax, (x, 1.15), (x, 0.55), color)
        ax.text(x, 1.22, text, ha="center", color=color)
    _arrow(ax, (4.4, -1.15), (4.4, -0.55), REACTION)
    ax.text(4.4, -1.45, "$T_{fs}$: friction of the transmission, on the motor's side", ha="center", color=REACTION)
    ax.set(xlim=(-1, 9.9), ylim=(-1.7, 1.6), title="Fig. 6  Drive with a rigid transmission (eq. 7)")
    return _blank(ax)


def _shaft(
    axes: tuple[Axes, Axes],
    shaft: Shaft,
    found: Reactions,
    weights: list[Force],
    pull: float,
    title: str,
) -> None:
    vertical = [(0.0, found.A_y, "A_y", REACTION), (shaft.bearing, found.B_y, "B_y", REACTION), *weights]
    level = [
        (0.0, found.A_z, "A_z", REACTION),
        (shaft.bearing, found.B_z, "B_z", REACTION),
        (shaft.cable, -pull, "F_D", PUSH),
    ]
    for ax, forces, plane in zip(
        axes, (vertical, level), ("vertical plane x–y", "plane of the cable, x–z"), strict=True
    ):
        _beam(ax, shaft, [f for f in forces if f[1] != 0.0])
        ax.set_title(f"{title}: {plane}", fontsize=10)


def _beam(ax: Axes, shaft: Shaft, forces: list[Force]) -> None:
    """The shaft as a line, bearings as triangles, forces as arrows whose length follows the root of the force."""
    longest = max(shaft.end, shaft.disc or 0.0)
    ax.plot([0, 1e3 * longest], [0, 0], color=BODY, lw=3, solid_capstyle="butt")
    ax.plot([0, 1e3 * shaft.bearing], [0, 0], "o", color="k", mfc="w", ms=7, zorder=5)
    largest = max(abs(f[1]) for f in forces)
    for at, force, label, color in forces:
        tip, length = 1e3 * at, 0.35 + 0.65 * (abs(force) / largest) ** 0.5
        up = 1.0 if force > 0 else -1.0
        _arrow(ax, (tip, -up * length), (tip, -up * 0.06), color)
        ax.text(tip + 2, -up * length, f"${label}$ = {abs(force):.1f} N", color=color, va="center", fontsize=8)
    points = {"A": 0.0, "B": shaft.bearing, "cg": shaft.gravity, "D": shaft.cable}
    for label, at in (points if shaft.disc is None else {**points, "E": shaft.disc}).items():
        ax.plot(1e3 * at, 0, "|", color=BODY, ms=8)
        lifted = any(force > 0 and abs(where - at) < 1e-6 for where, force, *_ in forces)
        ax.text(1e3 * at, 0.13 if lifted else -0.3, label, fontsize=8, ha="center", color="0.3")
    ax.set(xlim=(-8, 1e3 * longest + 45), ylim=(-1.25, 1.25), xlabel="distance from bearing A (mm)", yticks=[])
    for side in ("left", "right", "top"):
        ax.spines[side].set_visible(False)


def _arrow(ax: Axes, tail: tuple[float, float], tip: tuple[float, float], color: str) -> None:
    ax.annotate("", tip, tail, arrowprops={"arrowstyle": "-|>", "color": color, "lw": 1.6})


def _blank(ax: Axes) -> Axes:
    ax.set_axis_off()
    return ax

"""Drawings of S1: the routing of the cables (figs 2, 5) and block diagrams (figs 3, 4, 6)."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyBboxPatch, Polygon

from tendonlab.mechanics.tendons import TendonTransmission
from tendonlab.papers.s1.blocks import Block, BlockDiagram

INK, WIRE, LIGHT = "0.15", "0.35", "0.9"
COLOURS = ("tab:blue", "tab:orange", "tab:green", "tab:red", "tab:purple", "tab:brown")


def draw_routing(
    transmission: TendonTransmission, ax: Axes | None = None, *, only: Sequence[int] | None = None
) -> Axes:
    """Every transmission in a row of its own, as if pulled apart along the joints' axes: the motor on the base, idle
    pulleys at the joints before, the driven pulley last. A cable that changes sides between two pulleys turns them in
    opposite senses (a negative radius). Not to scale. `only`: numbers of the transmissions to draw, all unless given.
    Source: S1 figs 2, 5."""
    ax = plt.gca() if ax is None else ax
    shown = list(only or range(1, transmission.num_joints + 1))
    longest = max(shown)
    for j in range(longest + 1):
        x, width = (0.0, 1.1) if j == 0 else (2.0 * j, 0.34)
        box = FancyBboxPatch(
            (x - width / 2, -0.9), width, 1.6 * len(shown) + 0.6, boxstyle="round,pad=0.05", fc=LIGHT, ec="none"
        )
        ax.add_patch(box)
        label = "base with\nmotors" if j == 0 else f"joint {j}"
        ax.text(x, 1.6 * len(shown) - 0.05, label, ha="center", va="bottom", fontsize=9)
        if j < longest:
            ax.text(2.0 * j + 1.0, -0.85, f"link {j}", ha="center", va="bottom", fontsize=8, color=WIRE)
    for row, number in enumerate(reversed(shown)):
        _draw_cable(ax, transmission, number, 1.6 * row, COLOURS[(number - 1) % len(COLOURS)])
    ax.set(xlim=(-1.0, 2.0 * longest + 0.9), ylim=(-1.1, 1.6 * len(shown) + 0.6), aspect="equal")
    ax.axis("off")
    return ax


def _draw_cable(ax: Axes, transmission: TendonTransmission, number: int, y: float, colour: str) -> None:
    i, size = number - 1, 0.42
    radii = [float(transmission.motor_radius[i]), *(float(r) for r in transmission.radius[i, : i + 1])]
    shown = [np.sign(r) * size * (0.45 if 0 < k <= i else 0.8 if k else 0.55) for k, r in enumerate(radii)]
    x = 2.0 * np.arange(i + 2)
    for side in (1.0, -1.0):
        ax.plot(x, y + side * np.array(shown), color=colour, lw=1.4, zorder=3)
    for k, (at, radius) in enumerate(zip(x, shown, strict=True)):
        edge = colour if k in (0, i + 1) else WIRE
        ax.add_patch(Circle((at, y), abs(radius), fc="white", ec=edge, lw=1.6 if k == i + 1 else 1.1, zorder=2))
        ax.plot(at, y, ".", color=INK, ms=4, zorder=4)
    ax.text(x[0] - 0.35, y, f"{number}", ha="right", va="center", color=colour, fontsize=10, weight="bold")
    reducer = transmission.reducers[i]
    if reducer is not None:
        ax.text(x[-1] + 0.4, y, f"1:{reducer.ratio:g}", ha="left", va="center", fontsize=8, color=INK)


def draw_blocks(diagram: BlockDiagram, ax: Axes | None = None, *, fontsize: float = 9) -> Axes:
    """The blocks where they say, joined by straight wires that turn at most once. Source: S1 figs 3, 4, 6."""
    ax = plt.gca() if ax is None else ax
    by_name = {block.name: block for block in diagram.blocks}
    fed = Counter(name for block in diagram.blocks for name in block.sources)
    for block in diagram.blocks:
        for name in block.sources:
            _draw_wire(ax, by_name[name], block, forked=fed[name] > 1)
    for block in diagram.blocks:
        _draw_block(ax, block, fontsize)
    x, y = [b.x for b in diagram.blocks], [b.y for b in diagram.blocks]
    ax.set(xlim=(min(x) - 1.0, max(x) + 1.0), ylim=(min(y) - 0.8, max(y) + 0.8), aspect="equal")
    ax.axis("off")
    return ax


def _half(block: Block) -> tuple[float, float]:
    """Half width and height of a block."""
    lines = block.label.split("\n")
    if block.shape == "sum":
        return 0.2, 0.2
    if block.shape in ("input", "output") and len(lines) == 1:
        return 0.34, 0.28
    widest = max(len(re.sub(r"\\[a-z]+", "x", line, flags=re.I).translate(_TEX)) for line in lines)
    return max(0.34, 0.075 * widest + 0.09), 0.17 * len(lines) + 0.13


_TEX = str.maketrans("", "", "${}^_\\")


def _draw_block(ax: Axes, block: Block, fontsize: float) -> None:
    wide, high = _half(block)
    if block.shape == "sum":
        ax.add_patch(Circle((block.x, block.y), wide, fc="white", ec=INK, lw=1.0, zorder=3))
    elif block.shape == "gain" and "\n" not in block.label:
        corners = [(block.x - wide, block.y - high), (block.x + wide, block.y - high),
                   (block.x + wide, block.y + high), (block.x - wide, block.y + high)]  # fmt: skip
        ax.add_patch(Polygon(corners, fc="#eef3fa", ec=INK, lw=1.0, zorder=3))
    elif block.shape not in ("input", "output") or "\n" in block.label:
        ax.add_patch(
            FancyBboxPatch(
                (block.x - wide, block.y - high), 2 * wide, 2 * high, boxstyle="round,pad=0.02",
                fc="#fdf3e3" if block.shape == "block" else "white", ec=INK, lw=1.0, zorder=3,
            )
        )  # fmt: skip
    else:
        ax.add_patch(Circle((block.x, block.y), 0.3, fc="white", ec="none", zorder=2.5))
    ax.text(block.x, block.y, block.label, ha="center", va="center", fontsize=fontsize, color=INK, zorder=4)


def _draw_wire(ax: Axes, source: Block, target: Block, *, forked: bool) -> None:
    """Along the row first, then up or down, from a gain to a sum the other way round; an arrow at the end, a dot where
    a wire forks."""
    wide, high = _half(target)
    dx, dy = target.x - source.x, target.y - source.y
    turns = abs(dx) > 1e-9 and abs(dy) > 1e-9
    side = (target.x - np.sign(dx) * wide, target.y)
    top = (target.x, target.y - np.sign(dy) * high)
    upright = turns and source.shape == "gain" and target.shape == "sum"
    end = side if abs(dy) < 1e-9 or upright else top
    corner = (source.x, target.y) if upright else (target.x, source.y) if turns else (source.x, source.y)
    ax.plot([source.x, corner[0]], [source.y, corner[1]], color=WIRE, lw=0.9, zorder=1)
    if forked and turns and not upright:
        ax.plot(*corner, ".", color=WIRE, ms=5, zorder=1)
    arrow = {"arrowstyle": "-|>", "color": WIRE, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", xy=end, xytext=corner, arrowprops=arrow, zorder=1)

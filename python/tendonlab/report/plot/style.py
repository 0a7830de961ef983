"""Colours and marks shared by all figures: Okabe–Ito, which colour-blind readers can tell apart."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tendonlab.report.numbers import unit_text
from tendonlab.report.words import capital, words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK = "#1b1f24"  # measurements and text; the report gives it the text colour of the page
MUTED = "#5b6570"
RULE = "#d4d9de"
COLOURS = {"measured": INK, "nominal": "#8d959d", "refitted": "#0072b2", "with_effect": "#d55e00"}
DASHES: dict[str, Any] = {"nominal": (0, (4, 1.5)), "refitted": "-", "with_effect": "-"}

FIGURE: Any = {  # rc settings of the figures that the report makes; axes that a user brings keep theirs
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "axes.titlesize": 9.5,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.edgecolor": MUTED,
    "axes.linewidth": 0.7,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "axes.formatter.use_mathtext": False,
    "svg.fonttype": "none",
    "text.parse_math": False,  # a dollar in a name is a dollar
    "figure.autolayout": False,
    "figure.constrained_layout.use": False,
}


def new_axes(*, width: float = 6.4, height: float = 3.2) -> Axes:
    """Axes of a new figure of `width` × `height`, inch."""
    from matplotlib import pyplot

    return pyplot.subplots(figsize=(width, height), layout="constrained")[1]


def label(name: str, unit: str) -> str:
    """An axis label: "Joint angle (rad)"."""
    shown = unit_text(unit)
    return wrapped(f"{capital(words(name))} ({shown})" if shown else capital(words(name)))


def wrapped(text: str, *, width: int = 28) -> str:
    """`text` in at most three lines of `width` characters: a long name must not leave the axes without room."""
    from textwrap import fill

    return fill(text, width, max_lines=3, placeholder=" …")


def tidy(ax: Axes, *, grid: str | None = "y") -> None:
    """No box, and a light grid along `grid` ("x", "y", "both" or None) behind the data."""
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_axisbelow(True)
    if grid:
        ax.grid(True, axis=grid, color=RULE, lw=0.6)  # type: ignore[arg-type]

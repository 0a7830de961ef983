"""Where: the residual over the plane of motion and position or load."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tendonlab.errors import ParameterError
from tendonlab.report.numbers import number
from tendonlab.report.plot.style import MUTED, label, new_axes
from tendonlab.report.words import STAGES, capital

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.collections import QuadMesh
    from matplotlib.colors import Normalize

    from tendonlab.report.diagnosis import WhereMap

_LOG_FROM = 12.0


def where_map(
    where: WhereMap, ax: Axes | None = None, *, stage: str = "refitted", scale: Normalize | None = None
) -> Axes:
    """RMS residual over the noise floor in each cell, for `stage` "refitted" or "with_effect"; empty without data.

    `scale`: the colour scale, by default one that the two stages share. With new axes a colour bar is drawn as well."""
    if stage not in ("refitted", "with_effect"):
        raise ParameterError(f"stage = {stage!r}: expected refitted or with_effect")
    own = ax is None
    ax = new_axes(width=4.6, height=3.4) if ax is None else ax
    mesh = _draw(ax, where, stage=stage, scale=shared_scale(where) if scale is None else scale)
    if own:
        colour_bar(mesh, [ax])
    return ax


def shared_scale(where: WhereMap) -> Normalize:
    """From the noise floor (1) to the largest cell of both stages; logarithmic where that is far above the floor."""
    from matplotlib.colors import LogNorm, Normalize

    both = np.concatenate([np.ravel(where.refitted), np.ravel(where.with_effect)])
    peak = max(2.0, float(np.nanmax(both))) if np.isfinite(both).any() else 2.0
    return LogNorm(1.0, peak) if peak > _LOG_FROM else Normalize(1.0, peak)


def colour_bar(mesh: ScalarMappable, axes: list[Axes]) -> None:
    """One colour bar for all of `axes`, which need to be on one figure."""
    from matplotlib.ticker import FuncFormatter, NullFormatter

    figure = axes[0].get_figure()
    if figure is None:
        raise ParameterError("axes[0] has no figure: expected axes on a figure")
    bar = figure.colorbar(mesh, ax=axes, fraction=0.05, pad=0.02, extend="min")
    bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
    bar.ax.yaxis.set_minor_formatter(NullFormatter())
    bar.set_label("RMS residual / noise floor")
    bar.outline.set_visible(False)


def _draw(ax: Axes, where: WhereMap, *, stage: str, scale: Normalize) -> QuadMesh:
    cells = np.ma.masked_invalid(getattr(where, stage))
    mesh = ax.pcolormesh(where.x_edges, where.y_edges, cells, norm=scale, cmap="cividis", lw=0, rasterized=True)
    ax.set(xlabel=label(where.x, where.x_unit), ylabel=label(where.y, where.y_unit))
    ax.locator_params(axis="x", nbins=5)  # small numbers are long, and the maps stand side by side
    ax.set_title(f"{capital(where.place)}, {STAGES[stage]}", loc="left")
    if where.x_edges[0] < 0 < where.x_edges[-1]:
        ax.axvline(0.0, color=MUTED, lw=0.6, ls=":")
    ax.spines[["top", "right"]].set_visible(False)
    return mesh

"""The figures of a report: each is drawn once and then kept as SVG and PNG."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from markupsafe import Markup, escape

from tendonlab.report.plot import gap_bars, overlay, ranked_effects, where_map
from tendonlab.report.plot.effects import height
from tendonlab.report.plot.runs import draw_input, telling_window
from tendonlab.report.plot.style import COLOURS, FIGURE, INK, MUTED, RULE
from tendonlab.report.plot.where import colour_bar, shared_scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import YAxis
    from matplotlib.figure import Figure

    from tendonlab.report.diagnosis import Diagnosis, Overlay

_ALTS = {
    "gap": "Held-out error of each output over its noise floor",
    "overlay": "Measured and predicted signals in a held-out experiment, and the residuals",
    "where": "Residual over the noise floor in the plane of motion",
    "effects": "Candidate effects by probability",
}
LARGEST_SVG = 400_000  # bytes; beyond, the page embeds the PNG
MOST_DRAWN = 4  # outputs drawn; the tables list all
MOST_INPUTS = 2  # inputs drawn below them
MOST_RUNS = 12  # held-out experiments drawn
MOST_MAPS = 2  # where maps, the likeliest elements first: ports of one axis move together and look alike
_PAGE_COLOURS = {
    INK: "var(--ink)",
    MUTED: "var(--muted)",
    RULE: "var(--rule)",
    COLOURS["refitted"]: "var(--refitted)",
    "#ffffff": "none",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Picture:
    """One figure, saved when it is asked for: `svg` with text as text, `png` at 160 dots per inch."""

    name: str
    alt: str
    figure: Figure

    @cached_property
    def svg(self) -> str:
        stream = io.StringIO()
        self._save(stream, {"format": "svg", "metadata": {"Date": None, "Creator": None}})
        return stream.getvalue()

    @cached_property
    def png(self) -> bytes:
        stream = io.BytesIO()
        self._save(stream, {"format": "png", "metadata": {"Software": None}})
        return stream.getvalue()

    def inline(self) -> Markup:
        """The figure for the page."""
        return embed(self.svg, lambda: self.png, name=self.name, alt=self.alt)

    def _save(self, stream: io.StringIO | io.BytesIO, options: dict[str, Any]) -> None:
        import matplotlib

        with matplotlib.rc_context(FIGURE | {"svg.hashsalt": self.name}):  # the same diagnosis gives the same bytes
            if self.figure.get_layout_engine():
                _lay_out(self.figure)
            self.figure.savefig(stream, dpi=160, **options)


def _lay_out(figure: Figure) -> None:
    """Lay the figure out once for all saves, the y labels of axes above each other in line. Where labels stand,
    matplotlib would work out anew in each draw, which takes longer than the draw."""
    figure.draw_without_rendering()
    figure.set_layout_engine(None)
    columns: dict[tuple[float, str], dict[YAxis, float]] = {}
    for ax in figure.axes:
        axis, left = ax.yaxis, round(ax.get_position().x0, 3)
        place = float(ax.transAxes.inverted().transform((axis.label.get_position()[0], 0.0))[0])
        columns.setdefault((left, axis.get_label_position()), {})[axis] = place
    for (_, side), places in columns.items():
        outermost = min(places.values()) if side == "left" else max(places.values())
        for axis in places:
            axis.set_label_coords(outermost, 0.5)


def embed(svg: str, png: Callable[[], bytes], *, name: str, alt: str) -> Markup:
    """The SVG in the colours of the page, or the PNG where the SVG is larger than LARGEST_SVG bytes."""
    small = _for_page(svg, prefix=name)
    if len(small.encode()) <= LARGEST_SVG:
        return Markup(small.replace("<svg ", f'<svg role="img" aria-label="{escape(alt)}" ', 1))
    source = base64.b64encode(png()).decode()
    return Markup('<img class="paper" alt="{}" src="data:image/png;base64,{}">').format(alt, source)


def draw_all(diagnosis: Diagnosis) -> dict[str, Picture]:
    """Every figure for which the diagnosis holds data, by name: gap, overlay, overlay-2 …, where, effects."""
    if not diagnosis.effects and all(errors["refitted"] is None for errors in diagnosis.gap.values()):
        return {}  # nothing was fitted; loading matplotlib takes longer than the check of the logs
    import matplotlib

    with matplotlib.rc_context(FIGURE):
        drawn = {"gap": _gap(diagnosis), "where": _where(diagnosis), "effects": _effects(diagnosis)}
        drawn |= {overlay_name(k): _overlay(diagnosis, run) for k, run in enumerate(shown_runs(diagnosis))}
    alts = {name: _ALTS[name.partition("-")[0]] for name in drawn}
    return {
        name: Picture(name=name, alt=alts[name], figure=figure) for name, figure in drawn.items() if figure is not None
    }


def shown_runs(diagnosis: Diagnosis) -> list[Overlay]:
    """The held-out experiments that are drawn, the one that tuning leaves worst first."""
    return [run for run in diagnosis.overlays if run.measured][:MOST_RUNS]


def overlay_name(place: int) -> str:
    """Name of the figure of one of the held-out experiments drawn."""
    return "overlay" if place == 0 else f"overlay-{place + 1}"


def _gap(diagnosis: Diagnosis) -> Figure | None:
    if not diagnosis.gap:
        return None
    stages = 3 if diagnosis.selected else 2
    figure, ax = _figure(height=0.95 + 0.28 * stages * len(diagnosis.gap))
    gap_bars(diagnosis, ax)
    ax.set_ylabel("")
    return figure


def _overlay(diagnosis: Diagnosis, run: Overlay) -> Figure:
    from matplotlib.figure import Figure

    signals, window, inputs = _carrying(diagnosis, run), telling_window(run), list(run.inputs)[:MOST_INPUTS]
    heights = [2.1, 1.0] * len(signals) + [1.0] * len(inputs)
    figure = Figure(figsize=(6.2, 0.5 + 2.8 * len(signals) + 0.95 * len(inputs)), layout="constrained")
    grid = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)
    axes: list[Axes] = list(grid[:, 0])
    for index, signal in enumerate(signals):
        pair = axes[2 * index], axes[2 * index + 1]
        overlay(diagnosis, pair, signal=signal, window=window, experiment=run.name)
    for ax, name in zip(axes[2 * len(signals) :], inputs, strict=True):
        draw_input(ax, run, name, unit=diagnosis.units.get(name, ""), window=window)
    for ax in axes[:-1]:
        ax.set_xlabel("")
    parts = [ax.get_legend_handles_labels() for ax in axes[:2]]
    handles, labels = parts[0][0] + parts[1][0], parts[0][1] + parts[1][1]
    figure.legend(handles, labels, ncols=5, loc="outside upper left", handlelength=1.6, columnspacing=1.4)
    return figure


def _carrying(diagnosis: Diagnosis, run: Overlay) -> list[str]:
    """Outputs that carry most of the gap, in the order in which they were measured."""
    shares = {entry["signal"]: entry["share"] for entry in diagnosis.where["signals"]}
    carrying = sorted(run.measured, key=lambda signal: -(shares.get(signal) or 0.0))[:MOST_DRAWN]
    return [signal for signal in run.measured if signal in carrying]


def _where(diagnosis: Diagnosis) -> Figure | None:
    from matplotlib.figure import Figure

    sure = {entry["element"]: entry["probability"] for entry in diagnosis.where["elements"]}
    maps = sorted(diagnosis.where_map, key=lambda one: -sure.get(one.element, 0.0))[:MOST_MAPS]
    if not maps:
        return None
    stages = ("refitted", "with_effect") if diagnosis.selected else ("refitted",)
    figure = Figure(figsize=(6.4 if len(stages) == 2 else 4.4, 2.8 * len(maps)), layout="constrained")
    figure.set_layout_engine("constrained", h_pad=0.1)
    grid = figure.subplots(len(maps), len(stages), squeeze=False, sharey="row")
    for row, where in zip(grid, maps, strict=True):
        scale = shared_scale(where)
        for ax, stage in zip(row, stages, strict=True):
            where_map(where, ax, stage=stage, scale=scale)
            ax.set_title(ax.get_title("left") if len(stages) == 1 or ax is row[0] else "With effect", loc="left")
        if len(stages) == 2:
            row[1].set_ylabel("")
        colour_bar(row[0].collections[0], list(row))
    return figure


def _effects(diagnosis: Diagnosis) -> Figure | None:
    if not diagnosis.effects:
        return None
    figure, ax = _figure(height=height(diagnosis), width=7.4)
    ranked_effects(diagnosis, ax)
    ax.set_ylabel("")
    return figure


def _figure(*, height: float, width: float = 6.2) -> tuple[Figure, Axes]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, figure.subplots()


def _with_short_numbers(tag: re.Match[str]) -> str:
    return re.sub(r"-?\d+\.\d{3,}", lambda found: f"{float(found[0]):.2f}", tag[0])


def _for_page(svg: str, *, prefix: str) -> str:
    """The <svg> element alone: short numbers, colours of the page, ids unique on it, no outside reference."""
    body = svg[svg.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->|<!DOCTYPE.*?>", "", body, flags=re.S)
    body = re.sub(r' xmlns:xlink="[^"]*"| version="[^"]*"| xmlns="[^"]*"', "", body)
    body = body.replace("xlink:href", "href")
    body = re.sub(r"<[^>]*>", _with_short_numbers, body)  # in tags alone: what a text says stays as it is
    used = set(re.findall(r'(?:url\(#|href="#)([\w-]+)', body))
    body = re.sub(r' id="([\w.-]+)"', lambda found: f' id="{prefix}-{found[1]}"' if found[1] in used else "", body)
    body = re.sub(r'(url\(#|href="#)', rf"\g<1>{prefix}-", body)
    body = re.sub(r"font-family: [^;\"]*|font: ([\d.]+px) [^;\"]*", r"font-size: \1", body)
    for drawn, shown in _PAGE_COLOURS.items():
        body = body.replace(drawn, shown)
    return re.sub(r">\s*\n\s*<", "><", body)

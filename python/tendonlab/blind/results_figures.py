"""Figures of blind results: how true the stated probabilities are, and from which strength on an effect is found."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.diagnosis.answer.calibration import Calibration
from tendonlab.rehearsal.curve import clopper_pearson
from tendonlab.report.figures import Picture
from tendonlab.report.numbers import number
from tendonlab.report.plot.style import COLOURS, FIGURE, INK, MUTED, tidy

from .calibrating import Judged, stated_effects, stated_verdicts
from .results import Results

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NUM_BINS = 5  # of the stated probability
LEAST_IN_BIN = 5  # answers, below which a share says nothing


def reliability(ax: Axes, cases: Sequence[Judged], of: Calibration) -> None:
    """Share of answers that came true over the probability that the map `of` states, with 95 % intervals; on the
    diagonal the probabilities are true. `cases`: all with repeats, or all without."""
    kinds = (("verdict", stated_verdicts(cases, of), "refitted"), ("effects", stated_effects(cases, of), "with_effect"))
    ax.plot([0, 1], [0, 1], color=MUTED, lw=0.8, ls=(0, (4, 2)))
    for shift, (name, stated, colour) in zip((-0.006, 0.006), kinds, strict=True):
        rows = _bins(stated)
        if not rows:
            continue
        mean, share, low, high = np.array(rows).T
        spread = np.maximum(np.array([share - low, high - share]), 0.0)
        options = {"fmt": "o", "ms": 4, "color": COLOURS[colour], "elinewidth": 0.9, "capsize": 2}
        ax.errorbar(mean + shift, share, spread, label=f"{name} ({len(stated)})", **options)  # type: ignore[arg-type]
    tidy(ax, grid="both")
    ax.set(xlim=(-0.03, 1.03), ylim=(-0.03, 1.03), xlabel="Stated probability", ylabel="Share that came true")
    if ax.get_legend_handles_labels()[0]:
        ax.legend(loc="upper left")


def _bins(stated: Sequence[tuple[float, bool]]) -> list[tuple[float, float, float, float]]:
    """Of each bin that holds enough answers: mean stated probability, share that came true, its interval."""
    probability, came_true = (np.array(column, dtype=float) for column in zip(*stated, strict=True))
    place = np.minimum((probability * NUM_BINS).astype(int), NUM_BINS - 1)
    rows = []
    for k in range(NUM_BINS):
        here = place == k
        num, hits = int(here.sum()), int(came_true[here].sum())
        if num >= LEAST_IN_BIN:
            rows.append((float(probability[here].mean()), hits / num, *clopper_pearson(hits, num)))
    return rows


def strengths(ax: Axes, found: Results) -> None:
    """Every single effect by name over its gap/noise: filled where it was established, hollow where it was missed."""
    from matplotlib.ticker import FuncFormatter

    single = found.single()
    kinds = single["effect"].str.split(":").str[1]
    names = sorted(kinds.unique(), reverse=True)
    places = {name: row for row, name in enumerate(names)}
    for repeats, shift, mark in ((False, 0.15, "o"), (True, -0.15, "s")):
        part = single["repeats"].astype(bool) == repeats
        for hit in (True, False):
            chosen = part & (single["established"].astype(bool) == hit)
            colour = COLOURS["refitted" if hit else "with_effect"]
            rows = [places[kind] + shift for kind in kinds[chosen]]
            label = f"{'established' if hit else 'missed'}, {'with' if repeats else 'without'} repeats"
            ax.scatter(
                single.loc[chosen, "gap_noise"].astype(float),
                rows,
                s=22,
                marker=mark,
                facecolor=colour if hit else "none",
                edgecolor=colour,
                lw=1.0,
                alpha=0.85,
                label=f"{label} ({int(chosen.sum())})",
            )
    ax.set_xscale("log")
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
    tidy(ax, grid="both")
    ax.set_yticks(range(len(names)), [name.replace("_", " ") for name in names])
    ax.set(xlabel="Gap/noise of the missing effect", ylabel="Effect", ylim=(-0.6, len(names) - 0.4))
    ax.axvline(1.0, color=INK, lw=0.8, ls=(0, (2, 1.5)))
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)


def pictures(found: Results) -> list[Picture]:
    """The figures of the page: `blind-reliability` and `blind-strength`."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(FIGURE):
        true = Figure(figsize=(7.2, 3.6), layout="constrained")
        axes = true.subplots(1, 2, sharey=True)
        for ax, repeats in zip(axes, (False, True), strict=True):
            cases = [case for case in found.judged if case.repeats == repeats]
            ax.set_title("With repeats" if repeats else "Without repeats")
            if cases:
                reliability(ax, cases, found.map_of(repeats=repeats))
        num = found.single()["effect"].str.split(":").str[1].nunique()
        strong = Figure(figsize=(7.2, 1.2 + 0.3 * max(1, num)), layout="constrained")
        strengths(strong.subplots(), found)
    return [
        Picture(name="blind-reliability", alt="Share that came true over stated probability", figure=true),
        Picture(name="blind-strength", alt="Established and missed effects over their gap/noise", figure=strong),
    ]

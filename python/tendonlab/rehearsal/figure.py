"""The detection curve of one effect: the share of rigs in which it is found, by its size."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tendonlab.rehearsal.curve import TARGET, fit_curve
from tendonlab.rehearsal.words import amount_words, parameter_title
from tendonlab.report.figures import Picture
from tendonlab.report.numbers import number
from tendonlab.report.plot.style import COLOURS, FIGURE, INK, MUTED, new_axes, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tendonlab.rehearsal.tally import EffectRehearsal


def detection_curve(entry: EffectRehearsal, ax: Axes | None = None) -> Axes:
    """Share found by gap over noise, with 95 % intervals, and the curve through it, on `ax` or on new axes."""
    ax = new_axes(width=4.6, height=2.8) if ax is None else ax
    gaps = np.array([size.gap for size in entry.sizes])
    if len(gaps):
        fine = np.geomspace(gaps[0], gaps[-1], 60)
        curve = fit_curve(gaps.tolist(), [s.found for s in entry.sizes], [s.tried for s in entry.sizes])
        mean, low, high = curve.probability(fine)
        ax.fill_between(fine, low, high, color=COLOURS["refitted"], alpha=0.18, lw=0)
        ax.plot(fine, mean, color=COLOURS["refitted"], lw=1.4)
        shares = np.array([s.found / s.tried for s in entry.sizes])
        bounds = np.array([s.ci95 for s in entry.sizes]).T
        ax.errorbar(gaps, shares, np.abs(bounds - shares), fmt="o", ms=3.5, color=INK, elinewidth=0.8, capsize=2)
        ax.set_xscale("log")
        labels = [f"{number(s.gap, 2)}\n{amount_words(entry, s.amount)}" for s in entry.sizes]
        ax.set_xticks(gaps, labels)
        ax.set_xticks([], minor=True)
    ax.axhline(TARGET, color=MUTED, lw=0.8, ls=(0, (4, 2)))
    tidy(ax)
    below = f"Gap after tuning over the noise floor; below: {parameter_title(entry)}"
    ax.set(
        ylim=(-0.03, 1.03),
        xlabel=below,
        ylabel="Share found",
    )
    ax.set_yticks([0.0, 0.5, TARGET, 1.0], ["0", "0.5", "0.9", "1"])
    return ax


def pictures(entries: tuple[EffectRehearsal, ...]) -> dict[str, Picture]:
    """The curve of every effect that was tried, by the name of the effect."""
    import matplotlib
    from matplotlib.figure import Figure

    made = {}
    for place, entry in enumerate(entries):
        if not entry.sizes:
            continue
        with matplotlib.rc_context(FIGURE):
            figure = Figure(figsize=(4.6, 2.8), layout="constrained")
            detection_curve(entry, figure.subplots())
        alt = f"Share of simulated rigs in which {entry.effect} is found, by its size"
        made[entry.effect] = Picture(name=f"curve-{place}", alt=alt, figure=figure)
    return made

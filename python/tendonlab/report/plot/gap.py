"""How far: the gap of each output before tuning, after it and with the effect, over the noise floor."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from tendonlab.report.numbers import number, prefixed
from tendonlab.report.plot.style import COLOURS, INK, new_axes, tidy, wrapped
from tendonlab.report.words import STAGES, capital, words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tendonlab.report.diagnosis import Diagnosis

_BAR = 0.26
_LOG_FROM = 12.0  # ratio over the floor beyond which a linear axis would hide what is near the floor


def gap_bars(diagnosis: Diagnosis, ax: Axes | None = None) -> Axes:
    """Held-out RMS error of each output as a multiple of its noise floor (the line at 1), with the value in its unit.

    Outputs whose floor is not positive are left out: nothing can be said against them."""
    signals = [name for name, values in diagnosis.gap.items() if (values["noise_floor"] or 0.0) > 0.0]
    stages = [stage for stage in STAGES if stage != "with_effect" or diagnosis.selected]
    ax = new_axes(height=0.9 + 0.3 * len(stages) * max(1, len(signals))) if ax is None else ax
    ratios = {
        (signal, stage): (diagnosis.gap[signal][stage] or math.nan) / diagnosis.gap[signal]["noise_floor"]
        for signal in signals
        for stage in stages
    }
    finite = [ratio for ratio in ratios.values() if math.isfinite(ratio)]
    logarithmic = max(finite, default=1.0) > _LOG_FROM
    for index, stage in enumerate(stages):
        places = [row + (index - (len(stages) - 1) / 2) * _BAR for row in range(len(signals))]
        sizes = [ratios[signal, stage] for signal in signals]
        base = 1.0 if logarithmic else 0.0  # on a log axis a bar has a length only from the floor on
        ax.barh(
            places,
            [size - base for size in sizes],
            left=base,
            height=0.85 * _BAR,
            color=COLOURS[stage],
            label=capital(STAGES[stage]),
        )
        for place, size, signal in zip(places, sizes, signals, strict=True):
            if math.isfinite(size):
                _annotate(ax, diagnosis, signal=signal, stage=stage, at=(max(size, 1.0), place))
    _finish(ax, signals, largest=max(finite, default=1.0), smallest=min(finite, default=1.0), logarithmic=logarithmic)
    return ax


def _annotate(ax: Axes, diagnosis: Diagnosis, *, signal: str, stage: str, at: tuple[float, float]) -> None:
    values = diagnosis.gap[signal]
    factor, unit = prefixed(values.values(), diagnosis.units.get(signal, ""))
    text = f"{number(values[stage] * factor)} {unit}".rstrip()
    ax.annotate(text, at, xytext=(4, 0), textcoords="offset points", va="center", fontsize="small", color=INK)


def _finish(ax: Axes, signals: list[str], *, largest: float, smallest: float, logarithmic: bool) -> None:
    from matplotlib.ticker import FuncFormatter, NullFormatter

    if logarithmic:
        ax.set_xscale("log")
        ax.set_xlim(min(0.8, 0.9 * smallest), 1.9 * largest)
        ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
        ax.xaxis.set_minor_formatter(NullFormatter())
    else:
        ax.set_xlim(0.0, 1.25 * max(largest, 1.2))
    tidy(ax, grid="x")
    ax.axvline(1.0, color=INK, lw=1.1, ls=(0, (2, 1.5)), label="Noise floor")
    ax.set_yticks(range(len(signals)), [wrapped(capital(words(signal)), width=20) for signal in signals])
    ax.set_ylim(max(len(signals), 1) - 0.45, -0.55)
    ax.tick_params(axis="y", length=0)
    ax.set(xlabel="Held-out RMS error / noise floor" + (" (log scale)" if logarithmic else ""), ylabel="Output")
    ax.legend(ncols=4, loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, handlelength=1.4, frameon=False)

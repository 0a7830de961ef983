"""A held-out experiment: what was measured, what each simulator predicts and what it leaves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tendonlab.errors import ParameterError
from tendonlab.report.numbers import prefixed
from tendonlab.report.plot.style import COLOURS, DASHES, INK, MUTED, label, tidy, wrapped
from tendonlab.report.words import STAGES, capital

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tendonlab.report.diagnosis import Diagnosis, Overlay

Floats = NDArray[np.float64]
_POINTS = 110  # measured points drawn; more would hide the lines
_BINS = 420  # lines keep the two extremes of each bin, so no peak is lost
_CROSSINGS = 20  # shown at most; beyond, the swings of a run merge into a band


def overlay(
    diagnosis: Diagnosis,
    ax: Sequence[Axes] | None = None,
    *,
    signal: str | None = None,
    window: tuple[float, float] | None = None,
    experiment: str | None = None,
) -> tuple[Axes, Axes]:
    """Measured points and predicted lines (upper axes), residuals with the noise floor as a band (lower axes).

    `ax`: the upper and the lower axes; `signal`: the first one by default; `window`: (from, to) in s, the whole run by
    default; `experiment`: the held-out one that tuning leaves worst by default. Raises ParameterError if the diagnosis
    has no held-out experiment, not this one or not this signal."""
    run = _chosen(diagnosis, experiment)
    signal = next(iter(run.measured)) if signal is None else signal
    if signal not in run.measured:
        raise ParameterError(f"signal = {signal!r}: expected one of {', '.join(run.measured)}")
    upper, lower = _two_axes() if ax is None else ax
    seen = _within(run, window)
    unit = diagnosis.units.get(signal, "")
    stages = [stage for stage in STAGES if stage != "with_effect" or diagnosis.selected]
    _draw_signal(upper, run, signal=signal, stages=stages, seen=seen)
    upper.set_ylabel(label(signal, unit))
    _draw_residual(lower, run, signal=signal, stages=stages, seen=seen, unit=unit)
    lower.set_xlabel("Time (s)")
    if ax is None:
        upper.tick_params(labelbottom=False)
        upper.legend(ncols=4, loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2, frameon=False)
    return upper, lower


def draw_input(ax: Axes, run: Overlay, name: str, *, unit: str, window: tuple[float, float] | None = None) -> None:
    """What was logged of an input over the time of the run, or the `window` (from, to) of it, s."""
    seen = _within(run, window)
    ax.plot(*_thin(run.time[seen], run.inputs[name][seen]), color=INK, lw=0.9)
    ax.set_ylabel(wrapped(label(name, unit), width=14))
    ax.set_xlabel("Time (s)")
    ax.margins(x=0.01)
    tidy(ax, grid="both")


def _chosen(diagnosis: Diagnosis, experiment: str | None) -> Overlay:
    runs = [run for run in diagnosis.overlays if run.measured]
    if not runs:
        raise ParameterError("overlays: none; expected a diagnosis with a held-out experiment")
    if experiment is None:
        return runs[0]
    named = {run.name: run for run in runs}
    if experiment not in named:
        raise ParameterError(f"experiment = {experiment!r}: expected one of {', '.join(named)}")
    return named[experiment]


def _within(run: Overlay, window: tuple[float, float] | None) -> NDArray[np.bool_]:
    """Samples within the window (from, to), s; all of them without one."""
    if window is None:
        return np.full(len(run.time), True)
    return (run.time >= window[0]) & (run.time <= window[1])


def telling_window(run: Overlay) -> tuple[float, float] | None:
    """The part of a long run, from and to in s, where the refitted residual is largest; None: show all of it.

    A run is long when its first signal swings more often than the eye can follow."""
    signal, values = next(iter(run.measured.items()))
    known = np.isfinite(values)
    if known.sum() < 8:
        return None
    centred = values[known] - np.median(values[known])
    beyond = np.sign(centred) * (np.abs(centred) > 0.2 * np.std(centred))  # a dead zone, so that noise is not counted
    beyond = beyond[beyond != 0]
    crossings = int(np.count_nonzero(np.diff(beyond)))
    if crossings <= 1.5 * _CROSSINGS:
        return None
    length = (run.time[-1] - run.time[0]) * _CROSSINGS / crossings
    energy = np.nancumsum((run.measured[signal] - run.refitted[signal]) ** 2)
    starts = run.time[run.time <= run.time[-1] - length]
    gained = np.interp(starts + length, run.time, energy) - np.interp(starts, run.time, energy)
    start = float(starts[int(np.argmax(gained))])
    return start, start + float(length)


def _two_axes() -> tuple[Axes, Axes]:
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=(6.4, 4.2), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    return upper, lower


def _thin(time: Floats, values: Floats) -> tuple[Floats, Floats]:
    """At most 2 · _BINS samples: the smallest and the largest of each bin, in the order of time."""
    if len(time) <= 2 * _BINS:
        return time, values
    size = -(-len(values) // _BINS)
    bins = np.full((-(-len(values) // size), size), np.nan)
    bins.flat[: len(values)] = values
    known = np.isfinite(bins)
    extremes = np.stack([np.argmin(np.where(known, bins, np.inf), 1), np.argmax(np.where(known, bins, -np.inf), 1)], 1)
    extremes += size * np.arange(len(bins))[:, None]
    kept = np.unique(extremes[known.any(axis=1)])
    return time[kept], values[kept]


def _draw_signal(ax: Axes, run: Overlay, *, signal: str, stages: list[str], seen: NDArray[np.bool_]) -> None:
    time, measured = run.time[seen], run.measured[signal][seen]
    known = np.flatnonzero(np.isfinite(measured))
    some = known[:: max(1, len(known) // _POINTS)]
    ax.plot(time[some], measured[some], "o", ms=3.6, mfc="none", mew=0.7, color=INK, label="Measured", zorder=3)
    for stage in stages:
        ax.plot(
            *_thin(time, getattr(run, stage)[signal][seen]),
            color=COLOURS[stage],
            ls=DASHES[stage],
            lw=1.2,
            label=capital(STAGES[stage]),
        )
    ax.margins(x=0.01)
    tidy(ax, grid="both")


def _draw_residual(
    ax: Axes, run: Overlay, *, signal: str, stages: list[str], seen: NDArray[np.bool_], unit: str
) -> None:
    left = {stage: (run.measured[signal] - getattr(run, stage)[signal])[seen] for stage in stages}
    peak = {stage: float(np.nanmax(np.abs(part))) if np.isfinite(part).any() else 0.0 for stage, part in left.items()}
    floor = run.floor.get(signal) or 0.0
    limit = 1.15 * max(peak["refitted"], peak.get("with_effect", 0.0), 3.0 * floor)
    limit = max(limit, 1.1 * peak["nominal"]) if peak["nominal"] < 3.0 * limit else limit  # a far nominal is cut off
    factor, shown = prefixed([limit], unit)
    ax.axhspan(-factor * floor, factor * floor, color=MUTED, alpha=0.28, lw=0, label="Noise floor", zorder=0.5)
    for stage in stages:
        ax.plot(*_thin(run.time[seen], factor * left[stage]), color=COLOURS[stage], ls=DASHES[stage], lw=0.9)
    ax.set_ylim(-factor * limit or -1.0, factor * limit or 1.0)
    ax.set_ylabel(f"Residual\n{wrapped(f'({shown})', width=14)}" if shown else "Residual")
    ax.margins(x=0.01)
    tidy(ax, grid="both")

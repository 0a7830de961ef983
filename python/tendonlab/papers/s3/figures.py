"""The figures of S3 on axes that the caller brings; points are the twin's measurements, lines the model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.papers.s3.groups import Record
from tendonlab.papers.s3.model import Prediction
from tendonlab.papers.s3.rig import FrictionParameters, free_body
from tendonlab.papers.s3.shapes import BumpShape
from tendonlab.papers.s3.statics import TransmissionCoefficients
from tendonlab.report.plot.style import INK, MUTED, tidy

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000", "#8c564b", "#7f7f7f", "#bcbd22")
MODEL, HOLD = "#d55e00", "#f1e3c6"
SHOWN = 3  # draw every third sample of a log: the eye sees no more


def free_bodies(ax: Axes, *, reading: float) -> None:
    """Fig. 3: both pulleys, the four tensions and the load cells, which read `reading`, kg."""
    from matplotlib.patches import Circle

    force = 9.80665 * reading
    each, _ = free_body(force)
    for x, side, torque in ((0.0, "A", r"$\tau_{in}$"), (6.0, "B", r"$\tau_{out}$")):
        ax.add_patch(Circle((x, 0.0), 1.0, fill=False, lw=1.5, ec=INK))
        ax.plot(x, 0.0, "o", ms=4, color=INK)
        ax.text(x, 0.25, torque, ha="center", fontsize=11)
        ax.text(x, -0.45, f"motor {side}", ha="center", color=MUTED)
    for y, names, colour in ((1.0, ("$T_1$", "$T_2$"), COLOURS[0]), (-1.0, ("$T_3$", "$T_4$"), COLOURS[1])):
        ax.plot([0.0, 6.0], [y, y], color=colour, lw=1.0, ls=(0, (5, 3)))
        for start, end, name in ((0.0, 1.4, names[0]), (6.0, 4.6, names[1])):
            ax.annotate("", (end, y), (start, y), arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.8})
            ax.text(end, y + 0.16, name, ha="center", color=colour, fontsize=11)
    ax.text(
        3.0, 0.1, f"each sheath: length $L$, wrap angle $\\theta$\npretension $T_s$ = {each:.2f} N a cable", ha="center"
    )
    for x, direction in ((-1.0, -1.0), (7.0, 1.0)):
        end = x + 1.6 * direction
        ax.annotate("", (end, 0.0), (x, 0.0), arrowprops={"arrowstyle": "-|>", "color": COLOURS[2], "lw": 1.8})
        ax.text(x + 0.8 * direction, 0.2, f"$T_L$ = {force:.1f} N", ha="center", color=COLOURS[2])
        ax.text(x + 0.8 * direction, -0.4, f"load cell\n{reading:g} kg", ha="center", va="top", color=MUTED)
    ax.set(xlim=(-3.4, 9.4), ylim=(-1.7, 1.7), aspect="equal")
    ax.axis("off")


def shapes(ax: Axes, members: Sequence[BumpShape]) -> None:
    """Fig. 4: the sheaths in the plane."""
    for i, shape in enumerate(members):
        x, y = 100.0 * shape.curve(num_samples=301).T
        ax.plot(x, y, color=COLOURS[i], lw=1.4, label=rf"$\theta_{{{i + 1}}}$ = {shape.wrap_angle:.2f} rad")
        ax.plot(x[-1], y[-1], "o", ms=3, color=COLOURS[i])
    ax.set(xlabel="x (cm)", ylabel="y (cm)", aspect="equal")
    ax.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    tidy(ax, grid="both")


def loops(ax: Axes, records: Sequence[Record], labels: Sequence[str], *, p: FrictionParameters | None = None) -> None:
    """Output over input torque, after the first quarter period; with `p` the two branches of S3 eq. 18 as lines."""
    for record, label, colour in zip(records, labels, COLOURS, strict=False):
        log = _settled(record)
        ax.plot(log["tau_in"], log["tau_out"], ".", ms=2.0, color=colour, label=label, rasterized=True)
        if p is not None:
            law = TransmissionCoefficients.of(
                record.shape, mu=p.mu_d, T_s=record.pretension, r_in=0.05, r_out=0.05
            )  # fmt: skip
            ends = np.array([log["tau_in"].min(), log["tau_in"].max()])
            for direction in (1, -1):
                ax.plot(ends, law.output_torque(ends, direction=direction), color=colour, lw=0.9, ls=(0, (4, 2)))
    ax.set(xlabel=r"$\tau_{in}$ (N·m)", ylabel=r"$\tau_{out}$ (N·m)")
    ax.legend(fontsize=8, markerscale=4, frameon=False)
    tidy(ax, grid="both")


def friction_torque(ax: Axes, records: Sequence[Record], labels: Sequence[str]) -> None:
    """Friction torque tau_in - tau_out over the velocity of motor A."""
    for record, label, colour in zip(records, labels, COLOURS, strict=False):
        log = _settled(record)
        ax.plot(log["v"], log["tau_in"] - log["tau_out"], ".", ms=2.0, color=colour, label=label, rasterized=True)
    ax.set(xlabel="velocity of motor A (deg/s)", ylabel=r"$\tau_{in}-\tau_{out}$ (N·m)")
    ax.legend(fontsize=8, markerscale=4, frameon=False)
    tidy(ax, grid="both")


def holds(ax: Axes, record: Record, *, speed: float) -> None:
    """Shades where the drive is slower than `speed`, deg/s, while the output is constant."""
    time, slow = record.log.index.to_numpy(), (record.log["v"].abs() < speed).to_numpy()
    edges = np.flatnonzero(np.diff(np.concatenate(([0], slow.astype(int), [0]))))
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        if end - start > 20:  # not where noise alone makes it slow
            ax.axvspan(time[start], time[end - 1], color=HOLD, lw=0)


def in_time(ax: Axes, record: Record, *, label: str = r"$\tau_{out}$", colour: str = COLOURS[0]) -> None:
    """Input and output torque over time."""
    ax.plot(record.log.index, record.log["tau_in"], color=MUTED, lw=1.0, label=r"$\tau_{in}$")
    shown = record.log.iloc[::SHOWN]
    ax.plot(shown.index, shown["tau_out"], ".", ms=2.0, color=colour, label=label, rasterized=True)
    ax.set(xlabel="time (s)", ylabel="torque (N·m)")
    ax.margins(x=0.01, y=0.2)
    tidy(ax)


def compared(axes: Sequence[Axes], record: Record, prediction: Prediction, *, title: str) -> None:
    """Measured and predicted output over time, and their difference, on two axes."""
    ax, left = axes
    time, measured = record.log.index.to_numpy(), record.log["tau_out"].to_numpy()
    ax.plot(time[::SHOWN], record.log["tau_in"].iloc[::SHOWN], color="#b8c0c8", lw=1.0, label=r"$\tau_{in}$")
    ax.plot(time[::SHOWN], measured[::SHOWN], ".", ms=2.0, color=INK, rasterized=True, label=r"$\tau_{out}$, twin")
    ax.plot(time[::SHOWN], prediction.tau_out[::SHOWN], color=MODEL, lw=1.2, label=r"$\tau_{out}$, model")
    ax.set(xlabel="time (s)", ylabel="torque (N·m)", title=title)
    ax.margins(x=0.01, y=0.2)
    error = measured - prediction.tau_out
    left.plot(time[:: 2 * SHOWN], error[:: 2 * SHOWN], ".", ms=1.5, color=INK, rasterized=True)
    left.axhline(0.0, color=MODEL, lw=1.2)
    left.set(xlabel="time (s)", ylabel="twin less model (N·m)", ylim=(-2.0, 2.0), title="difference (twin)")
    left.locator_params(axis="x", nbins=5)
    for one in axes:
        tidy(one)


def _settled(record: Record) -> pd.DataFrame:
    """Every third sample of the log after its first quarter period, the start from rest."""
    return record.log.loc[0.25 * record.trajectory.period :].iloc[::SHOWN]

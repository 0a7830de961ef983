"""The work–precision figure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.accuracy import Setting

OUT = Path(__file__).resolve().parents[2] / "out" / "work-precision.svg"  # `--write` copies it into docs/figures

OURS = "tendonlab"


def draw(problems: Mapping[str, Mapping[str, Sequence[Setting]]], out: Path = OUT) -> Path:
    """An axis per problem: error against CPU time of every setting that was tried, a line per tool."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "work-precision"})
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, len(problems), figsize=(4.2 * len(problems), 4.2), squeeze=False, sharex=True)
    for ax, (name, tools) in zip(axes[0], problems.items(), strict=True):
        for tool, settings in tools.items():
            done = [s for s in settings if s.error > 0]
            width = 2.0 if tool == OURS else 0.8
            ax.loglog([s.error for s in done], [1e3 * s.seconds for s in done], ".-", lw=width, label=tool)
        ax.set(title=name, xlabel="relative error (rms)", xlim=(1e-1, 1e-8))
    axes[0][0].set_ylabel("CPU time of one simulation (ms)")
    figure.legend(*axes[0][0].get_legend_handles_labels(), loc="upper center", bbox_to_anchor=(0.5, 0.0), ncol=4)
    out.parent.mkdir(exist_ok=True)
    figure.savefig(out, bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)
    return out

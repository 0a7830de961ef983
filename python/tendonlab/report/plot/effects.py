"""Which: the candidate effects by probability."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tendonlab.report.numbers import estimate, probability, unit_text
from tendonlab.report.plot.style import COLOURS, INK, MUTED, new_axes, tidy, wrapped
from tendonlab.report.words import capital, parameter_words, phrase

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tendonlab.report.diagnosis import Diagnosis, EffectFinding

_LINES = 2  # parameters below a bar
_LEAST = 0.005  # probability below which a candidate is not drawn, unless it is selected


def ranked_effects(diagnosis: Diagnosis, ax: Axes | None = None, *, count: int = 6) -> Axes:
    """The likely effects, at most `count`, as bars, those selected in orange, with parameters and 95 % intervals."""
    shown = likely(diagnosis, count=count)
    ax = new_axes(width=7.0, height=height(diagnosis, count=count)) if ax is None else ax
    for row, finding in enumerate(shown):
        chosen = finding.name in diagnosis.selected
        ax.barh(row - 0.14, finding.probability, height=0.34, color=COLOURS["with_effect" if chosen else "nominal"])
        ax.annotate(
            probability(finding.probability),
            (finding.probability, row - 0.14),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            color=INK,
        )
        ax.annotate(
            _parameters(finding),
            (0.0, row + 0.06),
            xytext=(2, -2),
            textcoords="offset points",
            va="top",
            fontsize="small",
            linespacing=1.25,
            color=MUTED,
        )
    tidy(ax, grid="x")
    ax.set(xlim=(0.0, 1.12), xlabel="Probability that it is part of the cause", ylabel="Effect")
    ax.set_xticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0", "0.25", "0.5", "0.75", "1"])
    names = [capital(phrase(finding.name, diagnosis.system)) for finding in shown]
    ax.set_yticks(range(len(shown)), [wrapped(name, width=32) for name in names])
    ax.set_ylim(max(len(shown), 1) - 0.35, -0.5)
    ax.tick_params(axis="y", length=0)
    if not shown:
        ax.annotate("No candidate was considered", (0.5, 0.5), xycoords="axes fraction", ha="center", color=MUTED)
    return ax


def likely(diagnosis: Diagnosis, *, count: int = 6) -> tuple[EffectFinding, ...]:
    """The candidates worth drawing: those not ruled out, the two best in any case."""
    ranked = enumerate(diagnosis.effects)
    kept = [e for place, e in ranked if place < 2 or e.probability >= _LEAST or e.name in diagnosis.selected]
    return tuple(kept[:count])


def height(diagnosis: Diagnosis, *, count: int = 6) -> float:
    """Inches that a figure of `ranked_effects` needs."""
    return 0.8 + 0.65 * max(1, len(likely(diagnosis, count=count)))


def _parameters(finding: EffectFinding) -> str:
    texts = []
    for name, found in list(finding.parameters.items())[:_LINES]:
        told, between = estimate(found["value"], found.get("ci95"), 2)
        interval = f" ({between})" if between else ""
        title = parameter_words(name, element=finding.element)
        texts.append(f"{title} {told}{interval} {unit_text(found.get('unit', ''))}".rstrip())
    further = len(finding.parameters) - len(texts)
    return "\n".join(texts) + (f"; {further} more" if further > 0 else "")

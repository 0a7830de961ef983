"""Results as plain text, for a terminal or a pipe."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from tendonlab.diagnosis.confusions import confusions
from tendonlab.report.numbers import counted, estimate, number, prefixed, unit_text
from tendonlab.report.words import listing
from tendonlab.simulation.catalog import parameter_unit, unit
from tendonlab.simulation.prepare import choose_loop

if TYPE_CHECKING:
    from tendonlab.checking.finding import Check, Finding
    from tendonlab.data import Experiment
    from tendonlab.identification.result import Identification
    from tendonlab.simulation.catalog import EffectInfo, SystemInfo
    from tendonlab.simulation.system import System
    from tendonlab.simulation.trajectory import Trajectory

WIDEST = 110  # columns: longer lines are hard to read, however wide the terminal
_CLOSE = 0.95  # correlation of two fitted parameters beyond which the data hardly tell them apart


def width() -> int:
    """Columns to fill: the terminal's, or 100 in a pipe."""
    return max(40, min(WIDEST, shutil.get_terminal_size((100, 24)).columns))


def wrapped(text: str, *, indent: str = "", hanging: str | None = None) -> str:
    """`text` filled to the width; `indent` before the first line, `hanging` (or `indent`) before the others."""
    after = indent if hanging is None else hanging
    return textwrap.fill(
        text,
        width(),
        initial_indent=indent,
        subsequent_indent=after,
        break_long_words=False,
        break_on_hyphens=False,  # names such as run-01 stay whole
    )


def table(rows: Sequence[Sequence[str]], *, right: Iterable[int] = (), indent: str = "  ") -> str:
    """Columns two blanks apart; those in `right` end flush. The first row is the header."""
    flush = set(right)
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = [c.rjust(w) if i in flush else c.ljust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))]
        lines.append((indent + "  ".join(cells)).rstrip())
    return "\n".join(lines)


def bullets(title: str, items: Sequence[str], *, numbered: bool = False) -> str:
    """A list below its title, which may be empty; nothing where there are no items."""
    if not items:
        return ""
    marks = [f"{place}." if numbered else "-" for place in range(1, len(items) + 1)]
    lines = [
        wrapped(item, indent=f"  {mark} ", hanging=" " * (3 + len(mark)))
        for mark, item in zip(marks, items, strict=True)
    ]
    return "\n".join([title, *lines] if title else lines)


def check_text(found: Check, assumed: Sequence[str] = ()) -> str:
    """What the check of the logs found: first what must be corrected, then what a diagnosis copes with, and what was
    `assumed` when they were read."""
    blocking = [_finding(f) for f in found.findings if f.blocks]
    others = _together([f for f in found.findings if not f.blocks])
    verdict = (
        "The logs must be corrected before a diagnosis." if blocking else "Nothing in the logs forbids a diagnosis."
    )
    parts = [
        wrapped(f"{found.dataset}: {verdict}"),
        bullets("Correct first", blocking),
        bullets("Noted", others),
        bullets("Assumed", assumed),
        bullets("Not checked", found.notes),
    ]
    return "\n\n".join(part for part in parts if part)


def _together(findings: Sequence[Finding]) -> list[str]:
    """The findings, each detail once, with the experiments that share it."""
    alike: dict[tuple[str, str, str | None], list[Finding]] = {}
    for finding in findings:
        alike.setdefault((finding.problem, finding.detail, finding.signal), []).append(finding)
    return [_finding(first, [str(f.experiment) for f in more]) for first, *more in alike.values()]


def _finding(finding: Finding, others: Sequence[str] = ()) -> str:
    parts = [part for part in (finding.place, f"alike in {', '.join(others)}" if others else "") if part]
    place = f" ({'; '.join(parts)})" if parts else ""
    return f"{finding.problem}{place}: {finding.detail}"


def identification_text(fit: Identification) -> str:
    """The fitted parameters, one per line, and what deserves a second look."""
    rows = [["parameter", "nominal", "fitted", "95 %", "unit", ""]]
    for name, row in fit.parameters.iterrows():
        shown = [float(row[key]) for key in ("nominal", "value", "ci95_lower", "ci95_upper")]
        factor, unit = prefixed(shown, str(row["unit"]))
        nominal, value, lower, upper = (factor * each for each in shown)
        doubt = "at its bound" if row["at_bound"] else "" if row["informed"] else "held: a small change has no effect"
        rows.append([str(name), number(nominal), *estimate(value, [lower, upper]), unit, doubt])
    num = len(fit.residuals)
    fitted = f"{num} experiments fitted together" if num > 1 else "1 experiment fitted"
    work = counted(fit.num_iterations, "iteration")
    state = f"Converged after {work}" if fit.converged else f"Not converged: {fit.message}"
    summary = f"{state}; {fitted}."
    tied = bullets("Hard to tell apart", _correlated(fit))
    parts = [wrapped(summary), table(rows, right=(1, 2)), _fit_errors(fit), tied, bullets("Notes", fit.warnings)]
    return "\n\n".join(part for part in parts if part)


def _fit_errors(fit: Identification) -> str:
    """What the fit leaves of each output, beside how much it moves; and what to do where it leaves all of it."""
    rows = [["signal", "unit", "RMS error", "RMS about its mean"]]
    for signal, row in fit.errors.iterrows():
        factor, unit = prefixed([row["rms_error"], row["spread"]], str(row["unit"]))
        rows.append([str(signal), unit, number(factor * row["rms_error"]), number(factor * row["spread"])])
    advice = "is predicted hardly better than by a constant; other nominal values or more starts may find a better fit"
    doubt = "\n".join(wrapped(f"{name} {advice}", indent="  ") for name in fit.missed)
    return "\n".join(part for part in ("Error of the fit", table(rows, right=(2, 3)), doubt) if part)


def _correlated(fit: Identification) -> list[str]:
    names, r = list(fit.correlations.columns), fit.correlations.to_numpy(dtype=float)
    pairs = [(i, j) for i in range(len(names)) for j in range(i + 1, len(names)) if abs(r[i, j]) > _CLOSE]
    close = sorted(pairs, key=lambda pair: -abs(float(r[pair])))
    return [f"{names[i]} and {names[j]}: correlation {r[i, j]:.3f}".replace("-", "−") for i, j in close]


def errors_text(run: Trajectory, experiment: Experiment) -> str:
    """How far a simulated experiment is from what was measured, one output per line."""
    rows = [["signal", "unit", "RMS error", "RMS measured", "largest error"]]
    for signal in run.outputs.columns:
        if signal not in experiment.data.columns:
            continue
        measured = experiment.data[signal]
        error = run.outputs[signal] - measured
        shown = [float((error**2).mean() ** 0.5), float((measured**2).mean() ** 0.5), float(error.abs().max())]
        factor, unit = prefixed(shown, run.units[signal])
        rows.append([str(signal), unit, *(number(factor * value) for value in shown)])
    return table(rows, right=range(2, 5))


def replay_text(system: System, experiment: Experiment) -> str:
    """How `tendonlab simulate` replays an experiment, and how that differs from a diagnosis."""
    if choose_loop(experiment, system.controller, "auto").kind == "controller":
        return wrapped("Replayed in the closed loop of the known controller.")
    if not system.info.commanded:
        return wrapped("Replayed from the logged inputs alone.")
    text = "Replayed from the logged command alone: errors add up, and where a joint sticks they stay."
    return wrapped(f"{text} A diagnosis pulls the simulated motor to the measured one.")


def system_text(info: SystemInfo, *, axis: str) -> str:
    """A system: equation, signals and parameters with their units, what its simulator contains, and all effects."""
    lines = [f"{info.kind}: units of a {axis} axis"]
    lines += [wrapped(part.strip(), indent="  ", hanging=" " * 6) for part in info.equation.split(";")]
    optional = {s.name for s in info.inputs if not s.required}
    for title, signals in (("inputs", info.inputs), ("outputs", info.outputs)):
        rows = [(s.name, unit(s.dimension, axis), s.meaning, ", optional" * (s.name in optional)) for s in signals]
        lines += [f"  {title}", *(_named(name, of, f"{meaning}{aside}") for name, of, meaning, aside in rows)]
    own = [info.parameter(name) for name in _nominal_parameters(info)]
    lines += ["  parameters", *(_named(row.name, parameter_unit(info, row, axis), row.meaning) for row in own)]
    nominal = listing(info.default_nominal_effects) or "no effect"
    contains = f"contains {nominal}, unless the dataset says otherwise"
    effects = f"effects: {', '.join(e.name for e in info.effects if not e.structural)}"
    return "\n".join([*lines, *(wrapped(text, indent="  ", hanging=" " * 6) for text in (contains, effects))])


def _named(name: str, unit: str, meaning: str) -> str:
    """A line of a list: "- joint_inertia (kg·m²): what it is"."""
    shown = unit_text(unit)
    return wrapped(f"{name} ({shown}): {meaning}" if shown else f"{name}: {meaning}", indent="    - ", hanging=" " * 6)


def effects_text(info: SystemInfo, *, axis: str) -> str:
    """The effects of a system: equation, source, parameters with units, and what is easily mistaken for what."""
    heading = f"{info.kind}: effects as element:effect, units of a {axis} axis"
    optional = [effect for effect in info.effects if not effect.structural]
    return "\n\n".join([heading, *(_effect_entry(info, effect, axis) for effect in optional)])


def _effect_entry(info: SystemInfo, effect: EffectInfo, axis: str) -> str:
    nominal = effect.name in info.default_nominal_effects
    lines = [
        f"  {effect.name}{'  (in the simulator unless the dataset says otherwise)' if nominal else ''}",
        wrapped(f"{effect.equation}   [{effect.source}]", indent="    "),
        wrapped(effect.summary, indent="    "),
    ]
    for name in effect.parameters:
        row = info.parameter(name)
        lines.append(_named(name, parameter_unit(info, row, axis), row.meaning))
    for confusion in confusions(info, effect.name):
        others = listing(confusion.effects, last="or")
        lines.append(
            wrapped(f"easily mistaken for {others}; what separates them: {confusion.separates}", indent="    ")
        )
    return "\n".join(lines)


def _nominal_parameters(info: SystemInfo) -> list[str]:
    own = {name for effect in info.default_nominal_effects for name in info.effect(effect).parameters}
    structural = {name for effect in info.effects if effect.structural for name in effect.parameters}
    return [p.name for p in info.parameters if p.effect is None or p.name in own | structural]

"""How far: the held-out gap before tuning, after it and with the effect, against the noise floor."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from tendonlab.report import numbers
from tendonlab.report.blocks import Block, Cell, Figure, Table, Text
from tendonlab.report.diagnosis import Diagnosis, Overlay
from tendonlab.report.words import STAGES, capital, phrases, words


def extent(diagnosis: Diagnosis) -> list[Block]:
    """Errors of each output, the worst experiment drawn, all experiments listed and folded away, and a further table
    where there is one."""
    blocks: list[Block] = [Figure(name="gap")]
    if diagnosis.gap:
        blocks += [_errors(diagnosis), Text(text=_stages_explained(diagnosis), note=True)]
    else:
        blocks.append(Text(text="No output could be scored."))
    runs = _runs(diagnosis)
    blocks += runs[:1]
    if len(diagnosis.held_out):
        blocks += [_experiments(diagnosis), Text(text=_EXPERIMENTS, note=True)]
    return [*blocks, *runs[1:], *_side_table(diagnosis)]


_EXPERIMENTS = (
    "Gap over all outputs in multiples of the noise floor, the floor itself subtracted. Shrinkage: from refitted to "
    "with effect."
)


def _errors(diagnosis: Diagnosis) -> Table:
    rows = [_error_row(diagnosis, signal, values) for signal, values in diagnosis.gap.items()]
    stages = [capital(text) for text in STAGES.values()]
    columns = ("RMS error", "Noise floor", *stages, "Left, in floors")
    return Table(columns=columns, rows=rows, right=frozenset(range(1, 6)), spare=frozenset({5}), brief=True)


def _error_row(diagnosis: Diagnosis, signal: str, values: Mapping[str, float]) -> list[Cell]:
    factor, unit = numbers.prefixed(values.values(), diagnosis.units.get(signal, ""))
    shown = {key: numbers.number(None if value is None else factor * value) for key, value in values.items()}
    floor, last = values["noise_floor"], values["with_effect" if diagnosis.selected else "refitted"]
    left = last / floor if floor and last is not None and math.isfinite(last) else None
    return [
        Cell(capital(words(signal)), soft=f"({unit})" if unit else ""),
        Cell(shown["noise_floor"]),
        Cell(shown["nominal"]),
        Cell(shown["refitted"]),
        Cell(shown["with_effect"], bold=True) if diagnosis.selected else Cell(numbers.ABSENT),
        Cell(numbers.number(left)),
    ]


def _stages_explained(diagnosis: Diagnosis) -> str:
    added = f"With effect: {phrases(diagnosis.selected, diagnosis.system)} added." if diagnosis.selected else ""
    return (
        "Nominal: the simulator as stated. Refitted: its free parameters re-identified and no effect added, which is "
        f"what tuning alone can do. {added or 'No effect was added.'}"
    )


def _runs(diagnosis: Diagnosis) -> list[Figure]:
    """The held-out experiments, all but the first one folded."""
    from tendonlab.report.figures import overlay_name, shown_runs

    return [
        Figure(
            name=overlay_name(place),
            caption=_overlay_caption(run),
            folded="" if place == 0 else f"Held-out experiment {run.name}, drawn",
        )
        for place, run in enumerate(shown_runs(diagnosis))
    ]


def _overlay_caption(run: Overlay) -> str:
    """What the figure shows of the held-out experiment, and what it leaves out."""
    from tendonlab.report.figures import MOST_DRAWN
    from tendonlab.report.plot.runs import telling_window

    window, hidden = telling_window(run), len(run.measured) - MOST_DRAWN
    part = f" Shown: {numbers.span(window)} s of the run, where the refitted residual is largest." if window else ""
    most = f" The {MOST_DRAWN} outputs that carry most of the gap are drawn." if hidden > 0 else ""
    inputs = " At the bottom: the logged inputs." if run.inputs else ""
    return (
        f"Held-out experiment {run.name}: measurements as points, predictions as lines. Below each signal: the "
        "residuals, with the noise floor as a band. A nominal residual far larger than the others is cut off."
        f"{inputs}{part}{most}"
    )


def _experiments(diagnosis: Diagnosis) -> Table:
    rows = []
    for name, row in diagnosis.held_out.iterrows():
        nominal, before, after = (float(row[stage]) for stage in STAGES)
        shrinkage = 1.0 - after / before if before > 0 else None
        chosen = [numbers.number(after), numbers.percent(shrinkage)] if diagnosis.selected else [numbers.ABSENT] * 2
        rows.append([Cell(text) for text in (str(name), numbers.number(nominal), numbers.number(before), *chosen)])
    columns = ("Experiment", *(capital(text) for text in STAGES.values()), "Shrinkage")
    return Table(title="Each held-out experiment", columns=columns, rows=rows, right=frozenset(range(1, 5)))


def _side_table(diagnosis: Diagnosis) -> list[Block]:
    side = diagnosis.table
    if side is None:
        return []
    frame = side.frame.reset_index() if side.frame.index.name is not None else side.frame
    values = [list(row) for row in frame.itertuples(index=False, name=None)]
    right = frozenset(k for k, value in enumerate(values[0] if values else ()) if _is_number(value))
    rows = [[Cell(numbers.number(float(v), 4) if _is_number(v) else str(v)) for v in row] for row in values]
    table = Table(columns=[str(column) for column in frame.columns], rows=rows, right=right)
    return [Text(title=side.title, text=side.note, note=True), table]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)

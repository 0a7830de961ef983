"""Every held-out experiment as the report draws it: what was logged, and what three simulators predict."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tendonlab.diagnosis.answer.judged import Judged
from tendonlab.fitting.case import Case
from tendonlab.fitting.noise import Floor
from tendonlab.report.diagnosis import Overlay


def overlays(of: Judged) -> tuple[Overlay, ...]:
    """The experiments that judge, the one on which the refitted simulator is worst first, then as they were logged."""
    measured = of.case.measured
    scale = of.floor.rms[measured, None]
    squares = [float(np.nanmean(np.square(r[measured] / scale))) for r in of.stages["refitted"].residuals]
    worst = int(np.argmax(squares))
    order = [worst, *(k for k in range(len(of.experiments)) if k != worst)]
    rows = ({stage: run.outputs[k] for stage, run in of.stages.items()} for k in order)
    return tuple(_overlay(of.case, row, of.floor, of.experiments[k]) for k, row in zip(order, rows, strict=True))


def _overlay(case: Case, predicted: Mapping[str, np.ndarray], floor: Floor, i: int) -> Overlay:
    """Experiment i with the outputs `predicted` at each stage."""
    ready, experiment = case.prepared[i], case.experiments[i]

    def by_signal(rows: np.ndarray) -> dict[str, np.ndarray]:
        return {case.outputs[c]: rows[c] for c in case.measured}

    controller = case.system.controller
    given = [signal.name for signal in case.system.info.inputs] + ([controller.reference] if controller else [])
    logged = [name for name in given if name in experiment.data.columns]
    return Overlay(
        name=ready.name,
        time=np.asarray(experiment.time),
        measured=by_signal(ready.measured),
        nominal=by_signal(predicted["nominal"]),
        refitted=by_signal(predicted["refitted"]),
        with_effect=by_signal(predicted["with_effect"]),
        floor={case.outputs[c]: float(floor.rms[c]) for c in case.measured},
        inputs={name: experiment.data[name].to_numpy(dtype=float) for name in logged},
    )

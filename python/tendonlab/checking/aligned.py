"""Late experiments, confirmed by the simulator: on one clock it must follow their logs better.

The equation of motion alone may be misled: where friction sticks and slips along a slow motion, noise of a sensor, or
friction of another form, resembles a lag."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np

from tendonlab import _core
from tendonlab.checking.clocks import ALIGN
from tendonlab.checking.finding import Finding
from tendonlab.data import Dataset, Experiment
from tendonlab.errors import DatasetError, NumericalError, ParameterError
from tendonlab.fitting.case import Case, make_case
from tendonlab.fitting.problem import initial_state
from tendonlab.fitting.rough import rough_fit
from tendonlab.fitting.thinning import thinned
from tendonlab.simulation.system import System

MENDED = 0.5  # share of its mean square error that the simulator must at most leave once the outputs are on one clock
NUM_FITTED = 4  # other experiments to which the simulator is fitted first
REFUTED = "but on one clock the simulator follows this experiment hardly better, so nothing has to be corrected"


def confirmed(found: Sequence[Finding], dataset: Dataset, system: System, *, if_unable: bool = True) -> list[Finding]:
    """The findings, where a late experiment blocks only if the simulator, fitted roughly to other
    experiments, follows it better on one clock. `if_unable`: whether what cannot be simulated blocks."""
    if not any(map(_is_late, found)):
        return list(found)
    judged: list[Finding] = []
    for name, group in groupby(found, _late_experiment):
        of = list(group)
        if name and not _is_mended(of, name, dataset, system, if_unable=if_unable):
            of = [replace(f, blocks=False, detail=f.detail.replace(ALIGN, REFUTED)) for f in of]
        judged += of
    return judged


def _is_late(finding: Finding) -> bool:
    return bool(finding.blocks and finding.problem == "clock" and finding.experiment and finding.seconds)


def _late_experiment(finding: Finding) -> str:
    return str(finding.experiment) if _is_late(finding) else ""


def _is_mended(late: Sequence[Finding], name: str, dataset: Dataset, system: System, *, if_unable: bool) -> bool:
    """Whether the simulator leaves much less of the experiment `name` without the lags that were found in it."""
    try:
        few = thinned(dataset, system)
        case = make_case(_others(few, name), system)
        model = rough_fit(case, _core.Cancel()).system
        as_logged, aligned = (_error(case.playing(e), model) for e in _on_two_clocks(few[name], late, case))
    except (DatasetError, NumericalError, ParameterError):
        return if_unable
    return aligned < MENDED * as_logged


def _others(dataset: Dataset, name: str) -> Dataset:
    """A few of the other experiments, those that train before those held out; all of them train."""
    kept = sorted((e for e in dataset if e.name != name), key=lambda e: e.split != "train")[:NUM_FITTED]
    return replace(dataset, experiments=tuple(replace(e, split="train") for e in kept))


def _on_two_clocks(experiment: Experiment, late: Sequence[Finding], case: Case) -> tuple[Experiment, Experiment]:
    """The experiment as it was logged, and with its late outputs earlier: the samples that both of them know."""
    time, aligned = experiment.time, experiment.data.copy()
    known = np.ones(len(time), dtype=bool)
    for finding in late:
        seconds = float(finding.seconds or 0.0)
        names = [finding.signal] if finding.signal else [case.outputs[c] for c in case.measured]
        for column in names:
            aligned[column] = np.interp(time + seconds, time, aligned[column].to_numpy(dtype=float))
        known &= (time + seconds >= time[0]) & (time + seconds <= time[-1])
    return replace(experiment, data=experiment.data[known]), replace(experiment, data=aligned[known])


def _error(case: Case, model: System) -> float:
    """Mean square error of the model over the sensors' noise, of a case with one experiment."""
    outputs = case.run(0, model, initial_state(case, model, 0))["outputs"]
    error = (outputs - case.prepared[0].measured)[case.measured] / case.noise[case.measured, None]
    return float(np.nanmean(np.square(error)))

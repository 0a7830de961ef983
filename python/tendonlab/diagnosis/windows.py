"""Short windows: experiments cut into parts that each begin from the measured motion, where the errors of whole runs
remember for so long that they hardly count."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from tendonlab.checking.samples import FEWEST
from tendonlab.data import Dataset, Experiment
from tendonlab.diagnosis.search.select import Search

WINDOW = 1.0  # s
FEW = 8.0  # samples of an experiment that count as independent, below which its parts tell more
LARGE = 8.0  # times the floor (mean square) that the model must leave: below, what it leaves may be noise
PART = " (part "  # after the name of an experiment
WORDS = (
    "Whole runs of the simulator err for seconds at a time, so that {:.0f} samples of them count as independent. So "
    "models were weighed by parts of {:g} s, each from the motion measured at its beginning; held-out errors are those "
    "of whole runs."
)


def in_windows(dataset: Dataset, search: Search) -> tuple[Dataset, str] | None:
    """The training experiments in parts, and a warning that says so; None where whole runs tell enough: an effect was
    established, the rig is replayed from its logged motion, repeats tell what is noise, or little is left. Friction
    that changes over the session shows in whole experiments."""
    case, model = search.fitter.case, search.final
    whole = search.selected or case.replay.kind != "free" or search.fitter.floor.repeated or not case.system.info.dof
    if whole or model.mean_square < LARGE or any(e.start is not None for e in dataset.experiments):
        return None
    count = sum(float(np.sum(model.shares[run.output])) for run in model.runs)
    if count > FEW * len(model.runs):
        return None
    parts = tuple(part for e in dataset.experiments for part in (_parts(e) if e.split == "train" else [e]))
    return replace(dataset, experiments=parts), WORDS.format(count, WINDOW)


def _parts(experiment: Experiment) -> Iterator[Experiment]:
    """The experiment in parts of about `WINDOW`; samples between two belong to both. What was stated of the beginning
    holds in the first part alone. Parts repeat nothing: each is another piece of the motion."""
    num = min(max(1, round(experiment.duration / WINDOW)), max(1, len(experiment.data) // (2 * FEWEST)))
    ends = np.linspace(0, len(experiment.data) - 1, num + 1).astype(int)
    for k, (first, last) in enumerate(pairwise(ends)):
        part = replace(experiment, name=f"{experiment.name}{PART}{k + 1})", data=experiment.data.iloc[first : last + 1])
        yield replace(part, initial=experiment.initial if k == 0 else {}, repeat=None)

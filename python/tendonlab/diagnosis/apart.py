"""A training experiment that holds most of what a model leaves, and so decides every fit.

Where a slow motion sticks and slips, a small change of friction moves every slip. The error of such a run has many
optima, and fits that include the run end far from the one that suits the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tendonlab.data import Dataset
from tendonlab.diagnosis.search.select import Search
from tendonlab.diagnosis.windows import LARGE
from tendonlab.errors import NumericalError
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import PLAIN

MOST = 0.7  # share of the cost that the run must hold
FEWEST = 4  # other training experiments, which can decide
HALF = 0.5  # share that a model found without the run must at most leave, of the others as of the run itself
APART = (
    "{} alone held {:.0f} % of the error that remained, so effects were sought in the other experiments. There {} {} "
    "found, and the error in {} falls by more than half as well. All numbers are those of the other experiments."
)


def without_run_apart(dataset: Dataset, search: Search) -> tuple[Dataset, str] | None:
    """The dataset without the training experiment that stands apart, and the name of that; None where none does."""
    left = _left(search.final)
    k = int(np.argmax(left))
    if search.final.mean_square < LARGE or len(left) <= FEWEST or left[k] < MOST * left.sum():
        return None
    name = _names(search)[k]
    return replace(dataset, experiments=tuple(e for e in dataset.experiments if e.name != name)), name


def told_without(name: str, before: Search, after: Search) -> str:
    """What to tell the reader where the search `after`, without the experiment `name`, found effects that leave much
    less both of that experiment and of the others; else ""."""
    left, k = _left(before.final), _names(before).index(name)
    if not after.selected or _left(after.final).sum() > HALF * np.delete(left, k).sum():
        return ""
    if _left_of(before, after, k) > HALF * left[k]:
        return ""
    found = " and ".join(after.selected)
    return APART.format(name, 100.0 * left[k] / left.sum(), found, "was" if len(after.selected) == 1 else "were", name)


def _names(search: Search) -> list[str]:
    case = search.fitter.case
    return [case.experiments[i].name for i in case.train]


def _left(model: Fitted) -> np.ndarray:
    """Sum of squares that the model leaves of each training experiment, in units of the known noise."""
    scale = model.levels / np.where(model.known > 0, model.known, 1.0)
    return np.array([float(np.sum(np.square(run.residual * scale[run.output]))) for run in model.runs])


def _left_of(before: Search, after: Search, k: int) -> float:
    """The same that the model of the search `after` leaves of training run k of the search `before`, fitted in what the
    run has of its own; inf where the model cannot be simulated there."""
    case = before.fitter.case
    alone = replace(before.fitter, case=case.training_on([case.train[k]]))
    try:
        return float(_left(alone.fit(after.final.system, known=True, tolerance=PLAIN))[0])
    except NumericalError:
        return float("inf")

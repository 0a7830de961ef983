"""Experiments that are late once the effects named are simulated: a large effect hides a lag from the check."""

from __future__ import annotations

from dataclasses import replace

from tendonlab.checking.check import late_experiments
from tendonlab.checking.finding import Check
from tendonlab.data import Dataset
from tendonlab.diagnosis.answer.heldout import level, replay
from tendonlab.diagnosis.search.select import Search
from tendonlab.diagnosis.windows import is_part_of
from tendonlab.errors import NumericalError

LATE = "The check of the logs alone saw no late experiment: the lag shows once {} is simulated."
PREDICTED = 1.15  # mean square over the floor, up to which an experiment is predicted as it was logged


def checked_again(found: Check, dataset: Dataset, search: Search) -> Check:
    """What the check `found`, with the experiments that are late once the effects named are simulated. The equation
    knows inputs and outputs smoothed alone; an experiment that the model predicts without a lag is not late."""
    if found.blocks or not search.selected:
        return found
    late = late_experiments(dataset, search.final.system)
    late = tuple(finding for finding in late if not _is_predicted(str(finding.experiment), search))
    notes = (*found.notes, LATE.format(" and ".join(search.selected))) if late else found.notes
    return replace(found, findings=(*late, *found.findings), notes=notes)


def _is_predicted(experiment: str, search: Search) -> bool:
    """Whether the model that came out leaves no more than noise of an experiment."""
    case = search.fitter.case
    runs = [i for i, each in enumerate(case.experiments) if is_part_of(each.name, experiment)]
    try:
        return level(replay(case, [search.final.system] * len(runs), runs), search.fitter.floor) < PREDICTED
    except NumericalError:
        return False

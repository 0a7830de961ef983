"""Experiments that are late once the effects named are simulated: a large effect hides a lag from the check."""

from __future__ import annotations

from dataclasses import replace

from tendonlab.checking.check import late_experiments
from tendonlab.checking.finding import Check
from tendonlab.data import Dataset
from tendonlab.diagnosis.search.select import Search

LATE = "The check of the logs alone saw no late experiment: the lag shows once {} is simulated."


def checked_again(found: Check, dataset: Dataset, search: Search) -> Check:
    """What the check `found`, with the experiments that are late once the effects named are simulated."""
    if found.blocks or not search.selected:
        return found
    late = late_experiments(dataset, search.final.system)
    notes = (*found.notes, LATE.format(" and ".join(search.selected))) if late else found.notes
    return replace(found, findings=(*late, *found.findings), notes=notes)

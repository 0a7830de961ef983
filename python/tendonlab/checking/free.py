"""Rigs whose simulation needs no output: what is simulated can be compared with outputs that are late or wrong."""

from __future__ import annotations

from dataclasses import replace

from tendonlab.data import Dataset
from tendonlab.errors import DatasetError, NumericalError, ParameterError
from tendonlab.fitting.case import Case, make_case
from tendonlab.fitting.thinning import thinned
from tendonlab.simulation.system import System


def free_case(dataset: Dataset, system: System) -> Case | None:
    """The thinned logs of a rig that prescribed inputs move, or a servo its own loop, all of them to fit; None where a
    motor is commanded, or the logs cannot be simulated."""
    command = system.info.inputs[0].name if system.info.commanded else None
    if dataset.controller is not None or command in dataset.inputs:
        return None
    try:
        few = thinned(dataset, system)
        case = make_case(replace(few, experiments=tuple(replace(e, split="train") for e in few)), system)
    except (DatasetError, NumericalError, ParameterError):
        return None
    return case if case.replay.kind == "free" else None

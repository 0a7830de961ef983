"""A cable does not push: a tension whose readings are negative was logged with the wrong sign."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tendonlab.checking.finding import Finding
from tendonlab.data import Dataset
from tendonlab.report.numbers import number, unit_text
from tendonlab.simulation.system import System

MOSTLY = 0.95  # share of the samples that must be negative
CLEARLY = 0.5  # of the pretension, below zero, of the middle sample: a sensor that was zeroed under load reads about 0


def pushing_cables(dataset: Dataset, system: System) -> Iterator[Finding]:
    """Tensions that are mostly negative, of cables whose pretension is known."""
    pretension = _least_pretension(dataset, system)
    for signal in system.info.outputs:
        records = [e.data[signal.name].dropna().to_numpy(dtype=float) for e in dataset if signal.name in e.data]
        if signal.dimension != "force" or pretension <= 0.0 or not any(len(r) for r in records):
            continue
        values = np.concatenate(records)
        if np.mean(values < 0.0) > MOSTLY and np.median(values) < -CLEARLY * pretension:
            unit = unit_text(dataset.signals[signal.name].si_unit)
            middle = f"{number(float(np.median(values)))} {unit}"
            text = f"{signal.name} is negative (half of its samples lie below {middle}), and a cable does not push"
            detail = f"{text}; turn its sign"
            yield Finding(problem="sign", signal=signal.name, factor=-1.0, blocks=True, detail=detail)


def _least_pretension(dataset: Dataset, system: System) -> float:
    """The smallest pretension that any experiment is stated to have; 0 where none is known."""
    stated = system.parameters.get("pretension", 0.0)
    return min((float(e.conditions.get("pretension", stated)) for e in dataset), default=0.0)

"""Inputs that say nothing: all that they read is noise."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tendonlab.checking.equation import Equation
from tendonlab.checking.finding import Finding
from tendonlab.checking.logs import Logs
from tendonlab.checking.terms import rms, terms
from tendonlab.data import Dataset
from tendonlab.report.words import listing
from tendonlab.simulation.reading import noise_sd
from tendonlab.simulation.system import System

NOISE = 1.3  # times the white part of a record, within which the whole record is noise
NEEDED = 20.0  # times what an input contributes, beyond which the logged motion needs something else
SAMPLES = 1500  # that decide


def silent_inputs(equation: Equation, logs: Logs) -> Iterator[Finding]:
    """A finding for each required input that reads nothing but noise in every experiment, far smaller than what the
    logged motion needs. Torque drawn anew at each sample looks like noise too, but moves the rig."""
    names = _noisy(equation.dataset, [s.name for s in equation.system.info.inputs if s.required])
    if not names or not equation.moved:
        return
    found = terms(equation, logs.thinned(SAMPLES))
    if rms(found.residual[0]) > NEEDED * found.size[0]:
        for name in names:
            detail = f"{name} reads nothing but noise in every experiment, though the rig moves: it tells no parameter"
            yield Finding(problem="uninformative", signal=name, detail=detail, blocks=True)


def all_at_rest(dataset: Dataset, system: System) -> Iterator[Finding]:
    """A finding where the inputs read nothing but noise, and so do all positions."""
    driving = [s.name for s in system.info.inputs if s.required]
    moving = [s.name for s in system.info.outputs if s.axis is not None and s.name in dataset.signals]
    names = [*driving, *moving]
    if driving and moving and _noisy(dataset, names) == names:
        detail = f"{listing(names)} read nothing but noise in every experiment: they tell no parameter"
        yield Finding(problem="uninformative", signal=driving[0], detail=detail, blocks=True)


def _noisy(dataset: Dataset, names: list[str]) -> list[str]:
    """Those of the signals that were logged and read nothing but noise in every experiment."""
    return [name for name in names if all(_is_noise(e.data.get(name)) for e in dataset)]


def _is_noise(record: object) -> bool:
    if record is None:
        return False
    values = np.asarray(record, dtype=float)
    kept = values[np.isfinite(values)]
    return len(kept) > 0 and float(np.std(kept)) <= NOISE * noise_sd(kept)

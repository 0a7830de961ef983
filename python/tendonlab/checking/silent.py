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
from tendonlab.simulation.reading import is_all_noise
from tendonlab.simulation.system import System

NEEDED = 20.0  # times what an input contributes, beyond which the logged motion needs something else
UNBALANCED = 0.3  # of the largest effort that a fit leaves in the equation of motion: what misses where an input does
SAMPLES, SHARE = 1500, 0.2  # that decide, and share of them that counts as independent


def silent_inputs(equation: Equation, logs: Logs) -> Iterator[Finding]:
    """A finding for each required input that reads nothing but noise in every experiment, where no values of the
    parameters balance the logged motion. Torque drawn anew at each sample looks like noise too, but balances the
    motion; so does a motor that is off while the rig swings freely."""
    names = _noisy(equation.dataset, [s.name for s in equation.system.info.inputs if s.required])
    if not names or not equation.moved:
        return
    found = terms(equation, logs.thinned(SAMPLES))
    fit = found.fit(np.full(len(equation.predicted), SHARE))
    slopes = zip(found.unknowns, found.slopes(fit.x), strict=True)
    largest = max((rms(slope[0]) for unknown, slope in slopes if unknown.logarithm), default=np.inf)
    are_zeros = not any(e.data[name].any() for e in equation.dataset for name in names)  # which contribute nothing
    needed = are_zeros or rms(found.residual[0]) > NEEDED * found.size[0]
    if needed and rms(fit.residual[0]) > UNBALANCED * largest:
        for name in names:
            reads = "0" if are_zeros else "noise"
            detail = f"{name} is {reads} in every experiment, yet the rig is driven: was the right channel logged?"
            yield Finding(problem="uninformative", signal=name, detail=detail, blocks=True)


def all_at_rest(dataset: Dataset, system: System) -> Iterator[Finding]:
    """A finding where the inputs read nothing but noise, and all positions stay where they are in all experiments."""
    driving = [s.name for s in system.info.inputs if s.required]
    moving = [s.name for s in system.info.outputs if s.axis is not None and s.name in dataset.signals]
    names = [*driving, *moving]
    if driving and moving and _noisy(dataset, names) == names:
        detail = f"{listing(names)} are noise in every experiment: nothing moves"
        yield Finding(problem="uninformative", signal=driving[0], detail=detail, blocks=True)


def _noisy(dataset: Dataset, names: list[str]) -> list[str]:
    """Those of the signals that were logged in every experiment and read nothing but noise."""
    return [name for name in names if all(name in e.data for e in dataset) and is_all_noise(_records(dataset, name))]


def _records(dataset: Dataset, name: str) -> list[np.ndarray]:
    return [e.data[name].dropna().to_numpy(dtype=float) for e in dataset]

"""Two columns in each other's place: the equations balance once the columns change places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from tendonlab.checking.equation import Equation
from tendonlab.checking.finding import Finding
from tendonlab.checking.logs import Logs, read_logs
from tendonlab.checking.regression import Fit
from tendonlab.checking.scales import HEALED, LEAST_GAIN, NEARLY, ROUGH, SUSPECT, agrees, rough_fit
from tendonlab.checking.spikes import Marks
from tendonlab.data import Dataset
from tendonlab.report.numbers import number


def exchanged(equation: Equation, logs: Logs, marked: Marks) -> list[Finding]:
    """The two channels of one unit whose exchange brings every equation near balance, and heals one: as a turned sign
    of the difference of two tensions. Nothing where the turned sign of one channel suits as well, or all equations
    balance as logged."""
    rough = logs.thinned(ROUGH)
    plain = rough_fit(equation, rough)
    if not np.isfinite(plain.cost) or np.all(plain.level < SUSPECT):
        return []
    best, pair = plain, None
    for names in _pairs(equation.dataset):
        found = _with(equation, marked, names)
        if found is not None and found.cost < best.cost and _heals(found, plain):
            best, pair = found, names
    turned = (
        [rough_fit(equation, rough.scaled((name,), -1.0)).cost for name in equation.dataset.signals] if pair else []
    )
    if pair is None or best.cost > min([plain.cost, *turned]) - LEAST_GAIN:
        return []
    left = [number(100 * float(np.max(fit.level)), 2) for fit in (plain, best)]
    text = (
        f"{' and '.join(pair)} look exchanged: the simulator's equations leave up to {left[0]} % of what they predict, "
        f"and {left[1]} % once they change places; exchange their columns"
    )
    return [Finding(problem="sign", signal=pair[0], alternatives=pair[1:], blocks=True, detail=text)]


def _heals(found: Fit, plain: Fit) -> bool:
    near = np.all(found.level < NEARLY) and np.any(found.level < HEALED * plain.level)
    return bool(near) or agrees(found, plain)


def _pairs(dataset: Dataset) -> Iterator[tuple[str, str]]:
    """Two outputs, or inputs, of the same unit: other columns are rarely taken for each other. An input in the place of
    an output is no suspect: a sheath that the other end drives has the same logs as one whose velocity is turned."""
    for a, b in combinations(dataset.signals.items(), 2):
        if (a[1].si_unit, a[1].role) == (b[1].si_unit, b[1].role):
            yield a[0], b[0]


def _with(equation: Equation, marked: Marks, names: tuple[str, str]) -> Fit | None:
    """The fit with two columns in each other's place."""
    places = dict(zip(names, reversed(names), strict=True))
    experiments = tuple(replace(e, data=e.data.rename(columns=places)) for e in equation.dataset.experiments)
    changed = Equation(replace(equation.dataset, experiments=experiments), equation.system)
    there = {(run, places.get(name, name)): rows for (run, name), rows in marked.items()}
    logs = read_logs(changed.dataset, equation.system.info, there)
    return None if logs is None else rough_fit(changed, logs.thinned(ROUGH))

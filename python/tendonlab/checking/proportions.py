"""One output of several alike that is a multiple of what the simulator predicts from what is believed, on rigs whose
simulation needs no output."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from typing import NamedTuple

import numpy as np

from tendonlab.checking.conversions import nearest
from tendonlab.checking.finding import Finding
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.problem import initial_state
from tendonlab.report.words import listing

LARGE = 0.5  # of its rms, beyond which a simulated output tells a ratio
BELIEVED, ALIKE = 1.5, 1.2  # factor within which the others must be predicted, and as which they must agree
EXACT = 0.08  # of the logarithm of a ratio, by which it may differ from one of units
MENDED = 0.5  # share of what an offset leaves that a factor may leave


class _Seen(NamedTuple):
    """An output in all experiments: simulated, and as it was logged."""

    name: str
    simulated: np.ndarray
    logged: np.ndarray

    @property
    def ratio(self) -> float:
        """Logged over simulated."""
        large = np.abs(self.simulated) > LARGE * np.sqrt(np.mean(np.square(self.simulated)))
        return float(np.median(self.logged[large] / self.simulated[large])) if large.any() else np.nan


def odd_proportions(case: Case | None) -> list[Finding]:
    """Outputs of a rig (`free_case`) that alone among those of their dimension read a multiple, by a ratio of units, of
    what the simulator predicts from what is believed; nothing where that cannot be simulated."""
    if case is None:
        return []
    system = case.system
    try:
        outputs = [np.asarray(case.run(i, system, initial_state(case, system, i))["outputs"]) for i in _all(case)]
    except NumericalError:
        return []
    simulated = np.concatenate(outputs, axis=1)
    logged = np.concatenate([case.prepared[i].measured for i in _all(case)], axis=1)
    rows = sorted(case.measured, key=lambda c: system.info.outputs[c].dimension)
    found: list[Finding] = []
    for _, group in groupby(rows, key=lambda c: system.info.outputs[c].dimension):
        found += _odd([_seen(case.outputs[c], simulated[c], logged[c]) for c in group])
    return found


def _all(case: Case) -> range:
    return range(len(case.experiments))


def _seen(name: str, simulated: np.ndarray, logged: np.ndarray) -> _Seen:
    known = np.isfinite(simulated) & np.isfinite(logged)
    return _Seen(name, simulated[known], logged[known])


def _odd(alike: list[_Seen]) -> Iterator[Finding]:
    """Findings about outputs of one dimension: of one alone, where the others agree."""
    for one in alike:
        others = [other.ratio for other in alike if other is not one]
        usual = float(np.median(others)) if others else np.nan
        is_known = 1.0 / BELIEVED < usual < BELIEVED and max(others) < ALIKE * min(others)
        if not is_known or not one.ratio / usual > 0.0:
            continue
        unit = nearest(one.ratio / usual)
        if abs(np.log(one.ratio / usual / unit.ratio)) < EXACT and _is_factor(one, usual, unit.ratio):
            times = f"{unit.label} {'times' if unit.ratio > 1.0 else 'of'}"
            near = listing(other.name for other in alike if other is not one)
            text = (
                f"{one.name} reads {times} what the simulator predicts, where it predicts {near} well; "
                f"check the unit of {one.name} ({unit.words}?)"
            )
            yield Finding(problem="scale", signal=one.name, factor=unit.ratio, blocks=True, detail=text)


def _is_factor(one: _Seen, usual: float, factor: float) -> bool:
    """Whether a factor suits the logs clearly better than an offset."""
    by_factor = np.mean(np.square(one.logged - factor * usual * one.simulated))
    return bool(by_factor < MENDED * np.var(one.logged - usual * one.simulated))

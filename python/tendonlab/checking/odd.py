"""A mistake in one experiment: its clock in another unit, or channels that break an equation which the others keep."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from tendonlab.checking.equation import Equation
from tendonlab.checking.factors import factor_findings
from tendonlab.checking.finding import Finding
from tendonlab.checking.logs import TIME, Logs, read_logs
from tendonlab.checking.regression import Fit
from tendonlab.checking.scales import EXPLAINED, ROUGH, ROUGH_SHARE, SUSPECT, Factor, wrong_factors
from tendonlab.checking.spikes import Marks
from tendonlab.checking.terms import Terms, terms
from tendonlab.data import Dataset

FEWEST, MOST = 3, 0.25  # experiments among which one is odd, and share of them that may be
ODD = 4.0  # times what the equation leaves of a usual experiment, in an odd one
UNBALANCED = 0.3  # of what an equation predicts, left of a usual experiment: it does not balance
ALIKE = 2.0  # times the same, of an odd experiment once it is corrected
UNITS, NEAR = (1e6, 1e3, 1e-3, 1e-6), 1.3  # of clocks, and the ratio by which steps of one unit may differ
LEAST_STEPS = 8  # of a record whose clock is judged


def odd_clocks(dataset: Dataset) -> Iterator[Finding]:
    """Experiments whose stamps are in milliseconds, or microseconds, where those of all others are in seconds."""
    steps = {e.name: float(np.median(np.diff(e.time))) for e in dataset.experiments if len(e.time) > LEAST_STEPS}
    usual = float(np.median(list(steps.values()))) if len(steps) >= FEWEST else 0.0
    odd = {name: step / usual for name, step in steps.items() if usual and _is_unit(step / usual)}
    if len(odd) > MOST * len(steps) and len(odd) > 1:
        return
    for name, ratio in odd.items():
        times = f"{ratio:.0f} times as long as" if ratio > 1.0 else f"1/{1.0 / ratio:.0f} of"
        text = f"the time steps are {times} those of the other experiments; check the unit of the stamps"
        yield Finding(problem="scale", signal=TIME, experiment=name, factor=ratio, blocks=True, detail=text)


def _is_unit(ratio: float) -> bool:
    return any(1.0 / NEAR < ratio / unit < NEAR for unit in UNITS)


def owned(factors: Sequence[Factor], equation: Equation, logs: Logs, marked: Marks) -> list[Finding]:
    """What wrong `factors` of all experiments say; of single ones, where these alone ask for a factor, and the others
    do not balance with it. One experiment in degrees outweighs all others in radians."""
    together, num = factor_findings(factors, equation.dataset), len(equation.dataset.experiments)
    if not factors or num < FEWEST:
        return together
    best = factors[0]
    left = _left(equation, logs.scaled(best.signals, best.value))
    if len(left) and np.all(np.median(left, axis=0)[best.fit.level < EXPLAINED] < UNBALANCED):
        return together
    asking = [told for i in range(num) if (told := _told_of(equation, i, _factors_of(equation, i, marked)))]
    return [f for told in asking for f in told] if 0 < len(asking) <= max(1.0, MOST * num) else together


def odd_channels(equation: Equation, logs: Logs, marked: Marks) -> list[Finding]:
    """Wrong signs and scales of single experiments. An experiment is odd where an equation leaves far more of it than
    of the others; a factor is told where it alone asks for one, and is then as the others are."""
    left = _left(equation, logs)
    if len(left) < FEWEST:
        return []
    usual = np.fmax(np.median(left, axis=0), SUSPECT)
    excess = np.max(left / usual, axis=1)
    odd = np.flatnonzero(excess > ODD)
    if not len(odd) or len(odd) > max(1.0, MOST * len(left)):
        return []
    found: list[Finding] = []
    for i in odd:
        found += _still(equation, int(i))
        factors = _factors_of(equation, int(i), marked)
        if factors and np.all(factors[0].fit.level < ALIKE * usual) and not _is_friction(equation, factors[0]):
            found += _told_of(equation, int(i), factors)
    others = np.argsort(excess)[: len(left) - len(odd)]
    if found and any(_factors_of(equation, int(i), marked) for i in others[-2:]):  # the least usual ask for one, too
        return []
    return found


def _told_of(equation: Equation, experiment: int, factors: Sequence[Factor]) -> list[Finding]:
    """Findings about one experiment."""
    dataset = _alone(equation, experiment).dataset
    return [replace(f, experiment=dataset.experiments[0].name) for f in factor_findings(factors, dataset)]


def _is_friction(equation: Equation, factor: Factor) -> bool:
    """Whether a factor concerns only a velocity that turns friction, where nothing has a mass: far more friction in a
    cold run asks for the same."""
    flows = {s.name for s in equation.system.info.inputs if s.dimension == "flow"}
    return not equation.moved and set(factor.signals) <= flows


def _still(equation: Equation, experiment: int) -> Iterator[Finding]:
    """Inputs that never change in an odd experiment, and do in others."""
    odd = equation.dataset.experiments[experiment]
    for name in equation.dataset.inputs:
        rows = [e.data[name].to_numpy(dtype=float) for e in equation.dataset.experiments if name in e.data.columns]
        if name in odd.data.columns and np.ptp(odd.data[name]) == 0 and any(np.ptp(row) > 0 for row in rows):
            text = (
                f"{name} never changes, and the motion does not follow from that; correct or leave out this experiment"
            )
            yield Finding(problem="constant", signal=name, experiment=odd.name, blocks=True, detail=text)


def _left(equation: Equation, logs: Logs) -> np.ndarray:
    """What the equations leave of each experiment, relative to what they predict (experiments, equations)."""
    rough = logs.thinned(ROUGH)
    at = terms(equation, rough)
    return left_of(equation, rough, at, at.fit(np.full(len(equation.predicted), ROUGH_SHARE)))


def left_of(equation: Equation, logs: Logs, at: Terms, fit: Fit) -> np.ndarray:
    """The same of a fit; empty where there is none, or nothing of an experiment is judged."""
    runs = np.unique(logs.run)
    if not np.isfinite(fit.cost) or len(runs) < len(equation.dataset.experiments):
        return np.empty((0, 0))
    away = np.abs(fit.residual) / at.size[:, None]
    return np.array([np.median(away[:, logs.run == i], axis=1) for i in runs])


def _factors_of(equation: Equation, experiment: int, marked: Marks) -> list[Factor]:
    alone = _alone(equation, experiment)
    logs = read_logs(alone.dataset, equation.system.info, marked)
    return wrong_factors(alone, logs) if logs is not None else []


def _alone(equation: Equation, experiment: int) -> Equation:
    """The equation of one experiment."""
    dataset = replace(equation.dataset, experiments=(equation.dataset.experiments[experiment],))
    return Equation(dataset, equation.system)

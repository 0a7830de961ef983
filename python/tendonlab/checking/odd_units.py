"""Channels that one experiment has in another unit, or turned, where all others are right: told by the parameters that
all share."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from tendonlab.checking.equation import Equation
from tendonlab.checking.factors import factor_findings
from tendonlab.checking.finding import Finding
from tendonlab.checking.logs import Logs
from tendonlab.checking.odd import ALIKE, FEWEST, MOST, ODD, UNBALANCED, left_of
from tendonlab.checking.scales import LEAST_GAIN, ROUGH, ROUGH_SHARE, SUSPECT, Factor, ranked
from tendonlab.checking.suspects import Suspect, in_other_units, only_turns, turned
from tendonlab.checking.terms import terms


def odd_units(equation: Equation, logs: Logs) -> list[Finding]:
    """The channels of experiments that stand out, and are as the others are once these channels are turned or in their
    unit."""
    rough, found = logs.thinned(ROUGH), []
    names = [e.name for e in equation.dataset.experiments]
    for _ in range(max(1, int(MOST * len(names))) if len(names) >= FEWEST else 0):
        told = _of_the_oddest(equation, rough)
        if told is None:
            break
        run, factors = told
        found += [replace(f, experiment=names[run]) for f in factor_findings(factors, equation.dataset)]
        rough = rough.scaled(factors[0].signals, factors[0].value, run)
    return found


def _of_the_oddest(equation: Equation, logs: Logs) -> tuple[int, list[Factor]] | None:
    """The experiment that stands out most, and the equally good factors that mend it."""
    at = terms(equation, logs)
    plain = at.fit(np.full(len(equation.predicted), ROUGH_SHARE))
    left = left_of(equation, logs, at, plain)
    run, excess = _oddest(left)
    if excess < ODD:
        return None
    among = [*turned(equation), *in_other_units(equation, left[run])]
    tried = [f for f in _tried(equation, logs, run, plain.cost, among) if f.gain > LEAST_GAIN]
    best = ranked(tried) if tried else []
    return (run, [f for f in best if f.gain > best[0].gain - LEAST_GAIN]) if best else None


def _oddest(left: np.ndarray) -> tuple[int, float]:
    """The experiment of which the equations leave most, and how many times as much as of the middle one, where that
    balances."""
    if not len(left):
        return 0, 0.0
    usual = np.median(left, axis=0)
    excess = np.max(np.where(usual < UNBALANCED, left / np.fmax(usual, SUSPECT), 0.0), axis=1)
    return int(np.argmax(excess)), float(np.max(excess))


def _tried(equation: Equation, logs: Logs, run: int, cost: float, among: Iterable[Suspect]) -> Iterator[Factor]:
    """Every unit and sign of one experiment that makes it as the others are, by what each gains together with the
    parameters that all share. Beliefs may be strained: memory of friction, which the equation ignores, strains them."""
    share = np.full(len(equation.predicted), ROUGH_SHARE)
    for suspect in among:
        if only_turns(equation, suspect.signals):  # far more friction in a cold run asks for such a sign as well
            continue
        [value] = suspect.values
        scaled = logs.scaled(suspect.signals, value, run)
        at = terms(equation, scaled)
        fit = at.fit(share)
        left = left_of(equation, scaled, at, fit)
        if len(left) and np.all(left[run] <= ALIKE * np.fmax(np.median(left, axis=0), SUSPECT)):
            yield Factor(suspect.signals, value, fit, cost - fit.cost)

"""What to measure next: the experiment in which the leading explanations differ most (docs/method.md)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tendonlab.diagnosis.answer.driven import drives
from tendonlab.diagnosis.answer.looped import Loop, Looped
from tendonlab.diagnosis.answer.motions import USUAL, motions, rested
from tendonlab.diagnosis.answer.plan import Plan
from tendonlab.diagnosis.search.delays import twin_delays
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted, Marginal, Run, solved
from tendonlab.fitting.noise import Floor
from tendonlab.fitting.problem import pose
from tendonlab.simulation.prepare import Replay
from tendonlab.simulation.records import Experiment

SEPARATES = 3.0  # nats below which an experiment separates nothing


def advise(case: Case, driven: Replay, floor: Floor, first: Fitted, second: Fitted) -> list[dict[str, Any]]:
    """Experiments ranked by the nats that they are expected to bring between two explanations, best first, each with
    its `reference`; `driven`: the loop in which the rig follows motions, if it has one. Empty where nothing separates
    the two."""
    names = sorted(set(first.added) ^ set(second.added))
    if twin_delays(case) == set(names):
        return []
    return ranked(case, plans(case, driven), names, lambda plan: _separation(case, floor, first, second, plan))


def plans(case: Case, driven: Replay, *, rests: bool = False) -> list[Plan]:
    """What could be asked of a rig that follows motions in the loop `driven`, or else plays prescribed inputs. `rests`:
    also a motion after a rest. Nothing of a rig that is measured point by point."""
    if driven.kind == "free":
        return [] if case.system.info.steady else [*drives(case, rests=rests)]
    loop = Loop.of(case, driven)
    if loop is None:
        return []
    made = motions(case, loop.output)
    return [Looped(motion, loop) for motion in (*made, *([rested(made[USUAL])] if rests else []))]


def ranked(
    case: Case,
    planned: Sequence[Plan],
    separates: list[str],
    gain: Callable[[Plan], float],
    *,
    least: float = SEPARATES,
) -> list[dict[str, Any]]:
    """The best three of the plans that bring more than the `least` gain, as entries of a report, each with its
    reference as a table."""
    gains = []
    for plan in planned:
        try:
            gains.append((gain(plan), plan))
        except NumericalError:
            continue
    best = sorted((pair for pair in gains if pair[0] > least), key=lambda pair: -pair[0])[:3]
    return [_row(plan, case, separates, nats) for nats, plan in best]


def _row(plan: Plan, case: Case, separates: list[str], nats: float) -> dict[str, Any]:
    said = {"description": plan.words, "separates": separates, "expected_gain": round(nats, 1)}
    return said | plan.stated(case) | {"reference": plan.reference(case)}


def contradiction(r: np.ndarray, j: np.ndarray, prior: np.ndarray) -> float:
    """Nats by which a residual speaks against a model whose parameters may still move it by j theta: half of
    min over theta of |r + j theta|² + theta' prior theta."""
    with np.errstate(over="ignore", invalid="ignore"):  # a loop that runs away along a motion tells nothing
        gain = 0.5 * float(r @ r - (j.T @ r) @ solved(j.T @ j + prior, j.T @ r))
    return max(0.0, gain) if np.isfinite(gain) else 0.0


def _separation(case: Case, floor: Floor, first: Fitted, second: Fitted, plan: Plan) -> float:
    """What the plan is expected to bring whichever of the two is true: the lesser of both gains, or the first
    where that is too little already."""
    gain = _gain(case, floor, first, second, plan.played(case, first.system).log)
    if gain <= SEPARATES:
        return gain
    return min(gain, _gain(case, floor, second, first, plan.played(case, second.system).log))


def _gain(case: Case, floor: Floor, true: Fitted, other: Fitted, experiment: Experiment) -> float:
    """Nats that the diagnosis is expected to count against the `other` where `true` made the log: r is what the other
    leaves more, with its posterior as the prior of its parameters. What the log begins with differs even from its own
    model: a rig at rest does not show which way it came."""
    rig, under = case.playing(experiment), replace(floor, sd=other.levels.tolist())

    def run(of: Fitted) -> Run:
        return pose(rig, under, of.system, added=of.added).linearise().runs[0]

    left = run(other)
    marginal = Marginal.of(left, other.shares)
    more = marginal.residual(left.residual - run(true).residual)
    moving = ~np.array(other.at_bound, dtype=bool)
    return contradiction(more, marginal.jacobian[:, moving], other.precision[np.ix_(moving, moving)])

"""Delays shorter than anything that logs tell of time.

Stamps have a resolution, and whether a controller's command or reference is held, averaged or straight between its
samples is known to a part of a sample at best: each of these looks like a short delay. A system without degrees of
freedom answers sample by sample and tells delays less closely."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tendonlab.diagnosis.search.trial import Trial
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.report.numbers import number

LEAST = 0.05  # of the step of the logs
LEAST_BY_SAMPLES = 0.15  # the same where a system answers sample by sample: right ones were 0.19 and longer
NEXT_TO_NOTHING = 0.01  # of the least delay: a shorter one has no digits worth printing
RESOLVED = 0.03  # of the step: half of the 95 % interval within which logs tell a delay at best
TOO_SHORT = "its delay of {} ms is shorter than {} ms, finer than logs with steps of {} ms tell time"


def trouble_with_delays(case: Case, fitted: Fitted, effect: str) -> str:
    """Why the fit does not tell of the `effect`, where that is a delay of next to nothing; else "". Logs that were
    thinned had finer stamps."""
    info = case.system.info
    law = info.effect(effect)
    if law.effect != "delay" or any(e.averaged for e in case.experiments):
        return ""
    step = _step(case)
    least = (LEAST if info.dof else LEAST_BY_SAMPLES) * step
    delay = fitted.system.parameters[law.parameters[0]]
    if delay >= least:
        return ""
    shortest = NEXT_TO_NOTHING * least
    told = _ms(delay) if delay >= shortest else f"less than {_ms(shortest)}"
    return TOO_SHORT.format(told, _ms(least), _ms(step))


def value_and_interval(case: Case, fitted: Fitted, name: str) -> tuple[float, tuple[float, float]]:
    """Fitted value of a free parameter and its 95 % interval. That of a delay holds what logs tell of time besides:
    residuals say nothing of an error that all of them share."""
    value, (lower, upper) = fitted.value(name)
    if fitted.system.info.parameter(name).effect != "delay":
        return value, (lower, upper)
    finest = RESOLVED * _step(case)
    below, above = math.hypot(value - lower, finest), math.hypot(upper - value, finest)
    return value, (max(0.0, value - below), value + above)


def _step(case: Case) -> float:
    """Median step of the logs, s."""
    return float(np.median([np.median(np.diff(e.time)) for e in case.experiments]))


def _ms(seconds: float) -> str:
    return number(1e3 * seconds, 2)


def twin_delays(case: Case) -> frozenset[str]:
    """A late command and a late sensor where no data of such experiments can tell them apart: that sensor is all that
    was measured, and the logged command all that moves the rig. None elsewhere."""
    if case.replay.kind == "controller" or len(case.measured) != 1:
        return frozenset()
    command = case.system.info.command
    if command is None or list(case.dataset.inputs) != [command.name]:
        return frozenset()
    return frozenset({"actuation:delay", f"sensor.{case.outputs[case.measured[0]]}:delay"})


def with_twins_even(case: Case, trials: Sequence[Trial]) -> list[Trial]:
    """The `trials`, best first, with the same evidence for twin delays. A replay that pulls the simulated motor to the
    logged one treats them otherwise, which says nothing of the rig."""
    twins = twin_delays(case)
    pair = [t for t in trials if t.effect in twins]
    if len(pair) < 2:
        return list(trials)
    best = max(pair, key=lambda trial: trial.evidence_gain)
    gain, left_out, doubt = best.evidence_gain, best.left_out_gain, best.doubt
    even = [
        replace(t, evidence_gain=gain, left_out_gain=left_out, doubt=doubt) if t.effect in twins else t for t in trials
    ]
    return sorted(even, key=lambda trial: -trial.evidence_gain)

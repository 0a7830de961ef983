"""The unit of the time column: steps that no rig is logged with."""

from __future__ import annotations

import numpy as np

from tendonlab.checking.equation import Equation
from tendonlab.checking.finding import Finding
from tendonlab.checking.logs import TIME, Logs
from tendonlab.checking.scales import LEAST_GAIN, ROUGH, rough_fit
from tendonlab.report.numbers import number

LONGEST, SHORTEST = 0.3, 1e-5  # s from sample to sample, beyond which the unit of the stamps is doubtful
FACTORS = (1e3, 1e6)  # of a clock that runs too far
PREFIXES = "seconds declared as milliseconds or microseconds", "milliseconds or microseconds declared as seconds"


def strange_steps(equation: Equation, logs: Logs) -> list[Finding]:
    """Steps of the clock of a second or a microsecond, as milliseconds declared as seconds have, and the inverse. Where
    the equation of motion suits the clock a thousand times faster or slower better, whatever that says of the
    parameters, the unit is wrong; where nothing tells, as in a transmission without a mass, it is doubtful."""
    step = float(np.median([np.median(np.diff(e.time)) for e in equation.dataset.experiments]))
    if SHORTEST < step < LONGEST:
        return []
    long, rough = step >= LONGEST, logs.thinned(ROUGH)
    cost = {f: rough_fit(equation, rough.scaled((TIME,), f)).cost for f in (f if long else 1.0 / f for f in FACTORS)}
    factor = min(cost, key=lambda f: cost[f])
    unit = f"a prefix such as milli: {PREFIXES[long]}?"
    text = f"samples are {number(step)} s apart, which is rare for a rig that moves: check the unit of the time column"
    if not np.isfinite(cost[factor]) or cost[factor] > rough_fit(equation, rough).cost - LEAST_GAIN:
        return [Finding(problem="sampling", signal=TIME, detail=f"{text} ({unit})")]
    seen = f"the time is {number(factor)} times as large as the equation of motion allows"
    return [Finding(problem="scale", signal=TIME, factor=factor, blocks=True, detail=f"{seen} ({unit}); {text}")]

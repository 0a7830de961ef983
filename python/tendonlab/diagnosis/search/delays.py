"""Delays shorter than anything that logs tell of time.

Stamps have a resolution, and whether a controller's command or reference is held, averaged or straight between its
samples is known to a part of a sample at best: each of these looks like a short delay."""

from __future__ import annotations

import numpy as np

from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted

LEAST = 0.05  # of the step of the logs
TOO_SHORT = "its delay of {:.2g} ms is shorter than {:.0f} % of the step of the logs, finer than their stamps tell time"


def trouble_with_delays(case: Case, fitted: Fitted, effect: str) -> str:
    """Why the fit does not tell of the `effect`, where that is a delay of next to nothing; else "". Logs that were
    thinned had finer stamps."""
    name = case.system.info.effect(effect)
    if name.effect != "delay" or any(e.averaged for e in case.experiments):
        return ""
    delay = fitted.system.parameters[name.parameters[0]]
    step = float(np.median([np.median(np.diff(e.time)) for e in case.experiments]))
    return TOO_SHORT.format(1e3 * delay, 100 * LEAST) if delay < LEAST * step else ""

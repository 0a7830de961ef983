"""Static friction far above the kinetic one: no Stribeck effect, but the error of another law at rest and in reversals.

Textbooks give ratios up to two. A bristle of another shape than the library's asks for more."""

from __future__ import annotations

from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.simulation.catalog import LEVEL, REFINES, is_dry

MOST = 4.0  # static over kinetic friction: imitations needed 4.5 and 11.5
TOO_STICKY = "it would make static friction {:.2g} times the kinetic one"


def trouble_with_stiction(_: Case, fitted: Fitted, effect: str) -> str:
    """Why the fit does not tell of the `effect`, where that makes static friction implausibly large beside the Coulomb
    friction of its element; else "". Not judged where the element has other dry friction, as one that grows with load.
    """
    info = fitted.system.info
    law = info.effect(effect)
    there = [info.effect(name) for name in fitted.system.effects]
    dry = [e for e in there if e.element == law.element and is_dry(e)]
    if not (law.roles & LEVEL and law.roles & REFINES) or [e.effect for e in dry] != ["coulomb"]:
        return ""
    values = fitted.system.parameters
    coulomb = values[dry[0].parameters[0]]
    excess = next(values[name] for name in law.parameters if info.parameter(name).purpose == "amplitude")
    ratio = 1.0 + excess / coulomb if coulomb > 0.0 else float("inf")
    return TOO_STICKY.format(ratio) if excess > 0.0 and ratio > MOST else ""

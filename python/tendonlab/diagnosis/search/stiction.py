"""Static friction far above the kinetic one: no Stribeck effect, but the error of another law at rest and in reversals.

Textbooks give ratios up to two. A bristle of another shape than the library's asks for more."""

from __future__ import annotations

from tendonlab.fitting.fitted import Fitted
from tendonlab.simulation.catalog import LEVEL, REFINES

MOST = 4.0  # static over kinetic friction: right Stribeck effects needed 3.2 at most, imitations 4.5 and 11.5
TOO_STICKY = "it would make static friction {:.2g} times the kinetic one"


def trouble_with_stiction(fitted: Fitted, effect: str) -> str:
    """Why the fit does not tell of the `effect`, where that makes static friction implausibly large beside the Coulomb
    friction of its element; else ""."""
    info = fitted.system.info
    law = info.effect(effect)
    kinetic = [e for e in info.effects if e.name == f"{law.element}:coulomb" and e.name in fitted.system.effects]
    if not (law.roles & LEVEL and law.roles & REFINES and kinetic):
        return ""
    values = fitted.system.parameters
    coulomb = values[kinetic[0].parameters[0]]
    excess = next(values[name] for name in law.parameters if info.parameter(name).purpose == "amplitude")
    ratio = 1.0 + excess / coulomb if coulomb > 0.0 else float("inf")
    return TOO_STICKY.format(ratio) if excess > 0.0 and ratio > MOST else ""

"""Bristles that slide before any sensor sees them bend: dry friction but for its creep.

A bristle of LuGre creeps under every shake, however stiff it is. Where noise faster than the log shakes a rig, so that
the rig creeps, very stiff bristles imitate that."""

from __future__ import annotations

import numpy as np

from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.simulation.catalog import MEMORY, PORT_QUANTITIES

VISIBLE = 1.5  # times its noise, by which a sensor sees bristles bend: imitations bent by 1.1 at most
UNSEEN = (
    "its bristles bend by only {:.1g} of a sensor's noise before they slide, so no sensor sees them bend; their creep "
    "may come from noise that shakes the rig"
)


def trouble_with_bristles(case: Case, fitted: Fitted, effect: str) -> str:
    """Why the fit does not tell of the `effect`, where that is a bristle which no sensor sees bend; else ""."""
    info = case.system.info
    law = info.effect(effect)
    stiffness = [name for name in law.parameters if info.parameter(name).dimension == "stiffness"]
    if not (stiffness and law.roles & MEMORY) or not np.isfinite(noise := _noise(case)):
        return ""
    bend = _dry_level(case, fitted, law.element) / fitted.system.parameters[stiffness[0]]
    seen = bend / (noise * case.scales[law.element].displacement)
    return UNSEEN.format(seen) if seen < VISIBLE else ""


def _noise(case: Case) -> float:
    """Noise of the best sensor of a position, relative to what it shows; infinite where there is none."""
    outputs = case.system.info.outputs
    shares = [
        case.noise[c] / travel
        for c in case.measured
        if outputs[c].axis is not None and (travel := _travel(case, c)) > 0.0
    ]
    return float(min(shares, default=np.inf))


def _travel(case: Case, output: int) -> float:
    """How far an output goes in the training experiments, as sd."""
    return float(np.nanstd(np.concatenate([case.prepared[i].measured[output] for i in case.train])))


def _dry_level(case: Case, fitted: Fitted, element: str) -> float:
    """Friction of an element while it is slow, rms of the port where that is largest."""
    own = [k for k, port in enumerate(case.system.info.ports) if port.element == element]
    runs = [
        np.asarray(case.run(i, fitted.system, initial, ports=True)["ports"])[own]
        for i, initial in zip(case.train, fitted.initial, strict=True)
    ]
    recorded = (PORT_QUANTITIES.index(name) for name in ("velocity", "force"))
    speed, force = (np.abs(np.concatenate([run[:, k] for run in runs], axis=1)) for k in recorded)
    slow = speed <= np.median(speed, axis=1, keepdims=True)
    return float(np.max(np.sqrt(np.mean(np.square(force), axis=1, where=slow))))

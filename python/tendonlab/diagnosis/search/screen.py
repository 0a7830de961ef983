"""Which effects could explain the gap at all: the secant score of each candidate (docs/method.md)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tendonlab import _core
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted, Fitter
from tendonlab.fitting.noise import started
from tendonlab.fitting.priors import AMPLITUDE_SD, start_of
from tendonlab.simulation.catalog import LEVEL, REFINES, WHOLE, Effect, Parameter

SHAPES = (0.2, 1.0, 5.0, 25.0)  # of the typical shape
AMPLITUDES = (0.1, 0.5)  # of the effect's unit
INVISIBLE = 1.0  # nats that an effect of typical size must at least be worth to be visible


@dataclass(frozen=True)
class Lead:
    """A candidate as the screen saw it: expected gain in nats, starting values for its fits, best first, and the gain
    that an effect of typical size would bring (its visibility). `simulated`: whether the model ran with it at all."""

    effect: str
    gain: float
    starts: tuple[dict[str, float], ...]
    visibility: float
    simulated: bool = True


def candidates(case: Case, best: Fitted) -> list[str]:
    """Effects of the library that the model lacks and that these data could show; a whole curve is no effect."""
    info = case.system.info
    measured = {info.outputs[c].name for c in case.measured}
    found = []
    for e in info.effects:
        sensor = e.element.removeprefix("sensor.")
        unseen = e.element.startswith("sensor.") and sensor not in measured
        if e.structural or e.roles & WHOLE or unseen or e.name in best.system.effects or not _has_ground(e, best):
            continue
        found.append(e.name)
    return found


def _has_ground(effect: Effect, best: Fitted) -> bool:
    """What refines dry friction (a bristle, the Stribeck excess) needs dry friction of its element to refine; what
    shares parameters with another effect needs that one."""
    if not set(effect.needs) <= set(best.system.effects):
        return False
    if not effect.roles & REFINES:
        return True
    here = [e for e in best.system.info.effects if e.name in best.system.effects and e.element == effect.element]
    return any(e.roles & LEVEL and not e.roles & REFINES for e in here)


def screen(fitter: Fitter, best: Fitted, effect: str) -> Lead:
    """Secant score of one effect, over a grid of its shapes and two amplitudes of each of its amplitude parameters."""
    case = fitter.case
    info = case.system.info
    rows = [info.parameter(name) for name in info.effect(effect).parameters]
    start = start_of(best.system, effect, case.scales)
    shapes = [p for p in rows if p.purpose == "shape"]
    base = _whitened(fitter, best, {}, effect=None)
    found: list[tuple[float, dict[str, float], float]] = []
    for factor in SHAPES if shapes else (1.0,):
        shaped = {**start, **({shapes[0].name: start[shapes[0].name] * factor} if shapes else {})}
        for p in rows:
            if not p.amplitude:
                continue
            for amplitude in AMPLITUDES:
                try:
                    found.append(_score(fitter, best, base, effect, p, shaped, amplitude))
                except NumericalError:
                    continue
    if not found:
        typical = {p.name: AMPLITUDES[-1] * _unit(fitter.case, p) for p in rows if p.amplitude}
        return Lead(effect, 0.0, ({**start, **typical},), 0.0, simulated=False)
    found.sort(key=lambda f: -f[0])
    starts = [found[0][1]]
    for _, values, _ in found[1:]:
        if shapes and all(values[shapes[0].name] != s[shapes[0].name] for s in starts):
            starts.append(values)
    return Lead(effect, found[0][0], tuple(starts[:2]), max(f[2] for f in found))


def _score(
    fitter: Fitter,
    best: Fitted,
    base: list[np.ndarray],
    effect: str,
    p: Parameter,
    shaped: dict[str, float],
    amplitude: float,
) -> tuple[float, dict[str, float], float]:
    """Expected gain, the values to start a fit from, and the gain of a typical effect."""
    case = fitter.case
    unit = _unit(case, p)
    values = {**shaped, p.name: amplitude * unit}
    moved = _whitened(fitter, best, values, effect=effect)
    directions = [(m - b) / amplitude for m, b in zip(moved, base, strict=True)]
    dd, dr, jd, jr = (best.share * total for total in _products(best, directions, base))
    hidden = np.linalg.solve(best.precision, jd)  # what the free parameters can imitate of it
    slope, curvature = float(dr - hidden @ jr), max(float(dd - hidden @ jd), 0.0)
    at = -slope / (curvature + AMPLITUDE_SD**-2.0)
    at = min(max(at, p.lower / unit), p.upper / unit)
    gain = -slope * at - 0.5 * (curvature + AMPLITUDE_SD**-2.0) * at**2
    start = p.typical if p.purpose == "share" else at * unit  # a share is held at its typical value in fits
    return gain, {**values, p.name: start}, 0.5 * curvature


def _unit(case: Case, p: Parameter) -> float:
    """The typical size of an amplitude on this rig."""
    if p.purpose == "share":
        return 1.0
    return (case.scales.get(p.element or "") or next(iter(case.scales.values()))).of(p.dimension) * abs(p.typical)


def _products(best: Fitted, directions: list[np.ndarray], base: list[np.ndarray]) -> tuple[Any, ...]:
    """d'd, d'r, J'd and J'r over all blocks."""
    rows = list(zip(directions, base, best.blocks, strict=True))
    return (
        sum(d @ d for d, _, _ in rows),
        sum(d @ r for d, r, _ in rows),
        sum(b.jacobian.T @ d for d, _, b in rows),
        sum(b.jacobian.T @ r for _, r, b in rows),
    )


def _whitened(fitter: Fitter, best: Fitted, values: dict[str, float], *, effect: str | None) -> list[np.ndarray]:
    """Whitened residuals of the training experiments at the best model, with `effect` at `values`; in block order."""
    if effect is None:
        return [b.residual for b in best.blocks]
    case, system = fitter.case, best.system.with_effects({effect: values})
    blocks: list[np.ndarray] = []
    for t, i in enumerate(case.train):
        run = _core.simulate(
            system.kind, *case.at(i, system, best.initial[t]), started(case, i, best.initial[t]), [], case.settings
        )
        blocks += fitter.rows(best.states[t], t, fitter.whitening[i].residual(run["outputs"]))
    return blocks

"""The screen: which effects could explain the gap at all, by the secant score of each candidate.

A candidate is simulated at two amplitudes and a few shapes. What the free parameters of the base model cannot imitate
of the change in its residuals gives the gain that a refit may be expected to bring."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tendonlab.diagnosis.search.swap import can_replace, extended
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted, solved
from tendonlab.fitting.priors import AMPLITUDE_SD, is_fraction, start_of
from tendonlab.fitting.problem import Fitter
from tendonlab.simulation.catalog import LEVEL, REFINES, WHOLE, EffectInfo, ParameterInfo, is_dry
from tendonlab.simulation.prepare import Replay
from tendonlab.simulation.system import System

SHAPES = (0.2, 1.0, 5.0, 25.0)  # of the typical shape
WHOLE_SHAPES = (0.3, 1.0, 3.0)  # of the typical first shape of a whole friction
AMPLITUDES = (0.1, 0.5)  # of the effect's unit
DELAYS = (*AMPLITUDES, 2.0, 8.0)  # the same of a delay: where outputs jump, a slope tells nothing of one that is long
ACTUATION = "actuation"
INVISIBLE = 1.0  # nats that an effect of typical size must at least be worth to be visible


@dataclass(frozen=True)
class Screened:
    """A candidate as the screen saw it: expected gain in nats, starting values for its fits, best first, and the gain
    that an effect of typical size would bring (its visibility). `trouble`: why the model never ran with it, empty where
    it did; `poor_when_believed`: whether others promise far more at believed values: no fit starts from there then;
    `far_behind`: at tuned values, too: then one start is enough."""

    effect: str
    gain: float
    starts: tuple[dict[str, float], ...]
    visibility: float
    trouble: str = ""
    far_behind: bool = False
    poor_when_believed: bool = False

    @property
    def simulated(self) -> bool:
        """Whether the model ran with it at all."""
        return not self.trouble


@dataclass(frozen=True)
class _Score:
    """One amplitude of one shape: expected gain, values to start a fit from, and the gain of a typical effect."""

    gain: float
    start: dict[str, float]
    visibility: float


def candidates(case: Case, base: Fitted, asked: Sequence[str] | None = None) -> list[str]:
    """Effects of the library that `base` lacks and that these data could show: those `asked` for by name (None: all).

    A whole friction is tried where it is asked for and has another one to replace."""
    info = case.system.info
    measured = {info.outputs[c].name for c in case.measured}

    def applies(e: EffectInfo) -> bool:
        if e.element in case.idle or not (asked is None or e.name in asked):
            return False
        if case.motor_is_off and not _acts_at_rest(case, e):
            return False
        if e.roles & WHOLE:
            return asked is not None and can_be_seen(e, measured) and can_replace(e, base.system, base.added)
        return can_be_seen(e, measured) and can_be_added(e, base.system)

    return [e.name for e in info.effects if applies(e)]


def _acts_at_rest(case: Case, effect: EffectInfo) -> bool:
    """Whether an effect of the actuation moves the rig though the command is 0. If not, it could only change what an
    injection adds."""
    if effect.element != ACTUATION:
        return True
    command, run = case.system.info.inputs[0].name, case.experiments[case.train[0]]
    run = replace(run, data=run.data.assign(**{command: 0.0}))
    free = replace(case, replay=Replay("free")).playing(run)
    typical = {p.name: _unit(case, p) for p in map(case.system.info.parameter, effect.parameters) if p.amplitude}
    (without, with_it), _ = free.run_together(0, [case.system, extended(case.system, {effect.name: typical})])
    return not np.array_equal(without, with_it, equal_nan=True)


def can_be_seen(effect: EffectInfo, measured: Collection[str]) -> bool:
    """Whether an effect could show in the outputs that were `measured`; the structure of a system is no effect."""
    sensor = effect.element.removeprefix("sensor.")
    return not effect.structural and (sensor == effect.element or sensor in measured)


def can_be_added(effect: EffectInfo, system: System) -> bool:
    """Whether the simulator lacks the effect and has what it requires: a refinement of dry friction (a bristle, the
    Stribeck excess) requires dry friction of its element; an effect that shares parameters with others requires those.
    """
    if effect.name in system.effects or not set(effect.needs) <= set(system.effects):
        return False
    if not effect.roles & REFINES:
        return True
    present = [e for e in system.info.effects if e.name in system.effects and e.element == effect.element]
    adds = effect.roles & LEVEL  # and takes no part of the dry friction that is there
    return any(is_dry(e) and (adds or e.roles & LEVEL) for e in present)


def screen(fitter: Fitter, base: Fitted, effect: str) -> Screened:
    """Secant score of one effect, over a grid of its shapes and two amplitudes of each of its amplitude parameters."""
    case = fitter.case
    info = case.system.info
    rows = [info.parameter(name) for name in info.effect(effect).parameters]
    if info.effect(effect).roles & WHOLE:
        return _whole(case, base, effect, rows)
    start = start_of(base.system, effect, case.scales)
    shape = next((p for p in rows if p.purpose == "shape"), None)
    tried = [
        (p, amplitude, {**start, **shaped, p.name: amplitude * _unit(case, p)})
        for shaped in (_shapes(shape, start) if shape else ({},))
        for p in rows if p.amplitude
        for amplitude in (DELAYS if p.dimension == "time" else AMPLITUDES)
    ]  # fmt: skip
    seen = _residuals_with(fitter, base, effect, [values for _, _, values in tried])
    scores = [_score(case, base, *of, r) for of, r in zip(tried, seen, strict=True) if not isinstance(r, str)]
    trouble = next((r for r in reversed(seen) if isinstance(r, str)), "")
    if not scores:
        typical = {p.name: AMPLITUDES[-1] * _unit(case, p) for p in rows if p.amplitude}
        return Screened(effect, 0.0, ({**start, **typical},), 0.0, trouble)
    scores.sort(key=lambda s: -s.gain)
    promised = scores[0].gain
    if any(p.dimension == "time" for p in rows):
        scores = _best_when_simulated(fitter, base, effect, scores)
    return Screened(effect, promised, _starts(scores, shape.name if shape else None), max(s.visibility for s in scores))


def _whole(case: Case, base: Fitted, effect: str, rows: Sequence[ParameterInfo]) -> Screened:
    """A whole friction is no small change, which a slope could judge: it is always refitted, from typical amplitudes
    and several values of its first shape."""
    start = start_of(base.system, effect, case.scales)
    start |= {p.name: _unit(case, p) for p in rows if p.amplitude}
    first = next((p.name for p in rows if p.purpose == "shape"), None)
    starts = tuple({**start, first: start[first] * factor} for factor in WHOLE_SHAPES) if first else (start,)
    most = base.cost  # more than that no model gains
    return Screened(effect, most, starts, most)


def _shapes(shape: ParameterInfo, start: Mapping[str, float]) -> list[dict[str, float]]:
    """Values of the first shape of an effect to try: multiples of what is typical, or from end to end of a fraction."""
    typical = start[shape.name]
    tried = (shape.lower, typical, shape.upper) if is_fraction(shape) else [typical * factor for factor in SHAPES]
    return [{shape.name: value} for value in tried]


def _starts(scores: list[_Score], shape: str | None) -> tuple[dict[str, float], ...]:
    """The best start, and the best one of another shape where the effect has one."""
    best = scores[0].start
    others = [s.start for s in scores[1:] if shape and s.start[shape] != best[shape]]
    return (best, *others[:1])


def _score(
    case: Case, base: Fitted, p: ParameterInfo, amplitude: float, values: dict[str, float], residuals: np.ndarray
) -> _Score:
    """`residuals` at these `values`, where the amplitude p is `amplitude` of its unit."""
    unit = _unit(case, p)
    slope, curvature = _beyond_imitation(base, (residuals - base.rows[0]) / amplitude)
    at = -slope / (curvature + AMPLITUDE_SD**-2.0)
    at = min(max(at, p.lower / unit), p.upper / unit)
    gain = -slope * at - 0.5 * (curvature + AMPLITUDE_SD**-2.0) * at**2
    value = min(max(at * unit, p.lower), p.upper)  # rounding may pass a bound
    start = p.typical if p.purpose == "share" else value  # a share is held at its typical value in fits
    return _Score(gain, {**values, p.name: start}, 0.5 * curvature)


def _best_when_simulated(fitter: Fitter, base: Fitted, effect: str, scores: Sequence[_Score]) -> list[_Score]:
    """The scores of a delay, that first whose start gains most when it is simulated: where the motion oscillates, a
    slope promises most at a delay that lies periods away from the best one."""
    gains = expected_gains(fitter, base, effect, [s.start for s in scores])
    return [scores[i] for i in sorted(range(len(scores)), key=lambda i: -gains[i])]


def expected_gains(fitter: Fitter, base: Fitted, effect: str, tried: Sequence[dict[str, float]]) -> list[float]:
    """Nats that `effect` brings at each of these values, once the free parameters follow; -inf where no simulation
    bears them."""

    def gain(residuals: np.ndarray | str) -> float:
        if isinstance(residuals, str):
            return -math.inf
        slope, curvature = _beyond_imitation(base, residuals - base.rows[0])
        return -slope - 0.5 * curvature

    return [gain(residuals) for residuals in _residuals_with(fitter, base, effect, tried)]


def _beyond_imitation(base: Fitted, direction: np.ndarray) -> tuple[float, float]:
    """Slope and curvature of the cost along a change of the residuals, less what the free parameters imitate."""
    residual, jacobian = base.rows
    dd, dr, jd, jr = direction @ direction, direction @ residual, direction @ jacobian, residual @ jacobian
    imitation = solved(base.precision, jd)
    return float(dr - imitation @ jr), max(float(dd - imitation @ jd), 0.0)


def _unit(case: Case, p: ParameterInfo) -> float:
    """The typical size of an amplitude on this rig."""
    if p.purpose == "share":
        return 1.0
    return (case.scales.get(p.element or "") or next(iter(case.scales.values()))).of(p.dimension) * abs(p.typical)


def _residuals_with(
    fitter: Fitter, base: Fitted, effect: str, tried: Sequence[dict[str, float]]
) -> list[np.ndarray | str]:
    """Whitened residuals of the training experiments at `base` with `effect` at each of these values, as they count; or
    why it cannot be simulated there."""
    systems = [extended(base.system, {effect: values}) for values in tried]
    return [seen if isinstance(seen, str) else marginal(base, seen) for seen in whitened_at(fitter, base, systems)]


def marginal(base: Fitted, seen: Sequence[np.ndarray]) -> np.ndarray:
    """The whitened residuals of each training experiment together, as they count in `base`."""
    return np.concatenate([of.residual(rows) for of, rows in zip(base.marginals, seen, strict=True)])


def whitened_at(fitter: Fitter, base: Fitted, systems: Sequence[System]) -> list[list[np.ndarray] | str]:
    """Whitened residuals of each training experiment at each of these systems, with the own unknowns of `base`; or why
    one cannot be simulated."""
    parts: list[list[np.ndarray]] = [[] for _ in systems]
    trouble = ["" for _ in systems]
    for i, own in zip(fitter.case.train, base.initial, strict=True):
        able = [k for k, why in enumerate(trouble) if not why]
        outputs, said = fitter.case.run_together(i, [systems[k] for k in able], own)
        for k, seen, why in zip(able, outputs, said, strict=True):
            trouble[k] = why
            if not why:
                parts[k].append(fitter.whitening[i].residual(seen))
    return [why or rows for why, rows in zip(trouble, parts, strict=True)]

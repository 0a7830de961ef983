"""Starts of effects whose amplitude is a share: fits hold the share at its typical value, the screen takes a part of
it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

from tendonlab.diagnosis.search.screen import Screened, expected_gains
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter
from tendonlab.simulation.catalog import ParameterInfo

KEPT = 0.5  # share of the promised gain that a start must keep to be used as it is
GRID = (0.1, 0.3, 1.0, 3.0)  # of each shape of the start
NEAR = (0.6, 1.0, 1.6)  # of the best there


def with_whole_shares(fitter: Fitter, base: Fitted, candidate: Screened) -> Screened:
    """The candidate with starts at which the whole of its share helps."""
    if not candidate.simulated:
        return candidate
    starts = (whole(fitter, base, candidate.effect, values, candidate.gain) for values in candidate.starts)
    return replace(candidate, starts=tuple(starts))


def whole(fitter: Fitter, base: Fitted, effect: str, start: Mapping[str, float], promised: float) -> dict[str, float]:
    """The `start`, or where the whole share does not keep what a part of it `promised`, nats: those shapes with which
    the whole brings most. Twice the excess at half the share is nearly the same friction."""
    info = fitter.case.system.info
    rows = [info.parameter(name) for name in info.effect(effect).parameters]
    shapes = [p for p in rows if p.purpose == "shape"]
    best, base = dict(start), base.counted()
    if not shapes or not any(p.purpose == "share" for p in rows):
        return best
    (gain,) = expected_gains(fitter, base, effect, [best])
    if gain >= KEPT * promised:
        return best
    for factors in (GRID, NEAR):
        tried = [best | _scaled(best, shapes, by) for by in product(factors, repeat=len(shapes))]
        gains = expected_gains(fitter, base, effect, tried)
        if max(gains) > gain:
            gain, best = max(gains), tried[gains.index(max(gains))]
    return best


def _scaled(values: Mapping[str, float], shapes: Sequence[ParameterInfo], by: Sequence[float]) -> dict[str, float]:
    pairs = zip(shapes, by, strict=True)
    return {p.name: min(max(values[p.name] * factor, p.lower), p.upper) for p, factor in pairs}

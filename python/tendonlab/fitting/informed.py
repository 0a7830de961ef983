"""What the data say nothing about: parameters on which no measured sample of any experiment depends."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tendonlab.fitting.priors import Free

if TYPE_CHECKING:
    from tendonlab.identification.result import Problem

NOTHING = 1e-8  # of a prior's variance: data that narrow it by less say nothing


def informed(jacobians: Iterable[np.ndarray], free: Sequence[Free]) -> np.ndarray:
    """For each free parameter, whether any residual depends on it. `jacobians`: of the residuals, in noise sd, by the
    coordinates, shape (rows, free)."""
    information = sum((np.sum(np.square(j), axis=0) for j in jacobians), np.zeros(len(free)))
    width = np.array([f.sd if np.isfinite(f.sd) else 1.0 for f in free])
    return np.asarray(information * width**2 > NOTHING)


def hold(best: Problem, found: dict[str, Any]) -> tuple[dict[str, Any], np.ndarray]:
    """The fit `found`, which ended at `best`, with every parameter that nothing informs back where its prior has it;
    and which of the free ones are informed, as is a limit that the fit stays clear of, but would reach there."""
    known = informed(found["jacobian"], best.free)
    while not known.all():
        values = list(found["values"])
        for f, seen in zip(best.free, known, strict=True):
            values[f.index] = values[f.index] if seen else f.expected
        there = best.at(values, found["initial"]).linearise()
        seen_there = known | informed(there["jacobian"], best.free)
        if (seen_there == known).all():
            same = {key: found[key] for key in ("converged", "message", "iterations")}
            return {**there, **same}, known
        known = seen_there
    return found, known

"""Holding what nothing informs: also where it mattered on the way, and not where it would matter again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from tendonlab.fitting.informed import hold, informed
from tendonlab.fitting.priors import Free

FREE = (
    Free("gain", 0, False, 1.0, 1.0, 1.0, 0.5, -np.inf, np.inf),
    Free("limit", 1, False, 1.0, 1.0, 1.0, 0.5, 0.0, np.inf),
    Free("unused", 2, True, 3.0, 3.0, 0.0, 0.5, 0.0, np.inf),
)


@dataclass(frozen=True)
class Clipped:
    """y = min(gain u, limit), measured at u = 1 and 2; a third parameter does nothing."""

    values: tuple[float, ...]
    free: tuple[Free, ...] = FREE

    def at(self, values: Sequence[float], initial: Sequence[Any]) -> Clipped:
        return replace(self, values=tuple(values))

    def linearise(self) -> dict[str, Any]:
        gain, limit, _ = self.values
        rows = [[u, 0.0, 0.0] if gain * u < limit else [0.0, 1.0, 0.0] for u in (1.0, 2.0)]
        return {
            "values": list(self.values), "initial": [], "jacobian": [np.array(rows)],
            "converged": False, "message": "", "iterations": 0,
        }  # fmt: skip


def fitted(*values: float) -> tuple[dict[str, Any], np.ndarray]:
    of = Clipped(values)
    return hold(of, {**of.linearise(), "converged": True, "message": "converged", "iterations": 7})  # type: ignore[arg-type]


def test_what_does_nothing_goes_back_to_its_prior() -> None:
    found, known = fitted(1.2, 1.5, 4.0)
    assert known.tolist() == [True, True, False]
    assert found["values"] == [1.2, 1.5, 3.0]
    assert (found["converged"], found["message"], found["iterations"]) == (True, "converged", 7)


def test_a_limit_that_is_not_reached_stays_where_its_prior_would_reach_it() -> None:
    """At its prior of 1 the limit would clip what the fit must not clip: the data say that it is larger."""
    found, known = fitted(0.9, 5.0, 3.0)
    assert known.tolist() == [True, True, False]
    assert found["values"][1] == 5.0


def test_a_limit_that_is_reached_nowhere_is_not_informed() -> None:
    found, known = fitted(0.4, 5.0, 3.0)
    assert known.tolist() == [True, False, False]
    assert found["values"] == [0.4, 1.0, 3.0]


@pytest.mark.parametrize(("slope", "known"), [(0.0, False), (1e-6, False), (1e-2, True)])
def test_information_counts_against_the_prior(slope: float, known: bool) -> None:
    assert informed([np.full((10, 1), slope)], FREE[:1]).tolist() == [known]

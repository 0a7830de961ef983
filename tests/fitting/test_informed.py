"""Parameters that the data do not constrain go back to their priors; a limit that matters there stays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from tendonlab._core import Free
from tendonlab.fitting.fitted import Fitted, Run
from tendonlab.fitting.problem import Problem
from tendonlab.fitting.uncertainty import informed

FREE = (
    Free(name="gain", index=0, log=False, scale=1.0, start=1.0, mean=1.0, sd=0.5),
    Free(name="limit", index=1, log=False, scale=1.0, start=1.0, mean=1.0, sd=0.5, lower=0.0),
    Free(name="unused", index=2, log=True, scale=3.0, start=3.0, mean=0.0, sd=0.5, lower=0.0),
)


@dataclass(frozen=True)
class Values:
    """A system that is nothing but its values."""

    parameters: dict[str, float]

    def with_parameters(self, changes: dict[str, float]) -> Values:
        return Values({**self.parameters, **changes})


class Clipped(Problem):
    """y = min(gain u, limit), measured at u = 1 and 2; a third parameter does nothing."""

    def linearise(self) -> Fitted:
        gain, limit = (self.system.parameters[name] for name in ("gain", "limit"))
        rows = np.array([[u, 0.0, 0.0] if gain * u < limit else [0.0, 1.0, 0.0] for u in (1.0, 2.0)])
        nothing, first = np.zeros((2, 0)), np.zeros(2, dtype=int)
        run = Run(residual=np.zeros(2), jacobian=rows, by_own=nothing, own=np.zeros(0), output=first, block=first)
        return Fitted(
            added=(), system=self.system, free=self.free, x=np.zeros(3), initial=((),), runs=(run,),
            at_bound=(False,) * 3, informed=tuple(informed([rows], self.free).tolist()), cost=0.0, prior_cost=0.0,
            converged=False, message="", num_iterations=0, levels=np.ones(1), known=np.ones(1), shares=np.ones(1),
        )  # fmt: skip


def held(gain: float, limit: float, unused: float) -> Fitted:
    """The fit that ended there, after what it does not constrain went back."""
    system: Any = Values({"gain": gain, "limit": limit, "unused": unused})
    anything: Any = None
    problem = Clipped(case=anything, floor=anything, system=system, free=FREE)
    fit = replace(problem.linearise(), converged=True, message="converged", num_iterations=7)
    return problem.return_to_prior(fit)


def test_what_does_nothing_goes_back_to_its_prior() -> None:
    fit = held(1.2, 1.5, 4.0)
    assert fit.not_informed == ("unused",)
    assert fit.system.parameters == {"gain": 1.2, "limit": 1.5, "unused": 3.0}
    assert (fit.converged, fit.message, fit.num_iterations) == (True, "converged", 7)


def test_a_limit_that_is_not_reached_stays_where_its_prior_would_reach_it() -> None:
    """At its prior of 1 the limit would clip what the fit must not clip: the data say that it is larger."""
    fit = held(0.9, 5.0, 3.0)
    assert fit.not_informed == ("unused",)
    assert fit.system.parameters["limit"] == 5.0


def test_a_limit_that_is_reached_nowhere_is_not_informed() -> None:
    fit = held(0.4, 5.0, 3.0)
    assert fit.not_informed == ("limit", "unused")
    assert fit.system.parameters == {"gain": 0.4, "limit": 1.0, "unused": 3.0}


@pytest.mark.parametrize(("slope", "known"), [(0.0, False), (1e-6, False), (1e-2, True)])
def test_information_counts_against_the_prior(slope: float, known: bool) -> None:
    assert informed([np.full((10, 1), slope)], FREE[:1]).tolist() == [known]

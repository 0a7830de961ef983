"""Refits of candidates, on fits whose outcome is given."""

import math
from types import SimpleNamespace
from typing import Any

import pytest

from tendonlab.diagnosis.search.refit import refit
from tendonlab.diagnosis.search.screen import Lead


def outcome(evidence: float) -> Any:
    return SimpleNamespace(evidence=evidence, converged=True, mean_square=1.0)


@pytest.mark.parametrize(("evidences", "expected"), [((math.inf, 5.0), 5.0), ((math.nan,), None), ((3.0, 4.0), 4.0)])
def test_a_fit_whose_derivatives_exploded_outbids_nothing(evidences: tuple[float, ...], expected: float | None) -> None:
    left = iter(evidences)
    fitter: Any = SimpleNamespace(
        fit=lambda *_, **__: outcome(next(left)), case=SimpleNamespace(dataset=SimpleNamespace(parameters={}))
    )
    system = SimpleNamespace(with_effects=lambda _: None)
    best: Any = SimpleNamespace(system=system, added=(), initial=(), evidence=0.0, free=(), x=())
    found = refit(fitter, best, Lead("joint:stribeck", 9.0, ({},) * len(evidences), 1.0), rival=None)
    assert (found.evidence if found else None) == expected

"""Refits of candidates: which of two fits is kept."""

import math
from dataclasses import replace

import pytest

from tendonlab.diagnosis.search.refit import more_evident
from tendonlab.fitting.fitted import Fitted


def with_evidence(fitted: Fitted, evidence: float) -> Fitted:
    """The same fit with its evidence already computed, as cached_property stores it."""
    made = replace(fitted)
    made.__dict__["evidence"] = evidence
    return made


@pytest.mark.parametrize(
    ("evidences", "expected"), [((math.inf, 5.0), 5.0), ((math.nan,), None), ((3.0, 4.0), 4.0), ((4.0, 3.0), 4.0)]
)
def test_a_fit_whose_derivatives_exploded_outbids_nothing(
    nominal: Fitted, evidences: tuple[float, ...], expected: float | None
) -> None:
    best = None
    for evidence in evidences:
        best = more_evident(best, with_evidence(nominal, evidence))
    assert (best.evidence if best else None) == expected


def test_a_failed_fit_leaves_the_best_one(nominal: Fitted) -> None:
    assert more_evident(nominal, None) is nominal

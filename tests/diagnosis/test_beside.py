"""Effects judged beside each other: what their rounds say of each, of sets, and of there being none."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from tendonlab.diagnosis.answer.verdict import _marginals
from tendonlab.diagnosis.search.contest import DETECT, Round, Trial
from tendonlab.diagnosis.search.rivals import Seat

STRIBECK, ASYMMETRY, DELAY = "joint:stribeck", "joint:asymmetry", "actuation:delay"


def trial(name: str, evidence: float) -> Trial:
    return Trial(name, None, evidence, evidence, 1.0)  # type: ignore[arg-type]


def seat(effect: str, *others: str, **probability: float) -> Round:
    names = {"stribeck": STRIBECK, "asymmetry": ASYMMETRY, "delay": DELAY, "none": None}
    shares = {names[key]: p for key, p in probability.items()}
    own = trial(effect, 100.0) if effect else None
    return Round(others, (), (own,) if own else (), shares, own, set())


def test_an_effect_is_as_probable_as_beside_the_others() -> None:
    """Two are selected; the first shares its place with a delay, and a third is not wanted."""
    rounds = [
        seat(STRIBECK, ASYMMETRY, stribeck=0.6, delay=0.3, none=0.1),
        seat(ASYMMETRY, STRIBECK, asymmetry=0.9, none=0.1),
        seat("", STRIBECK, ASYMMETRY, delay=0.2, none=0.8),
    ]
    effects, sets = _marginals(rounds)
    assert effects == pytest.approx({STRIBECK: 0.6, ASYMMETRY: 0.9, DELAY: 0.3 + 0.6 * 0.9 * 0.2})
    shares = {tuple(sorted(s["effects"])): s["probability"] for s in sets}
    assert shares[tuple(sorted((STRIBECK, ASYMMETRY)))] == pytest.approx(0.6 * 0.9 * 0.8)
    assert shares[tuple(sorted((DELAY, ASYMMETRY)))] == pytest.approx(0.3 * 0.9)
    assert shares[STRIBECK,] == pytest.approx(0.1 * 0.6)
    assert sum(shares.values()) <= 1.0


def test_one_effect_is_as_probable_as_in_its_round() -> None:
    effects, sets = _marginals([seat(STRIBECK, stribeck=0.7, none=0.3), seat("", STRIBECK, delay=0.1, none=0.9)])
    assert effects == pytest.approx({STRIBECK: 0.7, DELAY: 0.07})
    assert [s["probability"] for s in sets] == pytest.approx([0.63, 0.07])


def test_as_many_effects_as_are_allowed_are_one_set() -> None:
    rounds = [seat(STRIBECK, ASYMMETRY, stribeck=0.9, none=0.1), seat(ASYMMETRY, STRIBECK, asymmetry=0.8, none=0.2)]
    _, sets = _marginals(rounds)
    assert {tuple(sorted(s["effects"])): round(s["probability"], 6) for s in sets} == {
        (ASYMMETRY, STRIBECK): 0.72, (ASYMMETRY,): 0.08, (STRIBECK,): 0.18,
    }  # fmt: skip


def test_a_rival_is_the_best_other_claim_that_is_not_far_behind() -> None:
    def rival(*trials: Trial) -> Trial | None:
        others: Any = SimpleNamespace(added=(ASYMMETRY,))
        return Seat(
            others,
            trials[0],
            Round((ASYMMETRY,), (), trials, {}, trials[0], {t.effect for t in trials if DETECT.passed(t)}),
        ).rival()

    own, near, far = trial(STRIBECK, 100.0), trial(DELAY, 70.0), trial("motor:stribeck", 40.0)
    assert rival(own, far, near) is near
    assert rival(own, far) is None
    assert rival(own, Trial(DELAY, None, 70.0, 1.0, 1.0)) is None  # type: ignore[arg-type]

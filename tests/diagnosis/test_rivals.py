"""Effects that contest each other's places: what their rounds say of each, of sets, and of there being none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from tendonlab.diagnosis.answer.verdict import marginals
from tendonlab.diagnosis.search.contest import Round, probabilities
from tendonlab.diagnosis.search.rivals import Place, drop_effects
from tendonlab.diagnosis.search.trial import DETECT, Bar, Trial
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter

STRIBECK, ASYMMETRY, DELAY = "joint:stribeck", "joint:asymmetry", "actuation:delay"
NAMES = {"stribeck": STRIBECK, "asymmetry": ASYMMETRY, "delay": DELAY, "none": None}


@pytest.fixture
def trial(nominal: Fitted) -> Callable[..., Trial]:
    """A trial that gained so much evidence, and as much on left-out experiments unless stated."""

    def made(effect: str, evidence: float, left_out: float | None = None) -> Trial:
        return Trial(effect, nominal, evidence, evidence if left_out is None else left_out, 1.0)

    return made


@pytest.fixture
def contest(trial: Callable[..., Trial]) -> Callable[..., Round]:
    """A round of known probabilities that `effect` won, "" for none, in addition to the others."""

    def made(effect: str, *others: str, **probability: float) -> Round:
        accepted = trial(effect, 100.0) if effect else None
        shares = {NAMES[key]: p for key, p in probability.items()}
        return Round(others, (), (accepted,) if accepted else (), shares, accepted, set())

    return made


def test_an_effect_is_as_probable_as_given_the_others(contest: Callable[..., Round]) -> None:
    """Two are selected; a delay is a rival of the first, and a third effect is not needed."""
    rounds = [
        contest(STRIBECK, ASYMMETRY, stribeck=0.6, delay=0.3, none=0.1),
        contest(ASYMMETRY, STRIBECK, asymmetry=0.9, none=0.1),
        contest("", STRIBECK, ASYMMETRY, delay=0.2, none=0.8),
    ]
    effects, sets = marginals(rounds)
    assert effects == pytest.approx({STRIBECK: 0.6, ASYMMETRY: 0.9, DELAY: 0.3 + 0.6 * 0.9 * 0.2})
    shares = {tuple(sorted(s["effects"])): s["probability"] for s in sets}
    assert shares[tuple(sorted((STRIBECK, ASYMMETRY)))] == pytest.approx(0.6 * 0.9 * 0.8)
    assert shares[tuple(sorted((DELAY, ASYMMETRY)))] == pytest.approx(0.3 * 0.9)
    assert shares[STRIBECK,] == pytest.approx(0.1 * 0.6)
    assert sum(shares.values()) <= 1.0


def test_one_effect_is_as_probable_as_in_its_round(contest: Callable[..., Round]) -> None:
    effects, sets = marginals([contest(STRIBECK, stribeck=0.7, none=0.3), contest("", STRIBECK, delay=0.1, none=0.9)])
    assert effects == pytest.approx({STRIBECK: 0.7, DELAY: 0.07})
    assert [s["probability"] for s in sets] == pytest.approx([0.63, 0.07])


def test_as_many_effects_as_are_allowed_are_one_set(contest: Callable[..., Round]) -> None:
    rounds = [
        contest(STRIBECK, ASYMMETRY, stribeck=0.9, none=0.1),
        contest(ASYMMETRY, STRIBECK, asymmetry=0.8, none=0.2),
    ]
    _, sets = marginals(rounds)
    assert {tuple(sorted(s["effects"])): round(s["probability"], 6) for s in sets} == {
        (ASYMMETRY, STRIBECK): 0.72, (ASYMMETRY,): 0.08, (STRIBECK,): 0.18,
    }  # fmt: skip


def test_a_rival_is_the_best_other_trial_that_is_established_and_not_far_behind(
    trial: Callable[..., Trial], nominal: Fitted
) -> None:
    others = replace(nominal, added=(ASYMMETRY,))

    def rival(*trials: Trial) -> Trial | None:
        established = {t.effect for t in trials if DETECT.passed(t)}
        contest = Round.of(others, (), trials, established=established, bar=DETECT, accepted=trials[0])
        return Place(others, trials[0], contest).rival()

    holder, near, far = trial(STRIBECK, 100.0), trial(DELAY, 70.0), trial("motor:stribeck", 40.0)
    assert rival(holder, far, near) is near
    assert rival(holder, far) is None
    assert rival(holder, trial(DELAY, 70.0, left_out=1.0)) is None


def test_a_rival_takes_the_place_and_not_the_companions(trial: Callable[..., Trial], nominal: Fitted) -> None:
    others = replace(nominal, added=(ASYMMETRY,))
    holder, rival = trial(STRIBECK, 100.0), trial(DELAY, 120.0)
    contest = Round.of(others, (), (rival, holder), established={DELAY}, bar=DETECT, accepted=holder)
    place = Place(others, holder, contest).with_rival(rival)
    assert place.key == (frozenset({ASYMMETRY}), DELAY)
    assert place.round.accepted is rival
    assert place.round.probability == contest.probability


def test_dropping_an_effect_keeps_the_values_of_all_else(fitter: Fitter, nominal: Fitted) -> None:
    stribeck = {"joint_static_excess": 0.1, "joint_stribeck_velocity": 0.07}
    system = nominal.system.with_effects({STRIBECK: stribeck, "actuation:offset": {"actuation_offset": 0.02}})
    tuned = system.with_parameters({"joint_inertia": 1.1 * system.parameters["joint_inertia"]})
    left = drop_effects(fitter, replace(nominal, system=tuned, added=(STRIBECK, "actuation:offset")), [STRIBECK])
    assert STRIBECK not in left.effects
    assert left.parameters == {name: value for name, value in tuned.parameters.items() if name not in stribeck}


def test_effects_that_are_not_established_rank_behind_none(trial: Callable[..., Trial]) -> None:
    bar = Bar(evidence=10.0, left_out=3.0, steady=0.0)
    trials = [trial(STRIBECK, 500.0), trial("joint:coulomb", 30.0), trial(ASYMMETRY, 5.0)]
    established = probabilities(trials, {t.effect for t in trials if bar.passed(t)}, bar, temperature=4.0)
    assert sum(established.values()) == pytest.approx(1.0)
    assert max(established, key=established.__getitem__) == STRIBECK
    nothing = probabilities(trials, set(), bar, temperature=4.0)
    assert nothing[None] > 0.5
    assert max(nothing, key=nothing.__getitem__) is None

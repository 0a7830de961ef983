"""Effects that contest each other's places: what their rounds say of each, of sets, and of there being none."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.diagnosis.answer.verdict import Levels, decide, marginals
from tendonlab.diagnosis.search import rivals, workshop
from tendonlab.diagnosis.search.contest import Round, next_effect, probabilities
from tendonlab.diagnosis.search.rivals import Place, drop_effects, improve
from tendonlab.diagnosis.search.screen import Screened
from tendonlab.diagnosis.search.trial import DETECT, Bar, Trial, bar_for_further_effect
from tendonlab.diagnosis.search.workshop import Refitted, Workshop
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


def test_effects_that_are_nearly_as_probable_as_the_accepted_one_are_named_together(
    contest: Callable[..., Round],
) -> None:
    """An effect alone is no group, nor are effects of which none was accepted."""
    rounds = [
        contest(STRIBECK, stribeck=0.5, delay=0.3, asymmetry=0.05, none=0.15),
        contest(ASYMMETRY, STRIBECK, asymmetry=0.9, delay=0.05, none=0.05),
        contest("", STRIBECK, ASYMMETRY, delay=0.4, none=0.6),
    ]
    levels = Levels(nominal=9.0, tuned=4.0, refitted=4.0, explained=0.9, left=1.3, repeated=True)
    assert decide(rounds, (STRIBECK, ASYMMETRY), levels).indistinguishable == [[STRIBECK, DELAY]]


def test_a_rival_is_the_best_other_trial_that_is_established_and_not_far_behind(
    trial: Callable[..., Trial], nominal: Fitted
) -> None:
    others = replace(nominal, added=(ASYMMETRY,))

    def rival(*trials: Trial) -> Trial | None:
        established = {t.effect for t in trials if DETECT.passed(t)}
        contest = Round.of(others, (), trials, established=established, bar=DETECT, accepted=trials[0], failed={})
        return Place(others, trials[0], contest).rival()

    holder, near, far = trial(STRIBECK, 100.0), trial(DELAY, 70.0), trial("motor:stribeck", 40.0)
    assert rival(holder, far, near) is near
    assert rival(holder, far) is None
    assert rival(holder, trial(DELAY, 70.0, left_out=1.0)) is None


@pytest.mark.parametrize(("ahead", "swaps"), [(-5.0, False), (5.0, False), (15.0, True)])
def test_a_rival_takes_over_where_it_is_clearly_better(
    trial: Callable[..., Trial], fitter: Fitter, nominal: Fitted, ahead: float, swaps: bool
) -> None:
    """By more evidence than would establish an effect. The model is full, so no effect is added to the rival."""
    others = replace(nominal, added=("actuation:offset", "load:offset"))
    base = replace(nominal, added=(STRIBECK, *others.added))
    holder, rival = trial(STRIBECK, 100.0), trial(ASYMMETRY, 100.0 + ahead)
    contest = Round.of(
        others, (), (holder, rival), established={STRIBECK, ASYMMETRY}, bar=DETECT, accepted=holder, failed={}
    )
    place = Place(others, holder, contest)
    with ThreadPoolExecutor(1) as pool:
        shop = Workshop(pool, _core.Cancel(), progress=False, library=())
        improved = improve(fitter, base, [place], {place.key: place}, shop)
    assert (improved is not None) == swaps
    if improved is not None:
        assert improved.won is not None
        assert improved.won.holder is rival


@pytest.mark.parametrize(("above", "halves", "added"), [(1.0, True, True), (1.0, False, False), (-1.0, True, False)])
def test_a_rival_with_one_more_effect_wins_by_evidence_and_by_predicting_halves(
    trial: Callable[..., Trial],
    fitter: Fitter,
    above: float,
    halves: bool,
    added: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Evidence above the bar alone is not enough, nor are halves that are predicted better."""
    base: Any = SimpleNamespace(evidence=-50.0, counted=lambda shares: base)
    pair: Any = SimpleNamespace(evidence=-50.0 + bar_for_further_effect(fitter).evidence + above, shares=())
    round_ = SimpleNamespace(accepted=SimpleNamespace(fitted=pair))
    monkeypatch.setattr(rivals, "next_effect", lambda *_, **__: round_)
    monkeypatch.setattr(rivals, "predicts_better", lambda _, before, after: halves and (before, after) == (base, pair))
    shop: Any = None
    found = rivals._rival_and_one_more(fitter, base, trial(DELAY, 100.0), {}, shop)
    assert (found is not None) == added
    if found is not None:
        assert found.model is pair


def test_a_rival_takes_the_place_and_not_the_companions(trial: Callable[..., Trial], nominal: Fitted) -> None:
    others = replace(nominal, added=(ASYMMETRY,))
    holder, rival = trial(STRIBECK, 100.0), trial(DELAY, 120.0)
    contest = Round.of(others, (), (rival, holder), established={DELAY}, bar=DETECT, accepted=holder, failed={})
    place = Place(others, holder, contest).with_rival(rival)
    assert place.key == (frozenset({ASYMMETRY}), DELAY)
    assert place.round.accepted is rival
    assert place.round.probability == contest.probability


@pytest.mark.parametrize(("gain", "is_new"), [(90.0, False), (3.0, True)])
def test_a_place_is_contested_anew_where_the_others_had_ended_in_a_wrong_optimum(
    gain: float, is_new: bool, trial: Callable[..., Trial], nominal: Fitted, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The others, started where they ended with the effect, do without it nearly as well: its contest meant nothing."""
    monkeypatch.setattr(rivals, "refitted_without", lambda *args: nominal)
    monkeypatch.setattr(rivals.Trial, "of", classmethod(lambda cls, effect, *models: trial(effect, gain)))
    shop: Any = SimpleNamespace(
        screen_all=lambda *args: [], refit_all=lambda *args, incumbent, **kw: Refitted([incumbent], {})
    )
    both = replace(nominal, added=(STRIBECK, DELAY))
    contest = Round.of(nominal, (), [], established=set(), bar=DETECT, accepted=None, failed={})
    old = [
        Place(replace(nominal, added=(o,)), trial(e, 100.0), contest) for o, e in ((DELAY, STRIBECK), (STRIBECK, DELAY))
    ]
    fitter: Any = SimpleNamespace(left_by=lambda model: None)
    found = rivals.contest_each_place(fitter, both, {place.key: place for place in old}, shop)
    assert [place.holder.effect for place in found] == [STRIBECK, DELAY]
    assert all((place not in old) == is_new for place in found)
    assert all((place.holder.evidence_gain == gain) == is_new for place in found)


@pytest.mark.parametrize("predicts", [True, False])
def test_a_lead_that_predicts_nothing_better_makes_a_tie(
    predicts: bool, trial: Callable[..., Trial], nominal: Fitted, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not, as before, a rival without a chance."""
    monkeypatch.setattr(rivals, "refitted_without", lambda *args: nominal)
    monkeypatch.setattr(rivals.Trial, "of", classmethod(lambda cls, effect, *models: trial(effect, 100.0)))
    monkeypatch.setattr(rivals, "predicts_better", lambda *args: predicts)
    shop: Any = SimpleNamespace(
        screen_all=lambda *args: [],
        refit_all=lambda *args, incumbent, **kw: Refitted([trial(DELAY, 180.0), incumbent], {}),
    )
    fitter: Any = SimpleNamespace(left_by=lambda model: None)
    (place,) = rivals.contest_each_place(fitter, replace(nominal, added=(STRIBECK,)), {}, shop)
    rival = place.rival()
    assert rival is not None
    assert rival.evidence_gain == (180.0 if predicts else 100.0)
    assert place.round.probability[DELAY] == pytest.approx(1.0 if predicts else 0.5, abs=0.01)


@pytest.mark.parametrize(
    ("rival", "lead", "takes"), [(DELAY, 0.0, True), (DELAY, -1.0, False), (ASYMMETRY, 0.0, False)]
)
def test_a_rival_that_says_as_much_with_fewer_parameters_takes_the_place(
    rival: str, lead: float, takes: bool, trial: Callable[..., Trial], fitter: Fitter, nominal: Fitted
) -> None:
    """Stribeck friction and an asymmetry have two parameters each, a delay has one."""
    others = replace(nominal, added=("actuation:offset",))
    holder, other = trial(STRIBECK, 100.0), trial(rival, 100.0 + lead)
    contest = Round.of(
        others, (), (holder, other), established={STRIBECK, rival}, bar=DETECT, accepted=holder, failed={}
    )
    full = replace(nominal, added=(STRIBECK, "actuation:offset", "load:offset"))
    found = improve(fitter, full, [Place(others, holder, contest)], {}, SimpleNamespace())  # type: ignore[arg-type]
    assert (found is not None and found.won is not None and found.won.holder is other) is takes


def test_dropping_an_effect_keeps_the_values_of_all_else(fitter: Fitter, nominal: Fitted) -> None:
    stribeck = {"joint_static_excess": 0.1, "joint_stribeck_velocity": 0.07}
    system = nominal.system.with_effects({STRIBECK: stribeck, "actuation:offset": {"actuation_offset": 0.02}})
    tuned = system.with_parameters({"joint_inertia": 1.1 * system.parameters["joint_inertia"]})
    left = drop_effects(fitter, replace(nominal, system=tuned, added=(STRIBECK, "actuation:offset")), [STRIBECK])
    assert STRIBECK not in left.effects
    assert left.parameters == {name: value for name, value in tuned.parameters.items() if name not in stribeck}


@pytest.mark.parametrize(
    ("effect", "values"),
    [
        ("joint:presliding", {"joint_bristle_stiffness": 50.0, "joint_bristle_damping": 0.1}),
        (STRIBECK, {"joint_static_excess": 0.1, "joint_stribeck_velocity": 0.07}),
    ],
)
def test_what_cannot_be_without_an_effect_goes_with_it(
    effect: str, values: dict[str, float], fitter: Fitter, nominal: Fitted
) -> None:
    """A bristle without dry friction ended diagnoses, and Stribeck friction alone took its place."""
    bare = replace(fitter.case, system=_without_dry_friction(nominal.system))
    effects = {effect: values, "actuation:offset": {"actuation_offset": 0.02}}
    system = bare.system.with_effects({"joint:coulomb": {"joint_coulomb": 0.1}}).with_effects(effects)
    model = replace(nominal, system=system, added=(effect, "joint:coulomb", "actuation:offset"))
    left = drop_effects(replace(fitter, case=bare), model, ["joint:coulomb"])
    assert set(left.effects) - set(bare.system.effects) == {"actuation:offset"}
    whole = drop_effects(replace(fitter, case=bare), model, [])  # in whatever order they were added
    assert set(whole.effects) == set(system.effects)
    assert whole.parameters == system.parameters


def _without_dry_friction(system: tl.System) -> tl.System:
    effects = tuple(name for name in system.effects if name != "joint:coulomb")
    parameters = {name: value for name, value in system.parameters.items() if name != "joint_coulomb"}
    return tl.System(system.kind, parameters=parameters, effects=effects)


def test_progress_says_for_which_effect_candidates_are_screened(
    fitter: Fitter, nominal: Fitted, monkeypatch: pytest.MonkeyPatch
) -> None:
    labels = []
    monkeypatch.setattr(Workshop, "screen_all", lambda shop, fitter, base, label: labels.append(label) or [])
    with ThreadPoolExecutor(1) as pool:
        shop = Workshop(pool, _core.Cancel(), progress=False, library=())
        for added in ((), (STRIBECK,), (STRIBECK, DELAY)):
            assert next_effect(fitter, replace(nominal, added=added), largest_gain=0.0, shop=shop) is None
    assert labels == ["effect", "effect 2", "effect 3"]


def test_a_trial_that_is_fitted_already_contests_without_a_fit(
    trial: Callable[..., Trial], fitter: Fitter, nominal: Fitted, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = []

    def noted(fitter: Fitter, base: Fitted, candidate: Screened, *, pace: float) -> Trial:
        tried.append(candidate.effect)
        return trial(candidate.effect, 20.0)

    monkeypatch.setattr(workshop, "_tried", noted)
    chosen = [Screened(effect, 1.0, ({},), 1.0) for effect in (DELAY, ASYMMETRY)]
    with ThreadPoolExecutor(1) as pool:
        shop = Workshop(pool, _core.Cancel(), progress=False, library=())
        trials = shop.refit_all(fitter, nominal, chosen, "", least=10.0, incumbent=trial(STRIBECK, 30.0)).trials
    assert tried == [DELAY, ASYMMETRY]
    assert sorted(t.effect for t in trials) == sorted([STRIBECK, DELAY, ASYMMETRY])


def test_overwhelming_evidence_gives_probabilities(trial: Callable[..., Trial]) -> None:
    trials = [trial(STRIBECK, 1e6), trial(ASYMMETRY, 1e6 - 4.0), trial(DELAY, 2e3)]
    found = probabilities(trials, {t.effect for t in trials}, DETECT, temperature=4.0)
    assert found[STRIBECK] == pytest.approx(1.0 / (1.0 + math.exp(-1.0)))
    assert found[ASYMMETRY] == pytest.approx(1.0 - found[STRIBECK])
    assert found[DELAY] == found[None] == 0.0


def test_effects_that_are_not_established_rank_behind_none(trial: Callable[..., Trial]) -> None:
    bar = Bar(evidence=10.0, left_out=3.0, doubted=False)
    trials = [trial(STRIBECK, 500.0), trial("joint:coulomb", 30.0), trial(ASYMMETRY, 5.0)]
    established = probabilities(trials, {t.effect for t in trials if bar.passed(t)}, bar, temperature=4.0)
    assert sum(established.values()) == pytest.approx(1.0)
    assert max(established, key=established.__getitem__) == STRIBECK
    nothing = probabilities(trials, set(), bar, temperature=4.0)
    assert nothing[None] > 0.5
    assert max(nothing, key=nothing.__getitem__) is None

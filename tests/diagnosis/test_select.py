"""The search over effects, on models that are stated instead of fitted: who is refitted, who contests, when it ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from tendonlab.diagnosis.search import contest, rivals, select, workshop
from tendonlab.diagnosis.search.contest import Round, next_effect
from tendonlab.diagnosis.search.rivals import Place, contest_each_place, improve
from tendonlab.diagnosis.search.screen import Screened
from tendonlab.diagnosis.search.select import select_effects
from tendonlab.diagnosis.search.trial import Trial
from tendonlab.diagnosis.search.workshop import Refitted
from tendonlab.errors import NumericalError


def repeated(**more: Any) -> Any:
    """A fitter whose floor is from repeats: no model changes it."""
    case = SimpleNamespace(replay=SimpleNamespace(output="joint_angle"))
    fitter = SimpleNamespace(floor=SimpleNamespace(repeated=True), case=case, **more)
    fitter.left_by = lambda model: fitter
    return fitter


FITTER = repeated()


def model(*added: str, evidence: float = 0.0, exploded: bool = False) -> Any:
    made = SimpleNamespace(
        added=added, evidence=evidence, mean_square=10.0, whitened_square=10.0, shares=(), initial=(), free=[], x=[]
    )
    made.exploded = exploded
    made.counted = lambda *_: made
    return made


def trial(effect: str, gain: float, *others: str, left_out: float = 100.0) -> Trial:
    fitted = model(*others, effect, evidence=gain)
    fitted.mean_square = 5.0
    return Trial(effect, fitted, gain, left_out, 0.0)


def screened(effect: str, gain: float, *, trouble: str = "") -> Screened:
    return Screened(effect, gain, ({},), 1.0, trouble)


class Shop:
    """A workshop whose screens and refits are stated; it notes which candidates were refitted."""

    def __init__(self, candidates: Sequence[Screened], gains: dict[str, float]) -> None:
        self.candidates, self.gains, self.refitted, self.calls = candidates, gains, list[str](), list[list[str]]()
        self.pool = None

    def screen_all(self, fitter: Any, base: Any, label: str) -> list[Screened]:
        return list(self.candidates)

    def refit_all(
        self, fitter: Any, base: Any, chosen: Any, label: str, *, least: float, incumbent: Any = None
    ) -> Refitted:
        self.refitted = [s.effect for s in chosen]
        self.calls.append(self.refitted)
        fitted = [trial(name, self.gains[name], *base.added) for name in self.refitted if name in self.gains]
        failed = {name: "no fit" for name in self.refitted if name not in self.gains}
        return Refitted(sorted([*fitted, *([incumbent] if incumbent else [])], key=lambda t: -t.evidence_gain), failed)


@pytest.fixture
def worthy(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    def set_up(*, worth: bool = True, strained: bool = False) -> None:
        monkeypatch.setattr(contest, "strained", lambda *_: strained)
        monkeypatch.setattr(contest, "at_believed_values", lambda fitter, base: (fitter, base))
        monkeypatch.setattr(contest, "_worth_adding", lambda *_, **__: worth)
        monkeypatch.setattr(contest, "plainest_first", lambda trials, _: trials)
        monkeypatch.setattr(workshop, "with_twins_even", lambda _, trials: trials)

    return set_up


@pytest.mark.parametrize(("added", "least", "most"), [((), 3.0, 8), (("a",), 9.0, 4)])
def test_candidates_are_refitted_that_promise_a_third_of_the_bar(
    added: tuple[str, ...], least: float, most: int, worthy: Callable[..., None]
) -> None:
    """The bars are 10 and 30 nats; eight candidates for the first effect, four for each further one. Where none of the
    eight is established, the first effect is sought among four others as well."""
    worthy()
    few: Any = Shop([screened("x", least + 0.1), screened("y", least - 0.1)], {})
    next_effect(FITTER, model(*added), largest_gain=0.0, shop=few)
    assert few.refitted == ["x"]
    many: Any = Shop([screened(f"c{k}", 100.0 - k) for k in range(12)], {})
    next_effect(FITTER, model(*added), largest_gain=0.0, shop=many)
    assert many.calls[0] == [f"c{k}" for k in range(most)]
    assert many.calls[1:] == ([] if added else [[f"c{k}" for k in range(8, 12)]])


@pytest.mark.parametrize(
    ("gains", "near", "found", "calls"),
    [
        ({"c9": 500.0}, 10.0, "c9", 2),  # beside two missing effects a screen promises little of either
        ({"c3": 40.0, "c9": 500.0}, 10.0, "c3", 1),
        ({"c9": 500.0}, 1.2, None, 1),  # near the floor nothing is missed that matters
    ],
)
def test_no_first_effect_is_missed_because_others_promised_more(
    gains: dict[str, float], near: float, found: str | None, calls: int, worthy: Callable[..., None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    worthy()
    monkeypatch.setattr(contest, "_least_gain", lambda *_: 10.0)
    monkeypatch.setattr(workshop, "counted_alike", lambda trials, _: sorted(trials, key=lambda t: -t.evidence_gain))
    shop: Any = Shop([screened(f"c{k}", 100.0 - k) for k in range(12)], gains)
    base = model()
    base.mean_square = near
    contested = next_effect(FITTER, base, largest_gain=0.0, shop=shop)
    assert contested is not None
    assert (contested.accepted.effect if contested.accepted else None) == found
    assert len(shop.calls) == calls


@pytest.mark.parametrize(("near", "worth", "accepted"), [(1.2, True, "y"), (1.4, True, "x"), (1.4, False, "y")])
def test_near_the_floor_an_effect_that_beliefs_ask_for_comes_first(
    near: float, worth: bool, accepted: str, worthy: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    worthy(worth=worth)
    monkeypatch.setattr(contest, "_least_gain", lambda *_: 10.0)
    monkeypatch.setattr(contest, "restores_belief", lambda case, base, model: "y" in model.added)
    base = model()
    base.mean_square = near
    shop: Any = Shop([screened("x", 50.0), screened("y", 50.0)], {"x": 40.0, "y": 20.0})
    found = next_effect(FITTER, base, largest_gain=0.0, shop=shop)
    assert found is not None
    assert found.accepted is not None
    assert (found.accepted.effect, found.trials[0].effect) == (accepted, accepted)
    assert found.established == ({"x", "y"} if worth else {"y"})


@pytest.mark.parametrize("strained", [False, True])
def test_a_candidate_that_fails_at_strained_values_is_tried_at_nominal_ones(
    strained: bool, worthy: Callable[..., None]
) -> None:
    worthy(strained=strained)
    shop: Any = Shop([screened("x", 50.0), screened("y", 0.0), screened("z", 0.0, trouble="stopped")], {"x": 40.0})
    found = next_effect(FITTER, model(), largest_gain=0.0, shop=shop)
    assert found is not None
    assert shop.refitted == (["x", "z"] if strained else ["x"])
    assert found.failed == {"z": "no fit" if strained else "stopped"}


@pytest.mark.parametrize(
    ("gains", "worth", "accepted", "established"),
    [
        ({"x": 40.0, "y": 20.0, "z": 5.0}, True, "x", {"x", "y"}),
        ({"x": 40.0, "y": 20.0, "z": 5.0}, False, None, set()),
        ({"x": 9.0, "y": 8.0, "z": 5.0}, True, None, set()),
    ],
)
def test_the_best_established_effect_that_is_worth_it_is_accepted(
    gains: dict[str, float], worth: bool, accepted: str | None, established: set[str], worthy: Callable[..., None]
) -> None:
    worthy(worth=worth)
    shop: Any = Shop([screened(name, 50.0) for name in gains], gains)
    found = next_effect(FITTER, model(), largest_gain=0.0, shop=shop)
    assert found is not None
    assert (found.accepted.effect if found.accepted else None) == accepted
    assert found.established == established
    assert [t.effect for t in found.trials] == ["x", "y", "z"]


def place(effect: str, gain: float, *others: str, trials: Sequence[Trial] = (), established: Any = ()) -> Place:
    holder = trial(effect, gain, *others)
    round_ = Round(others, (), (holder, *trials), {}, holder, {effect, *established})
    return Place(model(*others), holder, round_)


def test_the_weakest_effect_below_the_bar_of_further_effects_is_dropped() -> None:
    """30 nats, or a hundredth of what the strongest gains. The strongest stays whatever it gains."""
    shop: Any = None
    contested = [place("a", 5000.0, "b", "c"), place("b", 45.0, "a", "c"), place("c", 40.0, "a", "b")]
    better = improve(FITTER, model("a", "b", "c"), contested, {}, shop)
    assert better is not None
    assert (better.model, better.won) == (contested[2].others, None)
    assert improve(FITTER, model("a", "b"), [place("a", 500.0, "b"), place("b", 31.0, "a")], {}, shop) is None
    assert improve(FITTER, model("a"), [place("a", 12.0)], {}, shop) is None


def test_the_rival_of_most_evidence_takes_over_first() -> None:
    shop: Any = None
    swaps = [
        place(effect, 100.0, other, trials=[trial(rival, gain, other)], established=[rival])
        for effect, other, rival, gain in [("a", "b", "p", 115.0), ("b", "a", "q", 125.0)]
    ]
    better = improve(FITTER, model("a", "b"), swaps, {}, shop)
    assert better is not None
    assert better.won is not None
    assert (better.model.added, better.won.holder.effect) == (("a", "q"), "q")


def test_a_rival_gets_one_effect_more_only_where_there_is_room(monkeypatch: pytest.MonkeyPatch) -> None:
    pair = SimpleNamespace(name="pair")
    monkeypatch.setattr(rivals, "_rival_and_one_more", lambda *_: pair)
    shop: Any = None
    near = place("a", 100.0, trials=[trial("p", 95.0)], established=["p"])
    assert improve(FITTER, model("a", "b"), [near], {}, shop) is pair
    assert improve(FITTER, model("a", "b", "c"), [near], {}, shop) is None


@pytest.mark.parametrize("round_", [None, SimpleNamespace(accepted=None)], ids=["no candidates", "none accepted"])
def test_a_rival_to_which_no_effect_can_be_added_makes_no_pair(round_: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rivals, "next_effect", lambda *_, **__: round_)
    shop: Any = None
    near = place("a", 100.0, trials=[trial("p", 95.0)], established=["p"])
    assert improve(FITTER, model("a", "b"), [near], {}, shop) is None


@pytest.mark.parametrize(
    ("gain", "predicts", "counted"),
    [(95.0, False, 95.0), (115.0, False, 100.0), (115.0, True, 115.0), (5.0, True, None)],
)
def test_a_rival_is_as_far_ahead_as_halves_say(
    gain: float, predicts: bool, counted: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`counted`: the evidence with which it is established; the holder has 100."""
    changed = rivals.replace
    monkeypatch.setattr(rivals, "replace", lambda of, **to: changed(of, **to) if isinstance(of, Trial) else of)
    monkeypatch.setattr(rivals, "refitted_without", lambda *_: model())
    monkeypatch.setattr(Trial, "of", lambda effect, fitted, others: trial(effect, 100.0, "b"))
    monkeypatch.setattr(rivals, "predicts_better", lambda *_: predicts)
    fitter = repeated()
    candidates = [screened("holder", 90.0), *(screened(name, 50.0) for name in "pqrs"), screened("weak", 2.0)]
    shop: Any = Shop(candidates, {"p": gain})
    (found,) = contest_each_place(fitter, model("holder"), {}, shop)
    assert shop.refitted == ["p", "q", "r"]  # three, without the holder
    assert found.others.added == ()
    assert ("p" in found.round.established) == (counted is not None)
    assert counted in (None, next(t.evidence_gain for t in found.round.trials if t.effect == "p"))
    assert found.round.accepted is found.holder


def test_a_model_whose_derivatives_explode_names_no_rival(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rivals, "replace", lambda base, **_: base)
    monkeypatch.setattr(rivals, "refitted_without", lambda *_: model(exploded=True))
    monkeypatch.setattr(Trial, "of", lambda effect, fitted, others: trial(effect, 100.0))
    shop: Any = Shop([screened("p", 50.0)], {"p": 95.0})
    (found,) = contest_each_place(repeated(), model("holder"), {}, shop)
    assert shop.refitted == []
    assert found.round.accepted is found.holder


def test_where_derivatives_explode_without_an_effect_its_stored_contest_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A bristle without dry friction: the evidence of such a model says nothing of the friction."""
    away = place("a", -1e9)
    away.others.exploded = True
    monkeypatch.setattr(rivals, "_contest", lambda *_: away)
    first = place("a", 50.0)
    shop: Any = None
    assert contest_each_place(FITTER, model("a", "b"), {first.key: first}, shop)[0] is first


def test_a_model_that_fails_without_a_stored_contest_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> None:
        raise NumericalError("no")

    monkeypatch.setattr(rivals, "_contest", fails)
    shop: Any = None
    with pytest.raises(NumericalError, match="no"):
        contest_each_place(FITTER, model("a"), {}, shop)


def test_a_stored_contest_is_not_held_again_and_stands_in_where_a_model_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> None:
        raise NumericalError("no")

    monkeypatch.setattr(rivals, "_contest", fails)
    first, second, same = place("a", 50.0), place("a", 60.0, "c"), place("b", 70.0, "a")
    stored = {p.key: p for p in (first, second, same)}
    shop: Any = None
    assert contest_each_place(FITTER, model("a", "b"), stored, shop) == [second, same]


class Script:
    """A search whose rounds accept the effects of `gains` in turn, and whose sets may be improved on."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, effects: Sequence[str], improved: Sequence[Any] = ()) -> None:
        self.effects, self.improved, self.rounds, self.places = list(effects), list(improved), 0, 0
        monkeypatch.setattr(select, "next_effect", self.next_effect)
        monkeypatch.setattr(select, "contest_each_place", self.contest)
        monkeypatch.setattr(select, "improve", lambda *_: self.improved.pop(0) if self.improved else None)
        monkeypatch.setattr(select, "renewed", lambda fitter, fitted, pool: (fitter, fitted))
        monkeypatch.setattr(
            select, "_models_before", lambda _, m: [model(*m.added[:k]) for k in range(1, len(m.added))]
        )

    def next_effect(self, fitter: Any, base: Any, *, largest_gain: float, shop: Any, before: Any = None) -> Any:
        self.rounds += 1
        if len(base.added) > 0 and not self.places:  # the contest that the last effect won is remembered
            assert before.accepted.effect == base.added[-1]
        won = trial(self.effects.pop(0), 50.0, *base.added) if self.effects else None
        return SimpleNamespace(accepted=won, base=base.added)

    def contest(self, fitter: Any, base: Any, places: Any, shop: Any) -> list[Place]:
        self.places += 1
        return [place(name, 50.0, *(set(base.added) - {name})) for name in base.added]

    def run(self) -> Any:
        shop: Any = SimpleNamespace(pool=None)
        return select_effects(FITTER, model(), shop)


def test_effects_are_added_until_none_is_accepted(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Script(monkeypatch, ["a", "b"]).run()
    assert [m.added for m in found.path] == [(), ("a",), ("a", "b")]
    assert found.selected == ("a", "b")
    assert len(found.rounds) == 3  # a contest for each place, and the one that nothing won


def test_three_effects_are_the_most(monkeypatch: pytest.MonkeyPatch) -> None:
    script = Script(monkeypatch, ["a", "b", "c", "d"])
    found = script.run()
    assert (found.selected, script.rounds, len(found.rounds)) == (("a", "b", "c"), 3, 3)


def test_one_effect_is_not_improved_on(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Script(monkeypatch, ["a"], [SimpleNamespace(model=model("b"), won=None)]).run().selected == ("a",)
    assert Script(monkeypatch, []).run().rounds[0].accepted is None


def test_a_better_set_replaces_the_first_and_may_grow(monkeypatch: pytest.MonkeyPatch) -> None:
    better = SimpleNamespace(model=model("c", "b"), won=place("c", 60.0, "b"))
    script = Script(monkeypatch, ["a", "b"], [better])
    found = script.run()
    assert [m.added for m in found.path] == [(), ("c",), ("c", "b")]
    assert script.rounds == 4


def test_sets_are_improved_on_three_times_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    names = ["cd", "ef", "gh", "ij", "kl"]
    sets = [SimpleNamespace(model=model(*name), won=None) for name in names]
    script = Script(monkeypatch, ["a", "b"], sets)
    assert script.run().selected == ("g", "h")
    assert len(script.improved) == 2


def leading(effect: str, *, left: float, left_out: float = 2.0) -> Trial:
    """An effect of little evidence that leaves this mean square of 10."""
    found = trial(effect, 9.0, left_out=left_out)
    found.fitted.mean_square = left  # type: ignore[misc]
    return found


@pytest.mark.parametrize(
    ("trials", "explains", "repeated", "selected"),
    [
        ([leading("a", left=3.0)], True, False, ("a", "b")),
        ([leading("c", left=8.0), leading("a", left=3.0)], True, False, ("a", "b")),  # who leaves least is tried first
        ([leading("c", left=2.0), leading("d", left=2.01), leading("a", left=3.0)], True, False, ("a", "b")),
        ([leading("c", left=1.0), leading("d", left=2.0), leading("a", left=3.0)], True, False, ()),  # two at the most
        ([leading("a", left=3.0, left_out=-1.0)], True, False, ()),  # left-out blocks speak against it
        ([leading("a", left=9.0)], True, False, ()),  # it explains little
        ([leading("a", left=3.0)], False, False, ()),  # the two explain too little
        ([leading("a", left=3.0)], True, True, ()),  # repeats tell the noise: what is not established is not there
    ],
)
def test_two_effects_are_established_together_where_neither_is_alone(
    trials: Sequence[Trial], explains: bool, repeated: bool, selected: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    nothing = SimpleNamespace(accepted=None, trials=(), base=())
    rounds = {(): SimpleNamespace(accepted=None, trials=trials, base=())}
    rounds["a",] = SimpleNamespace(accepted=trial("b", 50.0, "a"), base=("a",))
    Script(monkeypatch, [])
    monkeypatch.setattr(select, "next_effect", lambda fitter, base, **_: rounds.get(base.added, nothing))
    monkeypatch.setattr(select, "explains_enough", lambda *_: explains)
    monkeypatch.setattr(Trial, "of", lambda effect, fitted, base: trial(effect, 60.0))
    fitter: Any = SimpleNamespace(floor=SimpleNamespace(repeated=repeated))
    shop: Any = SimpleNamespace(pool=None)
    found = select_effects(fitter, model(), shop)
    assert found.selected == selected
    assert len(found.rounds) == (3 if selected else 1)

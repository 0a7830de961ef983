"""The list of candidates in the report: which trial speaks for an effect, and in which order they stand."""

from types import SimpleNamespace
from typing import Any

import pytest

from tendonlab.diagnosis.answer import findings as answer
from tendonlab.diagnosis.answer.findings import _numbers, findings
from tendonlab.diagnosis.search.trial import Trial
from tendonlab.errors import NumericalError


def trial(effect: str, gain: float, *others: str) -> Trial:
    fitted: Any = SimpleNamespace(added=(*others, effect))
    return Trial(effect, fitted, gain, 0.5 * gain, 0.0)


def screened(effect: str, gain: float) -> Any:
    return SimpleNamespace(effect=effect, gain=gain, visibility=7.0)


def contest(trials: list[Trial], accepted: Trial | None, *seen: Any, **probability: float) -> Any:
    return SimpleNamespace(trials=trials, accepted=accepted, screened=seen, probability=probability)


@pytest.fixture
def listed(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(answer, "_numbers", lambda *_: {})

    def of(rounds: list[Any], probability: dict[str, float], selected: tuple[str, ...] = ()) -> Any:
        nothing: Any = None
        search: Any = SimpleNamespace(rounds=rounds, selected=selected, refuted=(), fitter=nothing)
        return findings(search, probability, nothing, nothing, 0)

    return of


def test_candidates_are_listed_by_probability_and_then_by_what_they_gain(listed: Any) -> None:
    trials = [trial("joint:a", 90.0), trial("joint:b", 80.0), trial("motor:c", 50.0)]
    seen = [screened("cable:d", 60.0), screened("cable:e", 70.0), screened("joint:a", 1.0)]
    rows = listed([contest(trials, trials[0], *seen)], {"joint:b": 0.6, "joint:a": 0.3})
    assert [(r.element, r.effect, r.probability) for r in rows] == [
        ("joint", "b", 0.6), ("joint", "a", 0.3), ("cable", "e", 0.0), ("cable", "d", 0.0), ("motor", "c", 0.0),
    ]  # fmt: skip
    assert rows[2].extra == {"screened_gain": 70.0, "visibility": 7.0}
    assert (rows[1].extra["screened_gain"], rows[1].extra["evidence_gain"]) == (1.0, 90.0)


def test_the_round_where_an_effect_is_most_probable_speaks_for_it(listed: Any) -> None:
    """Beside its twin it explains nothing; in the place of its twin it explains as much."""
    beside, instead = trial("a", -50.0, "twin"), trial("a", 90.0, "other")
    (row,) = listed([contest([beside], None, a=0.0), contest([instead], None, a=0.4)], {"a": 0.4})
    assert (row.extra["evidence_gain"], row.extra["beside"]) == (90.0, ["other"])


def test_of_twins_the_selected_one_stands_first(listed: Any) -> None:
    trials = [trial("load:offset", 90.0), trial("actuation:offset", 89.0)]
    even = {"load:offset": 0.4 + 1e-12, "actuation:offset": 0.4}
    first, second = listed([contest(trials, trials[1])], even, ("actuation:offset",))
    assert (first.name, second.name) == ("actuation:offset", "load:offset")


def test_the_round_that_accepted_an_effect_speaks_for_it_else_the_first(listed: Any) -> None:
    """Its companions in that round are named; the first screen counts."""
    first = contest([trial("a", 10.0, "p"), trial("b", 20.0, "p")], None, screened("a", 1.0))
    won = trial("b", 40.0, "p", "q")
    second = contest([trial("a", 30.0, "q"), won], won, screened("a", 2.0))
    a, b = sorted(listed([first, second], {}), key=lambda row: row.effect)
    assert (a.extra["evidence_gain"], a.extra["beside"], a.extra["screened_gain"]) == (10.0, ["p"], 1.0)
    assert (b.extra["evidence_gain"], b.extra["left_out_gain"], b.extra["beside"]) == (40.0, 20.0, ["p", "q"])


def fitted_to(level: float) -> Any:
    """A model whose effect `joint:a` has this level."""
    system = SimpleNamespace(
        info=SimpleNamespace(
            effect=lambda _: SimpleNamespace(parameters=("joint_level", "joint_shape")),
            parameter=lambda name: SimpleNamespace(own=name.removeprefix("joint_"), effect="a"),
        ),
        unit=lambda _: "N*m",
    )
    value = (level, (level - 0.1, level + 0.2))
    free = [SimpleNamespace(name="joint_level")]
    return SimpleNamespace(added=("joint:a",), system=system, free=free, value=lambda _: value)


def test_a_candidate_that_cannot_replay_what_was_held_out_has_parameters_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of an effect that was selected are of the last fit, beside all that was selected."""

    def fails(*_: Any) -> None:
        raise NumericalError("no")

    monkeypatch.setattr(answer.heldout, "models", fails)
    judged: Any = SimpleNamespace(case=None, experiments=())
    own = Trial("joint:a", fitted_to(0.3), 9.0, 9.0, 0.0)
    for selected, level in (((), 0.3), (("joint:a", "joint:b"), 0.4)):
        search: Any = SimpleNamespace(
            fitter=SimpleNamespace(case=None), selected=selected, refuted=(), final=fitted_to(0.4)
        )
        found = _numbers(search, own, judged, judged, 0)
        told = {"value": level, "ci95": [level - 0.1, level + 0.2], "unit": "N*m"}
        assert found == {"parameters": {"level": told}}


def test_an_effect_that_is_the_whole_answer_shrinks_the_gap_as_far(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its trial was fitted before the answer's last fit: two numbers for one effect would contradict each other."""
    with_effect: Any = object()
    of: Any = SimpleNamespace(case=None, experiments=(), stages={"with_effect": with_effect})
    monkeypatch.setattr(answer.heldout, "models", lambda *_: None)
    monkeypatch.setattr(answer.heldout, "replay", lambda *_: "alone")
    pair = trial("b", 9.0, "a")

    def replayed(selected: tuple[str, ...], refuted: tuple[str, ...] = ()) -> Any:
        search: Any = SimpleNamespace(selected=selected, refuted=refuted)
        return answer._replayed(of, pair, search)

    assert replayed(("b", "a")) is replayed(("b",), ("a",)) is with_effect
    assert replayed(("b",)) == replayed(("a",), ("b",)) == "alone"

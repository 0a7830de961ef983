"""Candidates that tuning hides are refitted as well: those that believed values show, and those that gained before."""

from types import SimpleNamespace
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.diagnosis.search import contest
from tendonlab.diagnosis.search.screen import Screened
from tendonlab.diagnosis.search.trial import DETECT, Trial
from tendonlab.errors import NumericalError, ParameterError


@pytest.mark.parametrize(
    ("chosen", "there", "expected"),
    [
        ("abcdefgh", "xaybz", "abcdefxy"),  # the best four there, of which two are new, take the last places
        ("abcdefgh", "abcde", "abcdefgh"),
        ("abcd", "wxyz", "abcdwxyz"),  # four stay
        ("", "w", "w"),
    ],
)
def test_candidates_that_tuning_hides_are_refitted_as_well(
    chosen: str, there: str, expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def screened(names: str) -> Any:
        return [Screened(name, 100.0 - place, ({},), 1.0) for place, name in enumerate(names)]

    monkeypatch.setattr(contest, "at_believed_values", lambda fitter, base: (fitter, base))
    shop: Any = SimpleNamespace(screen_all=lambda *_: [*screened(there), Screened("dim", 0.1, ({},), 1.0)])
    nothing: Any = None
    found = contest._with_hidden(nothing, nothing, screened(chosen), DETECT, shop)
    assert "".join(s.effect for s in found) == expected


def test_candidates_that_gained_beside_the_last_winner_are_refitted_from_there() -> None:
    """In other elements than its own, the best two, which no screen chose."""
    info = tl.system_info("two_inertia")
    system = SimpleNamespace(info=info)
    effects = {
        "joint:coulomb": 500.0, "joint:stribeck": 400.0, "sensor.joint_angle:bias": 300.0, "load:offset": 200.0,
        "motor:viscous": 100.0, "motor:coulomb": 50.0, "actuation:gain_error": 5.0,
    }  # fmt: skip
    values = {p.name: 0.1 * (k + 1) for k, p in enumerate(info.parameters)}
    fitted = SimpleNamespace(system=SimpleNamespace(parameters=values))
    before: Any = SimpleNamespace(trials=[Trial(name, fitted, gain, gain, 0.0) for name, gain in effects.items()])  # type: ignore[arg-type]
    screened = [Screened(name, 1.0, ({},), 1.0) for name in effects if name != "joint:coulomb"]
    base: Any = SimpleNamespace(added=("joint:coulomb",), system=system)
    chosen = [s for s in screened if s.effect == "load:offset"]
    found = contest._remembered(base, screened, chosen, before)
    assert [s.effect for s in found] == ["sensor.joint_angle:bias", "motor:viscous"]
    (start,) = found[1].starts
    assert start == {p: values[p] for p in info.effect("motor:viscous").parameters}
    few = [s for s in screened if s.effect == "actuation:gain_error"]
    assert contest._remembered(base, few, [], before) == []  # gained too little


@pytest.mark.parametrize(
    ("here", "there", "behind", "poor"),
    [
        ((500.0, 49.0), (90.0, 8.9), [False, True], [False, True]),
        ((500.0, 51.0), (90.0, 8.9), [False, False], [False, True]),  # a tenth of the most promised at tuned values
        ((500.0, 49.0), (90.0, 9.1), [False, False], [False, False]),  # or at believed ones
        ((500.0, 49.0), (90.0, None), [False, False], [False, False]),  # nobody knows what it would do there
    ],
)
def test_far_behind_is_a_candidate_that_promises_little_at_tuned_and_at_believed_values(
    here: tuple[float, ...], there: tuple[float | None, ...], behind: list[bool], poor: list[bool]
) -> None:
    chosen = [Screened(name, gain, ({},), 1.0) for name, gain in zip("ab", here, strict=True)]
    believed = [
        Screened(name, gain or 0.0, ({},), 1.0, "" if gain is not None else "stopped")
        for name, gain in zip("ab", there, strict=True)
    ]
    found = contest._behind(chosen, believed)
    assert [s.far_behind for s in found] == behind
    assert [s.poor_when_believed for s in found] == poor


@pytest.mark.parametrize("error", [NumericalError, ParameterError])
def test_where_believed_values_cannot_be_simulated_the_first_screen_decides(
    error: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: Any) -> Any:
        raise error("no")

    monkeypatch.setattr(contest, "at_believed_values", fails)
    nothing: Any = None
    assert contest._with_hidden(nothing, nothing, [], DETECT, nothing) == []

"""Of two effects the plainer one where experiments disagree; and how much a further effect must remove."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.search.contest import probabilities
from tendonlab.diagnosis.search.trial import DETECT, Trial, is_no_shape, plainest_first, removes_little


def test_no_effect_counts_more_than_the_one_it_gave_way_to() -> None:
    found = probabilities([contestant("plain", 40.0, 1, []), contestant("b", 60.0, 2, [])], {"plain", "b"}, DETECT, 4.0)
    assert found["plain"] == pytest.approx(found["b"])


def contestant(effect: str, gain: float, num: int, scores: list[float]) -> Any:
    """A trial of an effect with `num` parameters, whose left-out scores are these, one of each experiment."""
    info = SimpleNamespace(effect=lambda _: SimpleNamespace(parameters=num * ("p",)))
    fitted: Any = SimpleNamespace(
        system=SimpleNamespace(info=info), left_out=np.array(scores), by_experiment=lambda gains: gains
    )
    return Trial(effect, fitted, gain, gain, 0.0)


@pytest.mark.parametrize(
    ("first", "other", "leads"),
    [
        ((2, [4.2, -3.2, -9.1, 46.7, 2.4, -1.8, -2.2]), 1, "other"),  # one run alone speaks for it: an offset's twin
        ((2, [4.2, 3.2, 9.1, 46.7, 2.4, 1.8, 2.2]), 1, "first"),  # every run does
        ((2, [4.2, -0.1, 9.1, 46.7, 2.4, 1.8, 2.2]), 1, "first"),  # what one run loses is little
        ((1, [4.2, -3.2, -9.1, 46.7, 2.4, -1.8, -2.2]), 1, "first"),  # no plainer
        ((2, [37.0]), 1, "first"),  # one run alone tells of no doubt
    ],
)
def test_what_one_run_alone_shows_gives_way_to_a_plainer_effect(
    first: tuple[int, list[float]], other: int, leads: str
) -> None:
    num, ahead = first
    trials = [contestant("first", 131.0, num, ahead), contestant("other", 100.0, other, [0.0] * len(ahead))]
    ordered = plainest_first(trials, {"first", "other"})
    assert ordered[0].effect == leads
    assert {t.effect for t in ordered} == {"first", "other"}
    assert plainest_first(trials, {"first"})[0].effect == "first"


@pytest.mark.parametrize(("base", "left", "counts"), [(1.25, 1.24, True), (3.0, 2.9, False)])
def test_near_the_floor_a_further_effect_may_remove_little(base: float, left: float, counts: bool) -> None:
    before: Any = SimpleNamespace(mean_square=base, added=("first",))
    found = Trial("a", SimpleNamespace(mean_square=left), 900.0, 900.0, 0.0)  # type: ignore[arg-type]
    assert removes_little(before, found)
    assert is_no_shape(before, [found], 10_000.0) is counts

"""Whether friction follows the session: warming is found, the order of runs that differ by chance tells nothing."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.drift import LEAST, MOST_ORDERS, RARE, over_session, trends

STARTS = np.array([0.0, 55.0, 99.0, 229.0, 255.0, 343.0, 388.0])


def case(starts: Any = STARTS, elements: tuple[str, ...] = ("joint",)) -> Any:
    parameters = [SimpleNamespace(element=element) for element in elements]
    return SimpleNamespace(
        train=range(len(starts)),
        experiments=[SimpleNamespace(start=start) for start in starts],
        scatter=tuple(((k,), 0.02) for k in range(len(elements))),
        system=SimpleNamespace(info=SimpleNamespace(parameters=parameters)),
    )


def model(*factors: np.ndarray) -> Any:
    """A fit that needs these logarithms of friction factors, behind an initial state of each run."""
    return SimpleNamespace(initial=[(7.0, *own) for own in np.transpose(factors)])


def warming(share: float, time: float) -> np.ndarray:
    return np.log1p(share * np.exp(-STARTS / time))


@pytest.mark.parametrize(("share", "time"), [(0.1, 60.0), (0.1, 200.0), (-0.2, 1000.0)])
def test_friction_that_settles_is_found(share: float, time: float) -> None:
    exact = warming(share, time)
    found = over_session(case(), model(exact + 0.001 * np.random.default_rng(1).standard_normal(len(exact))))
    assert found is not None
    assert found.tells
    assert found.element == "joint"
    assert found.change == pytest.approx(np.expm1(exact[-1] - exact[0]), abs=0.015)


def test_chance_is_the_share_of_the_orders_that_follow_a_trend_as_well() -> None:
    """Of an exact straight line nothing but the order itself; where the runs start evenly, the reverse as well."""
    assert trends(np.arange(7.0), np.arange(7.0)[None])[0] == pytest.approx(2 / MOST_ORDERS)
    chance, change = trends(STARTS, -3e-4 * STARTS[None])
    assert chance == pytest.approx(1 / MOST_ORDERS)
    assert change == pytest.approx(-3e-4 * np.ptp(STARTS))


@pytest.mark.parametrize("num", [5, 7, 12])
@pytest.mark.parametrize("elements", [1, 3])
def test_chance_is_honest(num: int, elements: int) -> None:
    """Of runs that differ by chance alone, a share p has a chance of at most p, of however many elements the least
    likely trend is taken."""
    random = np.random.default_rng(num)
    starts = np.sort(random.uniform(0.0, 600.0, num))
    chances = np.array([np.min(trends(starts, random.standard_normal((elements, num)))[0]) for _ in range(150)])
    for p in (0.05, 0.2, 0.5):
        assert np.mean(chances <= p) <= p + 3.0 * np.sqrt(p * (1 - p) / len(chances))
    assert np.mean(chances) == pytest.approx(0.5, abs=0.08)


def test_the_chance_counts_every_element_that_was_looked_at() -> None:
    """Friction that differs by itself counts as a second look; friction that changes alike is the same look."""
    random = np.random.default_rng(0)
    noisy = warming(0.1, 60.0) + random.normal(0.0, 0.004, 7)
    one = trends(STARTS, noisy[None])[0][0]
    two = [trends(STARTS, np.array([random.permutation(noisy), noisy]))[0][1] for _ in range(100)]
    assert np.mean(two) == pytest.approx(2.0 * one, rel=0.15)
    assert trends(STARTS, np.array([0.5 * noisy, noisy]))[0] == pytest.approx([one, one])


def test_the_least_likely_trend_names_the_element() -> None:
    chance = np.random.default_rng(0).normal(0.0, 0.01, 7)
    found = over_session(case(elements=("motor", "joint")), model(chance, warming(0.1, 60.0)))
    assert found is not None
    assert found.element == "joint"


def test_a_trend_too_small_to_matter_tells_nothing() -> None:
    found = over_session(case(), model(warming(0.9 * LEAST, 100.0)))
    assert found is not None
    assert found.chance < RARE
    assert not found.tells


def test_nothing_is_found_without_starts_or_scatter() -> None:
    factors = warming(0.1, 60.0)
    assert over_session(case([None, *STARTS[1:]]), model(factors)) is None
    assert over_session(case(np.zeros(7)), model(factors)) is None
    assert over_session(case(), model(np.zeros(7))) is None
    assert over_session(case(elements=()), SimpleNamespace(initial=[()] * 7)) is None

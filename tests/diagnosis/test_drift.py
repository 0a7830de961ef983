"""Whether friction follows the session: warming is found, the order of runs that differ by chance tells nothing."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from diagnosis.conftest import measured_as
from tendonlab import _core
from tendonlab.diagnosis.drift import LEAST, MOST_ORDERS, RARE, held_out_factors, over_session, trends
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import Fitter

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


def test_held_out_experiments_count() -> None:
    """Four runs have too few orders to tell a trend; with those held out, which may come first, there are enough."""
    rig, factors = case(), warming(0.1, 200.0)
    rig.train, test = [3, 4, 5, 6], [0, 1, 2]
    few = over_session(rig, model(factors[3:]))
    found = over_session(rig, model(factors[3:]), {i: [factors[i]] for i in test})
    assert few is not None
    assert found is not None
    assert few.chance > RARE > found.chance
    assert found.change == pytest.approx(np.expm1(factors[-1] - factors[0]), abs=0.015)
    rig.experiments[0].start = None
    assert over_session(rig, model(factors[3:]), {i: [factors[i]] for i in test}) is None


def test_held_out_factors_are_those_of_the_friction_there(known: Any) -> None:
    case, fitted = known
    i = case.test[0]
    ready = tuple(measured_as(case, k, 0.07) if k == i else old for k, old in enumerate(case.prepared))
    fitter = Fitter(replace(case, prepared=ready), white(case.noise), _core.Cancel())
    assert held_out_factors(fitter, fitted)[i] == pytest.approx([0.07], abs=0.01)
    nothing_held_out = replace(fitter, case=case.training_on(range(len(case.experiments))))
    assert held_out_factors(nothing_held_out, fitted) == {}
    unstated = tuple(replace(e, start=None) if k == i else e for k, e in enumerate(case.experiments))
    assert held_out_factors(replace(fitter, case=replace(case, experiments=unstated)), fitted) == {}


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

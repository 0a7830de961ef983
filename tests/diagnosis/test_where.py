"""Where the gap lies and how far it shrinks, on residuals that are made for it."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.answer import heldout, where
from tendonlab.diagnosis.answer.heldout import Replayed

TIME = np.linspace(0.0, 8.0, 801)
BLOCK = np.minimum(np.arange(801) // 200, 3)  # of 2 s


class Whitened:
    """The whitening of white noise of sd 1 on one output."""

    def residual(self, outputs: np.ndarray) -> np.ndarray:
        return np.asarray(outputs[0])

    def cells(self) -> tuple[np.ndarray, np.ndarray]:
        return np.zeros(len(TIME), dtype=int), np.arange(len(TIME))


def replayed(*residuals: np.ndarray) -> Replayed:
    return Replayed((), (), tuple(np.atleast_2d(r) for r in residuals), tuple(np.atleast_2d(r) for r in residuals))


def case(num: int, *, outputs: tuple[str, ...] = ("angle",), **more: Any) -> Any:
    experiments = [SimpleNamespace(time=TIME)] * num
    return SimpleNamespace(experiments=experiments, outputs=outputs, measured=list(range(len(outputs))), **more)


def floor(*rms: float, shares: tuple[float, ...] | None = None) -> Any:
    return SimpleNamespace(rms=np.array(rms), shares=shares)


def test_the_gap_is_what_the_error_has_beyond_the_floor() -> None:
    """An error of √(1 + 9) floors in one output and of one floor in the other: the mean excess is 4.5."""
    assert heldout.gap(np.array([10.0 * 0.04, 9.0]), np.array([0.2, 3.0])) == pytest.approx(np.sqrt(4.5))
    assert heldout.gap(np.array([0.04, 1.0]), np.array([0.2, np.nan])) == 0.0
    assert heldout.gap(np.array([0.01]), np.array([0.2])) == 0.0


def test_shrinkage_is_one_minus_the_ratio_of_gaps() -> None:
    """Errors of √17 and √5 floors: gaps of 4 and 2. All blocks are alike, so that the interval has no width."""
    before, after = (replayed(np.full(801, np.sqrt(s))) for s in (17.0, 5.0))
    found = heldout.shrinkage(case(1), before, after, floor(1.0), [0], np.random.default_rng(0))
    assert found["value"] == pytest.approx(0.5)
    assert found["ci95"] == pytest.approx([0.5, 0.5])
    none = heldout.shrinkage(
        case(1), after.__class__((), (), (np.zeros((1, 801)),), ()), after, floor(1.0), [0], np.random.default_rng(0)
    )
    assert none == {"value": None, "ci95": None}


def test_the_interval_of_shrinkage_holds_what_blocks_differ_by() -> None:
    rng = np.random.default_rng(1)
    size = rng.uniform(2.0, 6.0, 4)[BLOCK]
    before, after = replayed(size), replayed(0.5 * size + rng.uniform(0.0, 1.0, 4)[BLOCK])
    found = heldout.shrinkage(case(1), before, after, floor(1.0), [0], np.random.default_rng(0))
    low, high = found["ci95"]  # type: ignore[misc]
    shares = [
        1.0 - heldout.gap(b, np.ones(1)) / heldout.gap(a, np.ones(1))
        for a, b in zip(
            heldout.mean_squares(case(1), before, [0])[0], heldout.mean_squares(case(1), after, [0])[0], strict=True
        )
    ]
    assert min(shares) <= low < found["value"] < high <= max(shares)  # type: ignore[operator]


def test_mean_squares_are_of_blocks_of_two_seconds() -> None:
    residual = np.array([np.array([1.0, 2.0, 3.0, 4.0])[BLOCK], np.full(801, np.nan)])
    (rows,) = heldout.mean_squares(case(1), replayed(residual), [0])
    np.testing.assert_allclose(rows[:, 0], [1.0, 4.0, 9.0, 16.0], rtol=0.02)  # an edge may move by a sample
    assert np.isnan(rows[:, 1]).all()
    assert heldout.rms(replayed(residual)) == pytest.approx([np.sqrt(7.5), np.nan], rel=2e-3, nan_ok=True)


def test_predictive_gain_is_half_the_squares_that_vanish_with_the_scatter_of_blocks() -> None:
    blocks = np.array([3.0, 2.0, 4.0, 1.0])[BLOCK]
    before, after = replayed(blocks), replayed(np.ones(801))
    found = heldout.predictive_gain(case(1), [Whitened()], floor(1.0), before, after, [0])  # type: ignore[list-item]
    gains = 0.5 * 200 * (np.array([9.0, 4.0, 16.0, 1.0]) - 1.0)
    assert found["mean"] == pytest.approx(gains.sum(), rel=1e-3)
    assert found["se"] == pytest.approx(np.std(gains, ddof=1) * 2.0, rel=0.05)
    fewer = heldout.predictive_gain(case(1), [Whitened()], floor(1.0, shares=(0.1,)), before, after, [0])  # type: ignore[list-item]
    assert fewer["mean"] == pytest.approx(0.1 * gains.sum(), rel=1e-3)


def test_the_share_of_a_signal_is_its_excess_over_its_own_floor() -> None:
    """Squares of 5 and 9 floors: excesses of 4 and 8."""
    residual = np.array([np.full(801, 0.1 * np.sqrt(5.0)), np.full(801, 6.0), np.full(801, np.nan)])
    of = case(1, outputs=("angle", "torque", "speed"))
    rows = where.signals(of, replayed(residual), floor(0.1, 2.0, np.nan))
    assert [r["signal"] for r in rows] == ["torque", "angle", "speed"]
    assert [r["share"] for r in rows] == pytest.approx([2 / 3, 1 / 3, 0.0])
    quiet = where.signals(of, replayed(0.1 * residual), floor(0.1, 2.0, np.nan))
    assert {r["share"] for r in quiet} == {0.0}


def test_excess_is_the_mean_over_measured_outputs_in_squares_of_their_floors() -> None:
    residual = np.array([[0.3, 0.1, np.nan, np.nan], [2.0, np.nan, 4.0, np.nan]])
    of = case(1, outputs=("angle", "torque"))
    found = where.excess(of, replayed(residual), floor(0.1, 2.0))
    np.testing.assert_allclose(found, [(9.0 + 1.0) / 2 - 1.0, 0.0, 3.0, 0.0], atol=1e-12)


def test_the_probability_of_an_element_is_that_of_the_sets_with_its_effects() -> None:
    info = SimpleNamespace(elements=[SimpleNamespace(name=n) for n in ("joint", "actuation", "sensor.angle")])
    of = SimpleNamespace(system=SimpleNamespace(info=info))
    chances = {"joint:stribeck": 0.3, "joint:ripple": 0.2, "actuation:offset": 0.1, "sensor.angle:bias": 0.9}
    sets: list[dict[str, Any]] = [
        {"effects": ["joint:stribeck", "sensor.angle:bias"], "probability": 0.3},
        {"effects": ["joint:ripple", "sensor.angle:bias"], "probability": 0.2},
        {"effects": ["sensor.angle:bias"], "probability": 0.4},
    ]
    rows = where.elements(chances, sets, of)  # type: ignore[arg-type]
    assert [(r["element"], pytest.approx(r["probability"])) for r in rows] == [
        ("sensor.angle", 0.9), ("joint", 0.5), ("actuation", 0.1),
    ]  # fmt: skip
    both = [{"effects": ["joint:a", "joint:b"], "probability": 0.7}, {"effects": ["joint:a"], "probability": 0.1}]
    together = where.elements({"joint:a": 0.8, "joint:b": 0.7}, both, of)  # type: ignore[arg-type]
    assert together[0] == {"element": "joint", "probability": pytest.approx(0.8)}


def test_an_error_that_sits_at_low_speed_is_a_regime_and_one_without_a_place_is_none() -> None:
    """The lowest eighth of the samples holds the error; of shifted errors hardly any does."""
    rng = np.random.default_rng(0)
    x = np.cumsum(rng.standard_normal(4000))
    e = np.where(x <= np.quantile(x, 0.125), 1.0, 1e-3)
    shifts = rng.integers(200, 3800, 400)
    found = where._regime("velocity", x, e, shifts)
    assert found["range"] == pytest.approx([x.min(), np.quantile(x, 0.125)])
    assert found["share"] == pytest.approx(500 / (500 + 3.5), abs=1e-3)
    assert found["p_value"] < 0.02
    even = where._regime("velocity", x, rng.uniform(0.9, 1.1, 4000), shifts)
    assert even["p_value"] > 0.05
    assert 1 / 401 <= even["p_value"] <= 1.0


@pytest.mark.parametrize("steady", [False, True])
def test_no_regime_is_one_of_the_order_of_steady_points(steady: bool) -> None:
    system = SimpleNamespace(info=SimpleNamespace(ports=[SimpleNamespace(name="contact")], steady=steady))
    of = replayed(1.0 + np.sin(5.0 * TIME))
    found = where.regimes(case(1, system=system), of, floor(1.0), port_records(2.0 + np.sin(3.0 * TIME)))
    assert ("time" in {row["coordinate"] for row in found}) is not steady
    assert "contact_load" in {row["coordinate"] for row in found}


def port_records(load: np.ndarray) -> Any:
    ports = {"velocity": np.sin(TIME), "position": np.cos(TIME), "load": load}
    return SimpleNamespace(coordinate=lambda port, quantity: ports[quantity], time=TIME)


@pytest.mark.parametrize(("load", "y"), [(2.0 + np.sin(3 * TIME), "joint load"), (np.full(801, 2.0), "joint position")])
def test_a_map_is_over_load_where_load_varies_and_holds_the_rms_of_each_cell(load: np.ndarray, y: str) -> None:
    port = SimpleNamespace(name="joint", element="joint", load="effort")
    info = SimpleNamespace(ports=[port], element=lambda name: SimpleNamespace(axis=None))
    of = case(1, system=SimpleNamespace(info=info, axis="rotary", kind="rigid_joint"))
    (found,) = where.maps(of, replayed(np.full(801, 0.3)), replayed(np.full(801, 0.2)), floor(0.1), port_records(load))
    assert (found.x, found.y) == ("joint velocity", y)
    assert found.x_unit == "rad/s"
    seen = found.refitted[np.isfinite(found.refitted)]
    np.testing.assert_allclose(seen, 3.0)
    np.testing.assert_allclose(found.with_effect[np.isfinite(found.refitted)], 2.0)
    assert 14 < len(seen) < 14 * 14
    low, high = np.quantile(np.sin(TIME), [0.005, 0.995])
    assert found.x_edges == pytest.approx(np.linspace(low, high, 15))


def test_cells_are_empty_where_nothing_was() -> None:
    edges = np.array([0.0, 1.0, 2.0])
    cells = where._cells(np.array([0.5, 0.5, 1.5]), np.array([0.5, 0.5, 1.5]), np.array([3.0, 4.0, 7.0]), edges, edges)
    np.testing.assert_allclose(cells, [[np.sqrt(12.5), np.nan], [np.nan, 7.0]])


def test_the_edges_of_a_quantity_that_hardly_varies_are_its_extremes() -> None:
    x = np.zeros(1000)
    x[0] = 5.0
    assert (where._edges(x)[0], where._edges(x)[-1]) == (0.0, 5.0)

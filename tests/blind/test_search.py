"""The search for an amplitude of stated strength, and the algebra of gaps, steps and separations, on stated numbers."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.blind import strength
from tendonlab.blind.strength import ORDER, PRIOR_SD, _Search, _Tuner, _whiten, separations
from tendonlab.blind.systems import TWO_INERTIA


@pytest.fixture
def rigs(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Rigs with these targets whose amplitude may be at most 1; one more lacks nothing."""
    monkeypatch.setattr(strength, "largest_amplitude", lambda rig: rig.largest)

    def made(*targets: float, largest: float = 1.0) -> list[Any]:
        usual = {"largest": largest, "met_within": 0.18}
        effects = [SimpleNamespace(kind="effect", target=target, **usual) for target in targets]
        return [*effects, SimpleNamespace(kind="none", target=1.0, **usual)]

    return made


def test_a_search_begins_at_a_third_or_at_the_limit(rigs: Any) -> None:
    assert _Search(rigs(2.0)).amplitude.tolist() == [0.3, 0.0]
    assert _Search(rigs(2.0, largest=0.1)).amplitude.tolist() == [0.1, 0.0]


@pytest.mark.parametrize(("power", "turns"), [(1.0, 1), (2.0, 2), (0.7, 2)])
def test_an_amplitude_is_found_by_the_slope_of_the_last_two_gaps(rigs: Any, power: float, turns: int) -> None:
    """A gap of 10 a^power is 2 at one amplitude. The first move takes the gap as proportional."""
    search = _Search(rigs(2.0))
    rows = np.array([0])
    for _ in range(turns):
        search.learn(10.0 * search.amplitude[rows] ** power, rows)
        search.move()
    assert search.amplitude[0] == pytest.approx(0.2 ** (1.0 / power), rel=0.02)
    assert search.amplitude[1] == 0.0
    search.learn(10.0 * search.amplitude[rows] ** power, rows)
    assert search.is_done().all()
    before = search.amplitude.copy()
    search.move()
    assert search.amplitude.tolist() == before.tolist()


def test_one_move_is_at_most_sixfold(rigs: Any) -> None:
    search = _Search(rigs(50.0, largest=100.0))
    search.learn(np.array([0.01]), np.array([0]))
    search.move()
    assert search.amplitude[0] == pytest.approx(0.3 * np.exp(1.8))
    search.learn(np.array([1e6]), np.array([0]))
    search.last = None
    search.move()
    assert search.amplitude[0] == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("gap", "amplitude", "done"),
    [
        (2.0 * np.exp(0.11), 0.3, True),
        (2.0 * np.exp(-0.11), 0.3, True),
        (2.0 * np.exp(0.13), 0.3, False),
        (1.0, 1.0, True),  # at the limit, and yet too weak
        (3.0, 1.0, False),
        (3.0, 2e-3, True),  # as small as it may be, and yet too strong
        (1.0, 2e-3, False),
    ],
)
def test_a_search_ends_near_the_target_or_where_it_cannot_go_on(
    rigs: Any, gap: float, amplitude: float, done: bool
) -> None:
    search = _Search(rigs(2.0))
    search.amplitude[0] = amplitude
    search.learn(np.array([gap]), np.array([0]))
    assert search.is_done().tolist() == [done, True]


def test_a_strength_is_met_within_a_fifth(rigs: Any) -> None:
    search = _Search(rigs(2.0, 2.0, 2.0))
    search.learn(np.array([2.0 * np.exp(0.17), 2.0 * np.exp(-0.19), 2.0]), np.arange(3))
    search.amplitude[2] = 1.0
    found = [search.strength(i, before=4.0, floor=np.ones(3), separation={"x": 1.0}) for i in range(4)]
    assert [s.met for s in found] == [True, False, True, True]
    assert [s.limited for s in found] == [False, False, True, False]
    assert [s.gap_noise for s in found] == pytest.approx([2.0 * np.exp(0.17), 2.0 * np.exp(-0.19), 2.0, 0.0])
    assert (found[0].amplitude, found[0].nominal_gap_noise, found[0].separation) == (0.3, 4.0, {"x": 1.0})


def test_a_rig_may_allow_more(rigs: Any) -> None:
    made = rigs(2.0, 2.0)
    made[1].met_within = 0.5
    search = _Search(made)
    search.learn(np.array([3.0, 3.0]), np.arange(2))
    found = [search.strength(i, before=4.0, floor=np.ones(3), separation={}) for i in range(2)]
    assert [s.met for s in found] == [False, True]  # log 1.5 = 0.41


def test_rigs_are_measured_until_all_are_done_and_six_times_at_most(rigs: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first rig is met at once, the second never: it alone is measured once more, and once more."""
    measured = []

    class Tuner:
        floor = np.ones((2, 3))

        def __init__(self, some: Any) -> None:
            self.names = list(range(len(some)))

        def start(self) -> None:
            pass

        def linear(self, amplitude: np.ndarray) -> np.ndarray:
            return np.full(len(amplitude), 2.0)

        def exact(self, amplitude: np.ndarray) -> np.ndarray:
            measured.append(list(self.names))
            return np.array([2.0 if name == 0 else 2.4 for name in self.names])

        def nominal_gap(self) -> np.ndarray:
            return np.full(len(self.names), 20.0 + len(measured))

        def subset(self, rows: np.ndarray) -> Any:
            part = Tuner([])
            part.names = [self.names[row] for row in rows]
            return part

    monkeypatch.setattr(strength, "_Tuner", Tuner)
    monkeypatch.setattr(strength, "separations", lambda tuner: [{"rival": float(name)} for name in tuner.names])
    first, second = strength._tune_effects(rigs(2.0, 2.0)[:2])
    assert measured == [[0, 1], [1], [1], [1], [1], [1]]
    assert (first.gap_noise, first.met, first.nominal_gap_noise) == (2.0, True, 21.0)
    assert (second.gap_noise, second.met, second.nominal_gap_noise) == (2.4, False, 26.0)
    assert (first.separation, second.separation) == ({"rival": 0.0}, {"rival": 1.0})


def tuner(width: int = 2) -> Any:
    """One rig with two runs of 300 samples, the second of its three outputs not measured."""
    made = object.__new__(_Tuner)
    rng = np.random.default_rng(4)
    made.rigs = [SimpleNamespace(experiments=[None, None], effect="a")]  # type: ignore[list-item]
    made.used, made.floor = np.array([[True, False, True]]), np.array([[0.5, 1.0, 2.0]])
    made.width, made.free = width, [["x", "y"]]
    made.base, made.slopes = rng.normal(size=(1, 3, 600)), rng.normal(size=(1, width, 3, 600))
    return made


def test_a_gap_is_pooled_over_measured_outputs_in_their_floors() -> None:
    residual = np.array([1.0, 77.0, 6.0])[None, :, None] * np.tile([1.0, -1.0], 50)
    assert tuner()._gap(residual) == pytest.approx([np.sqrt(0.5 * (4.0 + 9.0))])


def test_a_step_is_that_of_weighed_least_squares_with_a_prior_about_the_truth() -> None:
    of = tuner()
    logs, residual = np.array([[0.1, -0.2]]), np.random.default_rng(5).normal(size=(1, 3, 600))
    weight = np.repeat(np.array([2.0, 0.0, 0.5]), 600)
    columns = of.slopes[0].reshape(2, -1).T * weight[:, None]
    design = np.vstack([columns, np.eye(2) / PRIOR_SD])
    target = np.concatenate([residual[0].ravel() * weight, -logs[0] / PRIOR_SD])
    assert of._step(residual, of.slopes, logs)[0] == pytest.approx(np.linalg.lstsq(design, target, rcond=None)[0])
    assert np.abs(of._step(1e6 * residual, of.slopes, logs)).max() == 1.0  # no parameter moves further


def test_a_rival_separates_by_what_it_leaves_in_whitened_readings() -> None:
    """In white noise of the floor: half the square of what neither the parameters nor the rival explain."""
    of, rng = tuner(), np.random.default_rng(6)
    noise = rng.normal(size=(3, 600)) * np.array([0.5, 1.0, 2.0])[:, None]
    column, rest = rng.normal(size=(3, 600)), rng.normal(size=(3, 600))
    explained = of.base[0] + 0.1 * of.slopes[0, 0] + 3.0 * column
    assert of.separation(0, column, truth=explained, noise=noise) == pytest.approx(0.5 * (0.1 / PRIOR_SD) ** 2, rel=0.1)
    found = of.separation(0, column, truth=explained + rest, noise=noise)
    expected = 0.5 * float(np.sum((rest[0] / 0.5) ** 2) + np.sum((rest[2] / 2.0) ** 2))
    assert found == pytest.approx(expected, rel=0.1)  # a few rows begin each run, a few columns fit by chance


def test_each_rival_of_an_effect_is_tried() -> None:
    tried = []

    class Rivals:
        names = ("actuation:offset", "actuation:delay", "cable:slack")
        rigs = tuple(SimpleNamespace(effect=name, system=TWO_INERTIA) for name in names)
        truth = noise = np.zeros((3, 1))

        def rival(self, effects: list[str]) -> np.ndarray:
            tried.append(effects)
            return np.array([[len(name)] for name in effects], dtype=float)

        def separation(self, row: int, column: np.ndarray, *, truth: Any, noise: Any) -> float:
            return 100.0 * row + float(column[0])

    found = separations(Rivals())  # type: ignore[arg-type]
    assert tried == [["load:offset", "sensor.motor_angle:delay", ""], ["motor:asymmetry", "", ""]]
    assert found == [
        {"load:offset": 11.0, "motor:asymmetry": 15.0}, {"sensor.motor_angle:delay": 124.0}, {},
    ]  # fmt: skip


def test_whitening_takes_the_memory_out_of_noise() -> None:
    """Of each run by itself: readings lie side by side, sample by sample."""
    rng = np.random.default_rng(7)
    noise = rng.normal(scale=0.3, size=(4000, 2))
    for k in range(1, 4000):
        noise[k] += 0.9 * noise[k - 1]
    white = _whiten(noise.reshape(1, -1), noise.ravel(), 2).reshape(-1, 2)
    assert white.shape == (4000 - ORDER, 2)
    assert np.std(white) == pytest.approx(1.0, rel=0.02)
    for run in white.T:
        assert abs(np.corrcoef(run[1:], run[:-1])[0, 1]) < 0.05
    step = np.zeros((4000, 2))
    step[2000:, 0] = 1.0
    shaped = _whiten(step.reshape(1, -1), noise.ravel(), 2).reshape(-1, 2)
    assert shaped[2000 - ORDER, 0] == pytest.approx(1.0 / 0.3, rel=0.05)
    assert shaped[-1, 0] == pytest.approx(0.1 / 0.3, rel=0.3)
    assert np.abs(shaped[:, 1]).max() == 0.0

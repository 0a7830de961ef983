"""The motions of a blind session: what each shape is, how far and how fast it goes, and what the runs carry."""

import numpy as np
import pytest

from tendonlab.blind import excitation
from tendonlab.blind.excitation import POOR, RICH, session

TIME = np.arange(2001) * 0.002


class Middle:
    """Draws the middle of every range, and always the first choice."""

    def uniform(self, low: float, high: float, size: int | None = None) -> float | np.ndarray:
        middle = 0.5 * (low + high)
        return middle if size is None else np.full(size, middle)

    def choice(self, of: list[float]) -> float:
        return of[-1]

    def permutation(self, num: int) -> np.ndarray:
        return np.arange(num)

    def spawn(self, num: int) -> "list[Middle]":
        return [self] * num


def drawn(shape: excitation.Shape, size: float = 1.0) -> np.ndarray:
    return shape(TIME, Middle(), size=size)


@pytest.mark.parametrize("shape", list(dict.fromkeys(plan[0] for plan in RICH)), ids=lambda of: of.__name__)
def test_a_shape_grows_with_its_size(shape: excitation.Shape) -> None:
    assert drawn(shape, 2.0) == pytest.approx(2.0 * drawn(shape), abs=1e-12)


def test_slow_reversals_are_ramps_with_rests_that_turn_each_time() -> None:
    """Five ramps of 0.325 rad/s and 0.475 s, with 0.21 s of rest before each."""
    angle = drawn(excitation.slow_reversals)
    speed = np.gradient(angle, TIME)
    starts = 0.21 + 0.685 * np.arange(5)
    for start, sign in zip(starts, [1.0, -1.0, 1.0, -1.0, 1.0], strict=True):
        assert speed[round((start + 0.2) / 0.002)] == pytest.approx(0.325 * sign)
        assert speed[round((start - 0.1) / 0.002)] == 0.0
    assert angle[-1] == pytest.approx(0.325 * 0.475)


def test_sines_have_the_drawn_frequency_and_amplitude() -> None:
    assert drawn(excitation.sine) == pytest.approx(0.475 * np.sin(2 * np.pi * 0.8 * TIME))
    grown = drawn(excitation.micro_sine)
    assert grown == pytest.approx((0.004 + 0.12 * (TIME / 4.0) ** 2) * np.sin(2 * np.pi * 1.05 * TIME))
    many = drawn(excitation.multi_sine)  # five alike
    assert many == pytest.approx(0.325 * 5 * np.sin(2 * np.pi * 2.125 * TIME + 3.14) / (1 + 2.125**1.3))


def test_a_chirp_sweeps_from_slow_to_fast_and_shrinks_where_it_is_fast() -> None:
    """From 0.35 Hz to 4 Hz over the record; at 8 rad/s half the amplitude of rest."""
    angle = drawn(excitation.chirp)
    crossings = TIME[1:][np.diff(np.sign(angle)) != 0]
    phase = 2 * np.pi * (0.35 * crossings + 3.65 * crossings**2 / 8.0)
    assert np.sin(phase) == pytest.approx(np.zeros(len(phase)), abs=0.06)  # two samples apart
    assert len(crossings) == 1 + int(2 * (0.35 * 4.0 + 3.65 * 2.0))  # with that at the start
    assert np.abs(angle).max() < 0.375
    half = (8.0 / (2 * np.pi) - 0.35) * 4.0 / 3.65
    near = np.abs(TIME - half) < 0.5
    assert np.abs(angle[near]).max() == pytest.approx(0.5 * 0.375, rel=0.4)
    assert np.abs(angle[-150:]).max() == pytest.approx(0.375 / (1 + (2 * np.pi * 3.9 / 8.0) ** 1.5), rel=0.1)


def test_steps_are_smooth_moves_with_rests_between() -> None:
    """To 0.375 rad, in 0.225 s, every 0.65 s from 0.3 s on; all draws alike, the first move alone moves."""
    angle = drawn(excitation.steps)
    assert angle[TIME <= 0.3] == pytest.approx(0.0)
    assert angle[TIME >= 0.53] == pytest.approx(0.375)
    middle = np.interp(0.3 + 0.1125, TIME, angle)
    assert middle == pytest.approx(0.1875, abs=1e-6)
    quick = np.gradient(angle, TIME).max()
    assert quick == pytest.approx(0.375 * 1.875 / 0.225, rel=1e-3)  # of the quintic
    turning = excitation.steps(TIME, np.random.default_rng(0))
    assert len(np.unique(np.round(turning[np.abs(np.gradient(turning)) < 1e-12], 9))) >= 5


def test_a_staircase_climbs_and_comes_back() -> None:
    angle = drawn(excitation.staircase)
    levels = [0.0, 0.2, 0.45, 0.75, 0.4, 0.05]
    knots = np.linspace(0.2, 3.6, 6)
    assert np.interp(knots, TIME, angle) == pytest.approx(levels, abs=1e-9)
    assert np.interp(knots[1:] - 0.36, TIME, angle) == pytest.approx(levels[:-1], abs=1e-9)
    assert np.interp(knots[1:] - 0.175, TIME, angle) == pytest.approx(
        0.5 * (np.array(levels[1:]) + levels[:-1]), abs=1e-9
    )


@pytest.mark.parametrize(("kind", "plans"), [("rich", RICH), ("poor", POOR)])
def test_a_session_repeats_one_run_at_its_start_middle_and_end(kind: str, plans: tuple[object, ...]) -> None:
    runs = session(np.random.default_rng(4), excitation=kind, sample_time=0.002, num_samples=2001)
    assert len(runs) == len(plans) + 2 == excitation.NUM_EXPERIMENTS
    again = [k for k, run in enumerate(runs) if run.repeat == "A"]
    assert again == [0, 5, 9]
    assert all(np.array_equal(runs[k].reference, runs[0].reference) for k in again)
    assert all(run.split == "train" for run in runs if run.repeat)
    assert [run.split for run in runs].count("test") == 3
    assert [run.name for run in runs] == [f"run-{k:02d}" for k in range(1, 11)]
    starts = np.array([run.start for run in runs])
    assert starts[0] == 0.0
    assert np.all((np.diff(starts) > 4.0 + 14.9) & (np.diff(starts) < 4.0 + 60.1))


@pytest.mark.parametrize("kind", ["rich", "poor"])
def test_without_repeats_other_motions_take_their_places_and_all_else_is_alike(kind: str) -> None:
    options = {"excitation": kind, "sample_time": 0.002, "num_samples": 2001}
    with_repeats, without = (
        session(np.random.default_rng(4), has_repeats=repeats, **options)  # type: ignore[arg-type]
        for repeats in (True, False)
    )
    changed = [not np.array_equal(a.reference, b.reference) for a, b in zip(with_repeats, without, strict=True)]
    assert changed == [k in (5, 9) for k in range(10)]
    assert not np.array_equal(without[5].reference, without[9].reference)
    assert all(run.repeat is None for run in without)
    for name in ("name", "start", "split", "payload", "add"):
        assert [getattr(run, name) for run in with_repeats] == [getattr(run, name) for run in without]


def test_a_payload_hangs_a_quarter_of_a_metre_from_the_axis() -> None:
    runs = session(np.random.default_rng(4), excitation="rich", sample_time=0.002, num_samples=2001)
    loaded = [run for run in runs if run.payload]
    assert len(loaded) == 2
    for run in loaded:
        assert 0.12 <= run.payload <= 0.25
        assert run.add == {
            "gravity_torque": pytest.approx(run.payload * 9.81 * 0.25, rel=1e-5),
            "joint_inertia": pytest.approx(run.payload * 0.0625, rel=1e-5),
        }
    assert all(run.add == {} for run in runs if not run.payload)


def test_runs_begin_at_rest_and_follow_their_shape_from_half_a_second_on() -> None:
    runs = session(Middle(), excitation="poor", sample_time=0.002, num_samples=2001)  # type: ignore[arg-type]
    first = runs[0].reference
    assert first[TIME <= 0.1] == pytest.approx(0.0)
    assert first[TIME >= 0.5] == pytest.approx(drawn(excitation.sine)[TIME >= 0.5])
    assert np.interp(0.3, TIME, first) == pytest.approx(0.5 * np.interp(0.3, TIME, drawn(excitation.sine)), rel=1e-3)

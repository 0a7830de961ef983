"""From lags to findings: what is a lag of one experiment, of all of them, of one channel, or nothing."""

import numpy as np
import pytest

from tendonlab.checking.clocks import STRIKING, _common, clock_findings, striking_findings
from tendonlab.checking.finding import Finding
from tendonlab.checking.lags import Lags

NAMES = ["a", "b", "c", "d", "e"]
STEP = 0.01


def lags_of(
    channels: tuple[str, ...],
    late: np.ndarray,
    gain: np.ndarray,
    *,
    sd: float = 1e-4,
    weight: float = 1e3,
    scanned: tuple[float, ...] = (0.0,) * 5,
) -> Lags:
    return Lags(channels, late, np.full(late.shape, sd), np.full(late.shape, weight), gain, np.array(scanned), 0.1)


def findings(
    seconds: list[list[float]], *, sd: float = 1e-4, weight: float = 1e3, gain: float = 100.0, others: float = 0.0
) -> list[Finding]:
    """`gain`: nats by which lags of its own suit an experiment that lags unlike most; `others`: one of the rest."""
    late = np.array(seconds)
    channels = tuple(f"angle_{k + 1}" for k in range(len(late)))
    own = np.any(np.abs(late - np.median(late, axis=1)[:, None]) > STEP, axis=0)
    gains = np.where(own, gain, others)
    lags = lags_of(channels, late, gains, sd=sd, weight=weight)
    return clock_findings(lags, NAMES[: late.shape[1]], ["motor_torque"], STEP)


def test_no_lag_is_no_finding() -> None:
    assert findings([[0.0, 1e-4, -1e-4, 0.0, 5e-5]]) == []


def test_one_experiment_alone_lags_no_other() -> None:
    """Nothing is known of others, so nothing is averaged over them: no warning of numpy."""
    lags = lags_of(("angle",), np.array([[0.03]]), np.array([100.0]), scanned=(90.0,))
    assert not any(f.blocks for f in clock_findings(lags, NAMES[:1], ["motor_torque"], STEP))


@pytest.mark.parametrize(("seconds", "verb"), [(0.05, "lags"), (-0.05, "leads")])
def test_one_experiment_that_lags_blocks(seconds: float, verb: str) -> None:
    (found,) = findings([[0.0, 0.0, seconds, 0.0, 0.0]])
    assert (found.problem, found.experiment, found.signal, found.blocks) == ("clock", "c", None, True)
    assert found.seconds == pytest.approx(seconds)
    assert found.alternatives == ("motor_torque", "angle_1")
    assert f"angle_1 {verb} the inputs by 50 ms more" in found.detail


@pytest.mark.parametrize(("worth", "is_striking"), [(0.9 * STRIKING, False), (1.1 * STRIKING, True)])
def test_a_lag_that_is_worth_much_is_told_to_the_simulator_whatever_suits_as_well(
    worth: float, is_striking: bool
) -> None:
    late, nothing = np.array([[0.0, 0.0, 0.05, 0.0, 0.0]]), np.zeros(5)
    lags = lags_of(("angle",), late, nothing, weight=worth / 0.05)
    assert clock_findings(lags, NAMES, ["motor_torque"], STEP) == []
    assert [f.experiment for f in striking_findings(lags, NAMES, ["motor_torque"], STEP)] == ["c"] * is_striking


def test_a_lag_that_suits_the_experiment_no_better_is_none() -> None:
    assert findings([[0.0, 0.0, 0.05, 0.0, 0.0]], gain=40.0) == []


@pytest.mark.parametrize(("others", "blocks"), [(49.0, True), (51.0, False), (np.inf, True)])
def test_a_lag_that_stands_out_no_more_than_those_of_the_others_is_none(others: float, blocks: bool) -> None:
    """What the simulator lacks suits lags of their own in all experiments."""
    found = findings([[0.0, 0.0, 0.05, 0.0, 0.0]], others=others)
    assert any(f.blocks for f in found) == blocks


@pytest.mark.parametrize(
    ("nats", "gain", "other", "blocks"),
    [
        (60.0, 0.0, 2.0, True),
        (25.0, 30.0, 2.0, True),
        (25.0, 20.0, 2.0, False),  # its exact lag must say the same, unless the scan says enough
        (19.0, 45.0, 0.0, False),
        (25.0, 30.0, 3.0, False),  # another run looks late, too
    ],
)
def test_a_scan_that_shows_one_late_run_alone_blocks(nats: float, gain: float, other: float, blocks: bool) -> None:
    """Though its exact lag is worth little: noise in a slow run makes it look small."""
    gains, late = np.array([0.0, gain, 0.0, 0.0, 0.0]), np.array([[0.0, 0.02, 0.0, 0.0, 0.0]])
    lags = lags_of(("q",), late, gains, scanned=(0.0, nats, 0.0, other, 0.0))
    found = [f.experiment for f in clock_findings(lags, NAMES, ["motor_torque"], STEP) if f.blocks]
    assert found == (["b"] if blocks else [])


@pytest.mark.parametrize(("others", "blocks"), [((0.001, -0.001, 0.002, 0.0), True), ((0.01, -0.01, 0.02, 0.0), False)])
def test_a_scan_tells_nothing_where_the_lags_of_the_others_scatter_as_much(
    others: tuple[float, ...], blocks: bool
) -> None:
    """A stop, say, delays every motion that meets it."""
    late = np.array([[others[0], 0.04, *others[1:]]])
    lags = lags_of(("q",), late, np.zeros(5), scanned=(0.0, 60.0, 0.0, 0.0, 0.0))
    assert any(f.blocks for f in clock_findings(lags, NAMES, ["motor_torque"], STEP)) == blocks


def test_of_two_late_runs_each_is_judged_against_the_rest() -> None:
    """Not against each other: one that fails is no bar for the other."""
    late = np.array([[0.0, 0.05, 0.0, 0.07, 0.0]])
    lags = lags_of(("q",), late, np.array([9, 90, 45, 150, 9.0]))
    found = clock_findings(lags, NAMES, ["motor_torque"], STEP)
    assert [f.experiment for f in found if f.blocks] == ["d"]


@pytest.mark.parametrize(("other", "blocks"), [(-0.05, False), (0.05, True)])
def test_many_experiments_some_ahead_and_some_late_are_no_matter_of_clocks(other: float, blocks: bool) -> None:
    """Two of five that are late alike may well be."""
    found = findings([[0.0, 0.0, 0.05, other, 0.0]])
    assert any(f.blocks for f in found) == blocks


def test_outputs_that_are_late_together_take_a_plural() -> None:
    (found,) = findings([[0.0, 0.0, 0.05, 0.0, 0.0]] * 2)
    assert "angle_1 and angle_2 lag the inputs" in found.detail


def test_the_lag_of_one_experiment_is_counted_from_what_all_share() -> None:
    found = findings([[0.02, 0.02, 0.09, 0.02, 0.02]])
    assert [(f.experiment, f.blocks) for f in found] == [("c", True), (None, False)]
    assert found[0].seconds == pytest.approx(0.07)
    assert found[1].seconds == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("seconds", "sd", "weight"),
    [
        (1.4 * STEP, 1e-4, 1e3),  # less than a step and a half
        (5.8 * 0.01, 0.01, 1e3),  # less than six sd
        (0.05, 1e-4, 5.8 / 0.05),  # worth less than six times what the equations leave
    ],
)
def test_what_may_be_chance_does_not_block(seconds: float, sd: float, weight: float) -> None:
    assert not any(f.blocks for f in findings([[0.0, 0.0, seconds, 0.0, 0.0]], sd=sd, weight=weight))
    assert any(f.blocks for f in findings([[0.0, 0.0, 1.2 * seconds, 0.0, 0.0]], sd=sd, weight=weight))


def test_of_two_channels_the_one_that_differs_is_guilty() -> None:
    (found,) = findings([[0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.05, 0.0, 0.0, 0.0]])
    assert (found.signal, found.experiment, found.alternatives) == ("angle_2", "b", ())
    assert found.seconds == pytest.approx(0.05)


def test_channels_that_are_late_together_share_the_blame_with_the_inputs() -> None:
    (found,) = findings([[0.0, -0.04, 0.0, 0.0, 0.0], [0.0, -0.05, 0.0, 0.0, 0.0]])
    assert (found.signal, found.experiment) == (None, "b")
    assert found.alternatives == ("motor_torque", "angle_1", "angle_2")
    assert found.seconds == pytest.approx(-0.05)  # the larger one
    assert "angle_1 and angle_2" in found.detail


@pytest.mark.parametrize(("seconds", "verb"), [(0.02, "lags"), (-0.02, "leads")])
def test_a_lag_of_all_experiments_is_a_note(seconds: float, verb: str) -> None:
    (found,) = findings([[seconds] * 5])
    assert (found.experiment, found.signal, found.blocks) == (None, None, False)
    assert found.seconds == pytest.approx(seconds)
    assert f"angle_1 {verb} the inputs by 20 ms in all experiments" in found.detail
    assert findings([[0.9 * 0.25 * STEP * np.sign(seconds)] * 5]) == []  # less than a quarter of a step


def test_channels_that_lag_alike_are_one_note_and_others_one_each() -> None:
    (together,) = findings([[0.020] * 5, [0.021] * 5])
    assert (together.signal, together.alternatives) == (None, ("motor_torque", "angle_1", "angle_2"))
    assert "angle_1 and angle_2 lag the inputs" in together.detail
    apart = findings([[0.02] * 5, [0.06] * 5])
    assert [(f.signal, f.alternatives, round(f.seconds or 0.0, 6)) for f in apart] == [
        ("angle_1", (), 0.02),
        ("angle_2", (), 0.06),
    ]
    (one,) = findings([[0.02] * 5, [0.0] * 5])
    assert (one.signal, one.seconds) == ("angle_1", pytest.approx(0.02))


def test_a_long_lag_is_said_in_seconds() -> None:
    (found,) = findings([[0.0, 0.0, 1.5, 0.0, 0.0]])
    assert "by 1.5 s more" in found.detail


def test_the_common_lag_is_the_weighted_median() -> None:
    """Two exact experiments outweigh three vague ones."""
    seconds = np.array([0.0, 0.001, 0.5, 0.6, 0.7])
    common, scatter = _common(seconds, np.array([1e-3, 1e-3, 1.0, 1.0, 1.0]), np.zeros(5))
    assert common == pytest.approx(0.0005, abs=0.0006)
    assert scatter == 0.0


def test_the_scatter_of_the_middle_experiment_is_what_half_of_normal_errors_exceed() -> None:
    """Lags that scatter by s, where sd is smaller: the total sd becomes s, in proportion to the levels."""
    seconds = 0.05 * np.random.default_rng(0).standard_normal(4001)
    level = np.full(4001, 0.3)
    common, scatter = _common(seconds, np.full(4001, 1e-3), level)
    assert abs(common) < 0.005
    assert 0.97 * 0.05 < scatter * 0.3 < 1.2 * 0.05  # the shares that are tried lie 1.17 apart
    _, small = _common(seconds, np.full(4001, 0.05), level)
    assert np.hypot(0.05, small * 0.3) == pytest.approx(0.05, rel=0.05)


def test_no_output_is_blamed_where_the_lags_of_another_scatter_as_much() -> None:
    """What the simulator lacks delays all outputs alike: what one scatters by, none is guilty of."""
    late = 1e-3 * np.array([[20.0, -37.0, -11.0, 28.0, 49.0], [5.0, 6.0, 4.0, 5.0, 51.0]])
    assert not any(f.blocks for f in findings(late.tolist(), sd=1e-4))
    assert any(f.blocks for f in findings(late[1:].tolist(), sd=1e-4))


@pytest.mark.parametrize(("scatters", "noted"), [(2.0, False), (2.9, True)])
def test_a_lag_of_all_experiments_must_exceed_their_scatter(scatters: float, noted: bool) -> None:
    """The mean of five experiments that scatter by s is known to s/√5; five times this, 2.2 s, make it sure."""
    spread = 0.002 * np.array([-1.5, -0.6745, 0.0, 0.6745, 1.5])
    found = findings([(0.002 * scatters + spread).tolist()], sd=1e-6)
    assert [f.experiment for f in found] == ([None] if noted else [])

"""A stated controller that does not command what was logged is not believed; one whose command was logged is not
simulated where that saves steps."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.cli.demo import bundled
from tendonlab.data import Dataset
from tendonlab.fitting import thinning
from tendonlab.fitting.replay import choose_replay, missed_command, opened
from tendonlab.fitting.thinning import thinned
from tendonlab.simulation.records import Experiment


@pytest.fixture(scope="module")
def rig() -> Dataset:
    dataset = tl.load(bundled())
    assert dataset.controller is not None
    return dataset


def stated(rig: Dataset, **changes: Any) -> Dataset:
    """The rig with other words about its controller."""
    assert rig.controller is not None
    return replace(rig, controller=replace(rig.controller, **changes))


def test_the_true_controller_is_believed(rig: Dataset) -> None:
    assert missed_command(rig, rig.system()) < 1e-3
    assert choose_replay(rig, rig.system()).kind == "controller"


@pytest.mark.parametrize(("name", "factor"), [("kd", 0.0), ("kp", 1.5)])
def test_one_that_the_log_contradicts_is_not(rig: Dataset, name: str, factor: float) -> None:
    wrong = stated(rig, **{name: factor * getattr(rig.controller, name)})
    assert missed_command(wrong, wrong.system()) > 0.1
    assert choose_replay(wrong, wrong.system()).kind == "injection"


@pytest.mark.parametrize(("changes", "is_believed"), [({}, True), ({"kd": 0.0}, False), ({"kp": 1.5}, False)])
def test_in_continuous_time_too_gains_are_compared(rig: Dataset, changes: dict[str, float], is_believed: bool) -> None:
    """The clock is not stated: what is smooth in both commands still tells the gains."""
    gains = {name: factor * getattr(rig.controller, name) for name, factor in changes.items()}
    given = stated(rig, sample_time=0.0, **gains)
    assert (missed_command(given, given.system()) < 0.1) == is_believed
    assert (choose_replay(given, given.system()).kind == "controller") == is_believed


def test_nothing_is_compared_where_the_controller_reads_more_often_than_the_logs(rig: Dataset) -> None:
    unknown = stated(rig, sample_time=0.0005, kd=0.0)
    assert missed_command(unknown, unknown.system()) == 0.0
    assert choose_replay(unknown, unknown.system()).kind == "controller"


@pytest.mark.parametrize("sample_time", [None, 0.0])
def test_noise_is_fed_back_where_the_controller_has_a_clock(rig: Dataset, sample_time: float | None) -> None:
    given = rig if sample_time is None else stated(rig, sample_time=sample_time)
    replay = choose_replay(given, given.system())
    assert replay.kind == "controller"
    assert replay.feeds_noise == replay.carries_noise == (sample_time is None)


def at_every(rig: Dataset, num: int, *, means: bool) -> Dataset:
    """The rig logged `num` times as slowly, its command as means between the samples or picked out at them."""

    def slower(e: Experiment) -> Experiment:
        data = e.data.iloc[::num].copy()
        if means:
            size = num * (len(e.data) // num)
            held = e.data["motor_torque"].to_numpy()[:size].reshape(-1, num).mean(axis=1)
            data["motor_torque"] = np.append(held, e.data["motor_torque"].iloc[size:].mean())[: len(data)]
        holds = {**e.holds, "reference_angle": False, "motor_torque": not means}  # a mean holds, whatever is stated
        return replace(e, data=data.iloc[: len(e.data) // num], holds=holds)

    return replace(rig, experiments=tuple(slower(e) for e in rig.experiments))


def test_a_logged_command_stands_in_for_the_controller(rig: Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    """But where noise shakes the rig that thinning would lose: only the controller makes that again. (Here that noise
    moves the motor, too.)"""
    assert opened(rig, rig.system()).controller is None
    assert thinned(rig) is rig
    for rule in ("JUMPS", "MOST_SHIFTED"):
        monkeypatch.setattr(thinning, rule, np.inf)
    monkeypatch.setattr(thinning, "MOST_LOST_OF_A_LOOP", 0.15)
    few = thinned(rig)
    assert few.controller is None
    assert len(few.experiments[0].data) <= 0.2 * len(rig.experiments[0].data)
    assert choose_replay(few, rig.system()).kind == "injection"


@pytest.mark.parametrize(("name", "factor"), [("kd", 0.0), ("kp", 1.5)])
def test_a_contradicted_one_stays(rig: Dataset, name: str, factor: float) -> None:
    wrong = stated(rig, **{name: factor * getattr(rig.controller, name)})
    assert opened(wrong, wrong.system()) is wrong is thinned(wrong)


@pytest.mark.parametrize(("means", "stands_in"), [(True, True), (False, False)])
def test_a_slow_log_stands_in_if_it_holds_means(rig: Dataset, means: bool, stands_in: bool) -> None:
    slow = at_every(rig, 5, means=means)
    found = opened(slow, slow.system())
    assert (found.controller is None) == stands_in
    assert all(e.holds["motor_torque"] for e in found)
    assert (thinned(slow).controller is None) == stands_in  # nothing to thin, but ticks to save


def test_a_controller_stays_where_a_run_lacks_its_command_or_the_motor(rig: Dataset) -> None:
    first, *others = rig.experiments
    for name in ("motor_torque", "motor_angle"):
        lacks = replace(rig, experiments=(replace(first, data=first.data.drop(columns=name)), *others))
        assert opened(lacks, lacks.system()) is lacks


def test_the_runs_that_are_fitted_decide(rig: Dataset) -> None:
    """As they do whether the controller is believed at all."""

    def wrong(e: Experiment) -> Experiment:
        return replace(e, data=e.data.assign(motor_torque=1.3 * e.data["motor_torque"]))

    for split, stays in (("train", True), ("test", False)):
        runs = tuple(wrong(e) if e.split == split else e for e in rig.experiments)
        given = replace(rig, experiments=runs)
        assert (opened(given, given.system()) is given) == stays
        assert (choose_replay(given, given.system()).kind == "injection") == stays

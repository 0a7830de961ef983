"""A controller that commands its limit most of the time: its loop is not simulated, the logged command is."""

from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import tendonlab as tl
from checking.pendulum import record
from tendonlab.diagnosis import outcome as steps
from tendonlab.fitting.replay import is_mostly_at_its_limit
from tendonlab.simulation.records import Controller

LOOP = Controller(kind="pd", kp=4.0, kd=0.2, measured="joint_angle", reference="reference_angle", limit=0.5)


def limited(folder: Path, share: float, limit: float = 0.5) -> tl.Dataset:
    """Logs whose command is at its limit, one way or the other, in this share of the samples."""
    dataset = record().write(folder)

    def clipped(experiment: tl.Experiment) -> tl.Experiment:
        command = 0.3 * np.ones(len(experiment.data))
        command[: int(share * len(command))] = 0.5
        command[::2] *= -1.0
        data = experiment.data.assign(motor_torque=command, reference_angle=experiment.data["joint_angle"])
        return replace(experiment, data=data)

    experiments = tuple(clipped(e) for e in dataset)
    return replace(dataset, experiments=experiments, controller=replace(LOOP, limit=limit))


@pytest.mark.parametrize(("share", "limit", "mostly"), [(0.6, 0.5, True), (0.4, 0.5, False), (0.6, np.inf, False)])
def test_a_loop_is_driven_by_its_limits_where_most_samples_are_there(
    share: float, limit: float, mostly: bool, tmp_path: Path
) -> None:
    dataset = limited(tmp_path, share, limit)
    assert is_mostly_at_its_limit(dataset, dataset.system()) is mostly


def test_a_loop_without_controller_or_logged_command_is_not(tmp_path: Path) -> None:
    dataset = limited(tmp_path, 0.9)
    assert not is_mostly_at_its_limit(replace(dataset, controller=None), dataset.system())
    silent = tuple(replace(e, data=e.data.drop(columns="motor_torque")) for e in dataset)
    assert not is_mostly_at_its_limit(replace(dataset, experiments=silent), dataset.system())


def test_such_logs_are_opened_with_a_warning_where_they_hold_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    dataset = limited(tmp_path, 0.9)
    monkeypatch.setattr(steps, "opened", lambda dataset, _: dataset)  # as of logs that contradict the controller
    assert steps._opened(dataset, dataset.system(), steps.AT_ITS_LIMIT) is dataset
    monkeypatch.setattr(steps, "opened", lambda dataset, _: replace(dataset, controller=None))
    opened = steps._opened(dataset, dataset.system(), steps.AT_ITS_LIMIT)
    assert opened.controller is None
    assert opened.warnings == (*dataset.warnings, steps.AT_ITS_LIMIT)


class Weighed(NamedTuple):
    """What a search tells of these logs."""

    dataset: tl.Dataset
    rings: bool
    is_untried: bool = False


@pytest.mark.parametrize("still_rings", [False, True])
def test_a_loop_that_rings_is_weighed_by_its_logged_command_where_that_stills_it(
    still_rings: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    dataset = limited(tmp_path, 0.1)
    weighed: list[tl.Dataset] = []

    def weigh(few: tl.Dataset, *_: object) -> Weighed:
        weighed.append(few)
        return Weighed(few, few.controller is not None or still_rings)

    monkeypatch.setattr(steps, "_weighed", weigh)
    monkeypatch.setattr(steps, "_without_run_apart", lambda few, outcome, *_: outcome)
    monkeypatch.setattr(steps, "thinned", lambda dataset, _: dataset)
    monkeypatch.setattr(steps, "opened", lambda dataset, _: replace(dataset, controller=None))
    nobody: Any = None
    outcome: Any = steps._searched(dataset, dataset.system(), nobody)
    assert [few.controller for few in weighed] == [dataset.controller, None]
    assert steps.RINGING in weighed[1].warnings
    assert outcome.dataset is weighed[0 if still_rings else 1]
    assert outcome.is_untried is not still_rings  # no blind series had such loops: reports say "not yet calibrated"

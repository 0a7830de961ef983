"""A sweep is many simulations: the same numbers as one by one, and no run costs another."""

from __future__ import annotations

import pickle
import re
import sys
from collections.abc import Iterable
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures._base import DoneAndNotDoneFutures
from multiprocessing import get_context
from typing import Any

import numpy as np
import pandas as pd
import pytest
from sweeps import assert_is_simulation

import tendonlab as tl
from tendonlab import _core
from tendonlab.sweeping import executors, sizes

TIME = np.arange(0.0, 1.0, 0.005)
PUSHED = pd.DataFrame({"motor_torque": 0.4 * np.sin(6.0 * TIME)}, index=pd.Index(TIME, name="t"))
VALUES = {"inertia": 0.02, "gravity_torque": 0.5, "torque_constant": 1.0, "coulomb": 0.05, "viscous": 0.03}
SIM = tl.System(kind="rigid_joint", parameters=VALUES, effects=("joint:coulomb", "joint:viscous"))
GRID = {"coulomb": [0.02, 0.05, 0.1], "inertia": np.array([0.01, 0.02])}


class OneByOne(Executor):
    """Runs a job when it is submitted; Ctrl-C arrives while the jobs from `interrupted` on are still waiting."""

    def __init__(self, interrupted: int | None = None) -> None:
        self.interrupted = interrupted
        self.jobs: list[Future[Any]] = []

    def submit(self, function: Any, /, *given: Any, **named: Any) -> Future[Any]:
        job: Future[Any] = Future()
        if self.interrupted is None or len(self.jobs) < self.interrupted:
            job.set_running_or_notify_cancel()
            try:
                job.set_result(function(*given, **named))
            except Exception as error:
                job.set_exception(error)
        self.jobs.append(job)
        return job


@pytest.fixture
def ctrl_c(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C at the moment when nothing is left but jobs that wait; a run a task."""

    def done(jobs: Iterable[Future[Any]], **_: Any) -> DoneAndNotDoneFutures[Any]:
        ended = {job for job in jobs if job.done()}
        if not ended:
            raise KeyboardInterrupt
        return DoneAndNotDoneFutures(ended, set())

    monkeypatch.setattr(executors, "wait", done)
    one_run_a_task(monkeypatch)


def one_run_a_task(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("FIRST_SECONDS", "TASK_SECONDS", "THREAD_SECONDS"):
        monkeypatch.setattr(sizes, name, 0.0)


def fails_above(limit: float, monkeypatch: pytest.MonkeyPatch) -> None:
    plain, place = _core.simulate_many, [p.name for p in SIM.info.parameters].index("coulomb")

    def simulate_many(kind: str, values: np.ndarray, *given: Any) -> list[str]:
        messages = plain(kind, values, *given)
        for k in np.flatnonzero(values[:, place] > limit):
            given[-1][k] = np.nan
            messages[k] = "joint_angle is not finite from t = 0.1 s"
        return messages

    monkeypatch.setattr(_core, "simulate_many", simulate_many)


def test_each_point_is_the_simulation_with_its_parameters() -> None:
    swept = tl.sweep(SIM, GRID, experiment=PUSHED, progress=False)
    assert dict(swept.sizes) == {"coulomb": 3, "inertia": 2, "t": len(TIME)}
    assert list(swept.data_vars) == ["joint_angle", "joint_velocity"]
    assert set(swept["message"].to_numpy().ravel()) == {""}
    for coulomb in GRID["coulomb"]:
        for inertia in GRID["inertia"]:
            alone = SIM.with_parameters({"coulomb": coulomb, "inertia": inertia}).simulate(PUSHED)
            point = swept.sel(coulomb=coulomb, inertia=inertia)
            assert_is_simulation(point["joint_angle"].to_numpy(), alone["joint_angle"])
            assert_is_simulation(point["joint_velocity"].to_numpy(), alone["joint_velocity"])


@pytest.mark.parametrize("reduce", [None, "rms"])
def test_a_grid_without_axes_is_one_simulation(reduce: str | None) -> None:
    swept = tl.sweep(SIM, {}, experiment=PUSHED, reduce=reduce, progress=False)
    alone = SIM.simulate(PUSHED)["joint_angle"].to_numpy()
    expected = alone if reduce is None else np.sqrt(np.mean(alone**2))
    np.testing.assert_allclose(swept["joint_angle"].to_numpy(), expected, atol=1e-5)


def test_axes_and_outputs_carry_their_units() -> None:
    swept = tl.sweep(SIM, {"coulomb": [0.02]}, experiment=PUSHED, progress=False)
    units = {str(name): swept[name].attrs["unit"] for name in ("coulomb", "t", "joint_angle", "joint_velocity")}
    assert units == {"coulomb": "N*m", "t": "s", "joint_angle": "rad", "joint_velocity": "rad/s"}


def test_a_sweep_pickles_to_its_equal() -> None:
    swept = tl.sweep(SIM, {"coulomb": [0.02]}, experiment=PUSHED, progress=False)
    assert swept.identical(pickle.loads(pickle.dumps(swept)))


def test_what_is_no_system_is_refused() -> None:
    with pytest.raises(tl.ParameterError, match="system = 'rig': expected a System, such as"):
        tl.sweep("rig", GRID, experiment=PUSHED)  # type: ignore[arg-type]


def test_whatever_runs_it_the_bits_are_the_same() -> None:
    swept = tl.sweep(SIM, GRID, experiment=PUSHED, progress=False)
    with ThreadPoolExecutor(1) as thread, ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes:
        for executor in (thread, processes, OneByOne()):
            assert swept.identical(tl.sweep(SIM, GRID, experiment=PUSHED, executor=executor, progress=False))
        assert thread.submit(int, "3").result() == 3  # an executor that was lent stays open


def test_without_a_grid_it_is_one_simulation() -> None:
    swept = tl.sweep(SIM, {}, experiment=PUSHED, progress=False)
    assert_is_simulation(swept["joint_angle"].to_numpy(), SIM.simulate(PUSHED)["joint_angle"])


def test_a_point_that_fails_costs_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = tl.sweep(SIM, GRID, experiment=PUSHED, progress=False)
    fails_above(0.07, monkeypatch)
    swept = tl.sweep(SIM, GRID, experiment=PUSHED, progress=False)
    assert swept["message"].sel(coulomb=0.1).to_numpy().tolist() == ["joint_angle is not finite from t = 0.1 s"] * 2
    assert np.isnan(swept["joint_angle"].sel(coulomb=0.1)).all()
    assert swept.isel(coulomb=slice(2)).identical(whole.isel(coulomb=slice(2)))


def test_where_every_point_fails_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    fails_above(0.0, monkeypatch)
    with pytest.raises(tl.NumericalError, match="none of 6 points could be simulated; the first: joint_angle is not"):
        tl.sweep(SIM, GRID, experiment=PUSHED, progress=False)


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_keeps_what_was_done() -> None:
    executor = OneByOne(interrupted=4)
    swept = tl.sweep(SIM, GRID, experiment=PUSHED, executor=executor, progress=False)
    assert swept["message"].to_numpy().ravel().tolist() == [""] * 4 + ["interrupted"] * 2
    assert np.isfinite(swept["joint_angle"]).sum() == 4 * len(TIME)
    assert all(job.cancelled() for job in executor.jobs[4:])


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_before_anything_is_done_is_ctrl_c() -> None:
    with pytest.raises(KeyboardInterrupt):
        tl.sweep(SIM, GRID, experiment=PUSHED, executor=OneByOne(interrupted=0), progress=False)


@pytest.mark.parametrize(
    ("grid", "told"),
    [
        ({"coulom": [0.1]}, "coulom = 0.1: no parameter of rigid_joint .* did you mean 'coulomb'"),
        ({"coulomb": [0.1, -0.1]}, r"coulomb = -0.1: expected a value in \[0, inf\) N\*m"),
        ({"coulomb": []}, r"coulomb has shape \(0,\): expected a list of values"),
        ({"coulomb": ["low"]}, r"coulomb = \['low'\]: expected a list of numbers"),
        ({"coulomb": [0.1, 0.2, 0.1]}, "coulomb: duplicate 0.1"),
        (["coulomb"], "grid is a list: expected a mapping"),
        ({"coulomb": 0.1}, r"coulomb has shape \(\): expected a list of values"),
    ],
)
def test_a_grid_that_means_nothing_is_refused(grid: Any, told: str) -> None:
    with pytest.raises(tl.ParameterError, match=told):
        tl.sweep(SIM, grid, experiment=PUSHED, progress=False)


def test_a_missing_input_is_named() -> None:
    with pytest.raises(tl.DatasetError, match="input 'motor_torque' was not logged"):
        tl.sweep(SIM, GRID, experiment=PUSHED.rename(columns={"motor_torque": "torque"}), progress=False)


def test_progress_in_a_log_is_whole_lines(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tendonlab.progress.INTERVAL", 0.0)
    tl.sweep(SIM, GRID, experiment=PUSHED, progress=False)
    assert capsys.readouterr() == ("", "")
    tl.sweep(SIM, GRID, experiment=PUSHED)
    assert capsys.readouterr().err.splitlines() == [f"sweep: {k} of 6 runs, 0 s left" for k in range(1, 7)]


def test_progress_in_a_terminal_is_a_bar(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    tl.sweep(SIM, GRID, experiment=PUSHED)
    assert re.search(r"sweep: 100%.* 6/6 ", capsys.readouterr().err)


def test_progress_in_a_notebook_is_no_error(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "ipykernel", sys)
    monkeypatch.setattr("tendonlab.progress.find_spec", lambda name: None)  # no widgets
    tl.sweep(SIM, GRID, experiment=PUSHED)
    printed = capsys.readouterr()
    assert printed.err == ""
    assert re.search(r"sweep: 100%.* 6/6 ", printed.out)

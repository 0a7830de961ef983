"""Whole runs whose errors remember for seconds are weighed in parts; others are not."""

from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tendonlab.data import Dataset, Experiment
from tendonlab.diagnosis.windows import _parts, in_windows

TIME = np.arange(0.0, 6.4, 0.005)


def run(name: str, split: str = "train", **more: Any) -> Experiment:
    return Experiment(name=name, split=split, data=pd.DataFrame({"joint_angle": np.sin(TIME)}, index=TIME), **more)


def searched(**other: Any) -> SimpleNamespace:
    """A search that established nothing: 10 times the floor is left of two runs, of whose samples 0.2 % count."""
    of = {"selected": (), "kind": "free", "repeated": False, "dof": 1, "left": 10.0, "share": 0.002} | other
    rows = np.zeros(len(TIME), dtype=int)
    case = SimpleNamespace(
        replay=SimpleNamespace(kind=of["kind"]), system=SimpleNamespace(info=SimpleNamespace(dof=of["dof"]))
    )
    final = SimpleNamespace(
        mean_square=of["left"], shares=np.array([of["share"]]), runs=[SimpleNamespace(output=rows)] * 2
    )
    floor = SimpleNamespace(repeated=of["repeated"])
    return SimpleNamespace(selected=of["selected"], final=final, fitter=SimpleNamespace(case=case, floor=floor))


def dataset(*experiments: Experiment) -> Dataset:
    return Dataset(
        name="rig", description="", kind="servo_pendulum", axis="rotary", nominal_effects=None, parameters={},
        controller=None, signals={}, experiments=experiments, path=Path("rig"),
    )  # fmt: skip


def test_parts_cover_the_run_and_share_their_ends() -> None:
    parts = list(_parts(run("a", initial={"joint_velocity": 0.0}, conditions={"gravity_torque": 2.0})))
    assert len({part.name for part in parts}) == 6
    assert parts[0].time[0] == TIME[0]
    assert parts[-1].time[-1] == TIME[-1]
    assert all(a.time[-1] == b.time[0] for a, b in pairwise(parts))
    assert all(part.duration == pytest.approx(1.0, abs=0.1) for part in parts)
    assert [part.initial for part in parts] == [{"joint_velocity": 0.0}, *[{}] * 5]  # known of the beginning alone
    assert all(part.conditions == {"gravity_torque": 2.0} for part in parts)


def test_parts_of_a_run_repeat_nothing() -> None:
    parts = list(_parts(run("a", repeat="sweep")))
    assert [part.repeat for part in parts] == [None] * 6
    assert [part.name for part in parts] == [f"a (part {k})" for k in range(1, 7)]


def test_a_run_of_few_samples_has_parts_that_can_be_diagnosed() -> None:
    slow = pd.DataFrame({"joint_angle": np.arange(70.0)}, index=np.arange(70.0))
    assert [len(part.data) >= 32 for part in _parts(Experiment(name="a", data=slow))] == [True, True]


def test_training_runs_alone_are_cut() -> None:
    cut = in_windows(dataset(run("a"), run("b"), run("c", split="test")), searched())
    assert cut is not None
    assert [e.name for e in cut[0].test] == ["c"]
    assert len(cut[0].train) == 12
    assert "5 samples of them count as independent" in cut[1]


@pytest.mark.parametrize(
    "other",
    [
        {"selected": ("joint:coulomb",)},
        {"kind": "injection"},
        {"repeated": True},
        {"dof": 0},
        {"left": 7.0},
        {"share": 0.01},
    ],
)
def test_whole_runs_are_kept_where_they_tell_enough(other: dict[str, Any]) -> None:
    assert in_windows(dataset(run("a"), run("b")), searched(**other)) is None


def test_a_session_is_kept_whole() -> None:
    assert in_windows(dataset(run("a", start=0.0), run("b", start=60.0)), searched()) is None

"""Mistakes in the logs of drawn rigs: what each does, that the rigs stay the same, and how a report is scored."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tendonlab.blind import draw
from tendonlab.blind.faults import Fault, draw_fault, spoiled
from tendonlab.blind.rig import Rig, draw_rig
from tendonlab.blind.scoring import compared
from tendonlab.blind.systems import SYSTEMS, TWO_INERTIA

TIME = 0.01 * np.arange(100)
LOGS = {name: {"time": TIME, "u": np.sin(k + TIME), "y": np.cos(k + TIME)} for k, name in enumerate(("a", "b"))}


def rig(seed: int = 0, system: str = "rigid_joint") -> Rig:
    return draw_rig(np.random.default_rng(seed), effect="", kind="none", system=SYSTEMS[system])


def test_a_factor_acts_on_one_signal_of_every_run() -> None:
    wrong = spoiled(LOGS, Fault(problem="scale", signals=("u",), factor=2.0), outputs=("y",))
    for name, log in LOGS.items():
        np.testing.assert_array_equal(wrong[name]["u"], 2.0 * log["u"])
        np.testing.assert_array_equal(wrong[name]["y"], log["y"])


def test_a_late_run_has_its_outputs_behind_its_inputs() -> None:
    wrong = spoiled(LOGS, Fault(problem="clock", experiment="b", seconds=0.03), outputs=("y",))
    np.testing.assert_array_equal(wrong["b"]["y"][3:], LOGS["b"]["y"][:-3])
    np.testing.assert_array_equal(wrong["b"]["u"], LOGS["b"]["u"])
    np.testing.assert_array_equal(wrong["a"]["y"], LOGS["a"]["y"])


def test_a_copy_is_another_run() -> None:
    wrong = spoiled(LOGS, Fault(problem="copy", experiment="b", original="a"), outputs=("y",))
    np.testing.assert_array_equal(wrong["b"]["u"], LOGS["a"]["u"])


@pytest.mark.parametrize("system", SYSTEMS)
def test_every_mistake_is_drawn_for_every_rig(system: str) -> None:
    faults = [draw_fault(rig(system=system), np.random.default_rng(seed)) for seed in range(60)]
    assert {fault.problem for fault in faults} == {"sign", "scale", "clock", "copy"}
    signals = {SYSTEMS[system].inputs[0].name, *SYSTEMS[system].output_names, "time"}
    assert {signal for fault in faults for signal in fault.signals} <= signals
    assert all(fault.factor != 1.0 for fault in faults if fault.problem in ("sign", "scale"))
    assert all(0.015 < fault.seconds < 0.065 for fault in faults if fault.problem == "clock")


def test_turning_the_only_output_is_turning_the_input() -> None:
    def guilty(one: Rig) -> set[int]:
        faults = [draw_fault(one, np.random.default_rng(seed)) for seed in range(60)]
        return {len(fault.signals) for fault in faults if fault.problem == "sign"}

    angle_only = next(r for r in map(rig, range(20)) if r.outputs == ("joint_angle",))
    assert guilty(angle_only) == {2}
    assert guilty(draw_rig(np.random.default_rng(0), effect="", kind="none", system=TWO_INERTIA)) == {1}


def test_rigs_are_the_same_with_and_without_mistakes(tmp_path: Path) -> None:
    options: dict[str, Any] = {"system": "rigid_joint", "jobs": 1, "num_samples": 200, "step": 5e-4, "progress": False}
    draw(6, 4, tmp_path / "right", **options)
    draw(6, 4, tmp_path / "wrong", faults=0.5, **options)
    spoilt = 0
    for path in sorted((tmp_path / "wrong" / "sealed").glob("*.toml")):
        wrong, right = (tomllib.loads((tmp_path / name / "sealed" / path.name).read_text()) for name in FOLDERS)
        assert wrong["truth"] == right["truth"]
        tables = [
            {csv.name: pd.read_csv(csv) for csv in (tmp_path / name / "cases" / path.stem).glob("*.csv")}
            for name in FOLDERS
        ]
        differ = any(not tables[0][name].equals(tables[1][name]) for name in tables[0])
        assert differ == ("fault" in wrong)
        if "fault" in wrong:
            spoilt += 1
            assert (wrong["verdict"], wrong["effects"]) == ("data_fault", [])
    assert spoilt == 2


FOLDERS = ("wrong", "right")
TRUTH = {
    "effects": [],
    "verdict": "data_fault",
    "fault": {"problem": "sign", "signals": ["u", "y"], "experiments": []},
}


@pytest.mark.parametrize(
    ("problem", "signal", "blocks", "expected"),
    [
        ("sign", "y", True, (True, True)),
        ("sign", "z", True, (True, False)),
        ("scale", "u", True, (False, False)),
        ("sign", "u", False, (False, False)),
    ],
)
def test_a_mistake_is_found_by_its_kind(problem: str, signal: str, blocks: bool, expected: tuple[bool, bool]) -> None:
    entry = {"problem": problem, "signal": signal, "experiment": None, "blocks": blocks}
    found = compared(TRUTH, {"verdict": "data_fault", "effects": [], "data": [entry]})
    assert (found["fault_kind"], found["fault_signal"]) == expected


def test_right_logs_that_are_refused_are_counted() -> None:
    truth = {"effects": [], "verdict": "no_gap"}
    assert compared(truth, {"verdict": "data_fault", "effects": []})["blocked"]
    assert not compared(truth, {"verdict": "no_gap", "effects": []})["blocked"]
    assert compared(truth, {"verdict": "failed", "effects": []})["blocked"]

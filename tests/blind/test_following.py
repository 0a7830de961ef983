"""One more experiment for the cases whose report ends in a tie."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from sealed_cases import Drawn

from tendonlab.blind.following import follow

NUM, STEP = 120, 2e-4  # samples and step of the cases of `drawn`
TIME = np.arange(0.0, 0.6, 0.004)
PATH = 0.3 + 0.1 * np.sin(9.0 * TIME) ** 2


def reports(folder: Path, name: str, *, gain: float = 40.0, tied: bool = True, column: str = "ql") -> Path:
    """A report on one case that advises a motion."""
    (folder / name).mkdir(parents=True)
    motion = {"description": "slowly", "expected_gain": gain, "reference": "next-1.csv", "add": {"gravity_torque": 0.5}}
    words = {"indistinguishable": [["a", "b"]] if tied else [], "next_experiments": [motion]}
    (folder / name / "report.json").write_text(json.dumps(words))
    pd.DataFrame({"t": TIME, column: PATH}).to_csv(folder / name / "next-1.csv", index=False)
    return folder


def followed(told: Path, folder: Path, **options: str) -> Path:
    where = {"sealed": folder / "truth", **options}
    return follow(15, 4, told, folder / "out", step=STEP, num_samples=NUM, **where) / "cases"  # type: ignore[arg-type]


def test_a_tied_case_gets_the_advised_experiment_and_keeps_its_own(drawn: Drawn, tmp_path: Path) -> None:
    cases = followed(reports(tmp_path / "told", "case-002"), tmp_path)
    (case,) = cases.iterdir()
    before, after = (tomllib.loads((f / "case-002" / "dataset.toml").read_text()) for f in (drawn.cases, cases))
    (new,) = [e for e in after["experiments"] if e not in before["experiments"]]
    assert before == after | {"experiments": before["experiments"]}
    assert new["split"] == "train"
    assert new["add"] == pytest.approx({"gravity_torque": 0.5, "joint_inertia": 0.5 / 9.81 * 0.25}, rel=1e-6)
    for old in before["experiments"]:
        assert (case / old["file"]).read_bytes() == (drawn.cases / "case-002" / old["file"]).read_bytes()
    truths = [(place / "case-002.toml").read_text() for place in (drawn.sealed, tmp_path / "truth")]
    assert truths[0] == truths[1]
    log, gear = pd.read_csv(case / new["file"]), 10.0
    assert np.allclose(log["qr"] / gear, np.interp(log["t"], TIME, PATH), atol=1e-7)  # digits of the log
    assert np.corrcoef(log["ql"], np.interp(log["t"], TIME, PATH))[0, 1] > 0.9


def test_the_random_motion_is_as_long_and_another_one(tmp_path: Path) -> None:
    case = followed(reports(tmp_path / "told", "case-002"), tmp_path, choice="random") / "case-002"
    log = pd.read_csv(case / "run-next.csv")
    assert log["t"].iloc[-1] == pytest.approx(TIME[-1], abs=0.003)
    off = log["qr"] / 10.0 - np.interp(log["t"], TIME, PATH)
    assert np.ptp(off) > 0.02
    assert "add" not in tomllib.loads((case / "dataset.toml").read_text())["experiments"][-1]


@pytest.mark.parametrize(("gain", "tied"), [(5.0, True), (40.0, False)])
def test_only_a_tie_that_a_motion_decides_is_followed(gain: float, tied: bool, tmp_path: Path) -> None:
    told = reports(tmp_path / "told", "case-002", gain=gain, tied=tied)
    with pytest.raises(ValueError, match="expected a report with a tie that a motion decides, found none"):
        followed(told, tmp_path)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("more", [{"w": PATH}, {}])
def test_inputs_of_a_rig_without_a_path_and_motions_for_unknown_causes_are_not_followed(
    more: dict[str, np.ndarray], tmp_path: Path
) -> None:
    told = reports(tmp_path / "told", "case-002")
    pd.DataFrame({"t": TIME, "u": PATH, **more}).to_csv(told / "case-002" / "next-1.csv", index=False)
    if not more:
        report = json.loads((told / "case-002" / "report.json").read_text())
        report["next_experiments"][0]["separates"] = ["joint_position", "time"]
        (told / "case-002" / "report.json").write_text(json.dumps(report))
    with pytest.raises(ValueError, match="expected a report with a tie that a motion decides, found none"):
        followed(told, tmp_path)

"""Drawn folders, the runner that keeps the truth away, and the scorer."""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import shlex
import shutil
import sys
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from sealed_cases import Drawn

import tendonlab as tl
from tendonlab.blind import commands, draw, drawing, run, runner, score
from tendonlab.blind.commands import add_parser
from tendonlab.blind.planning import plan
from tendonlab.blind.rig import draw_rig
from tendonlab.blind.runner import command
from tendonlab.blind.systems import RIGID_JOINT, SYSTEMS, TWO_INERTIA
from tendonlab.blind.twin import make_twin

ROOT = Path(__file__).parents[2]
BUNDLED = ROOT / "data" / "two_inertia"
PAGE = ROOT / "docs" / "blind.md"
# of the cases of `drawn`, seed 15: the stated numbers' hash, and the last row of run 10: t, u, qm, ql, fc(, qr)
STATED = "1eea9a0e0aac3adf"
LAST_ROWS = {
    "case-001": (0.238, 0.1083890, 2.302889, 0.2180170, 0.7040),
    "case-002": (0.238, 0.0515471, 3.824981, 0.3731408, 0.4340, 3.9536219),
    "case-003": (0.238, 0.0801274, -0.695660, -0.0824515, 0.4900),
    "case-004": (0.238, -0.0271821, -2.530685, -0.2462039, -0.4340),
}


def read(path: Path) -> dict:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def test_drawn_folders_are_complete(drawn: Drawn):
    cases = sorted(drawn.cases.iterdir())
    assert [case.name for case in cases] == [f"case-{i:03d}" for i in range(1, 5)]
    for case in cases:
        dataset = read(case / "dataset.toml")
        assert dataset["format"] == "tendonlab-dataset/1"
        assert dataset["name"] == case.name
        assert [e["split"] for e in dataset["experiments"]].count("test") == 3
        assert [e.get("repeat") for e in dataset["experiments"]].count("A") == 3
        for experiment in dataset["experiments"]:
            table = pd.read_csv(case / experiment["file"])
            assert [signal["column"] for signal in dataset["signals"].values()] == list(table.columns[1:])
            assert np.all(np.diff(table["t"]) > 0)
            assert np.all(np.isfinite(table.to_numpy()))


def test_truth_lies_outside_the_cases(drawn: Drawn):
    words = ("truth", "sealed", "verdict", "parameters_only", "stribeck", "gap_noise")
    for path in drawn.cases.rglob("*"):
        assert "sealed" not in path.name
        if path.suffix == ".toml":
            assert not any(word in path.read_text(encoding="utf-8") for word in words)
    for case in drawn.cases.iterdir():
        sealed = read(drawn.sealed / f"{case.name}.toml")
        assert sealed["format"] == "tendonlab-sealed/1"
        nominal = read(case / "dataset.toml")["system"]
        for effect in sealed["effects"]:
            assert effect not in nominal["nominal_effects"]
            assert set(sealed["truth"]) > set(nominal["parameters"])
        assert all(isinstance(value, float) for value in sealed["truth"].values())


def test_draw_refuses_to_overwrite(drawn: Drawn, tmp_path: Path):
    with pytest.raises(FileExistsError, match=r"cases exists: expected a new folder"):
        draw(11, 1, drawn.cases.parent, progress=False)
    with pytest.raises(FileExistsError, match=r"truth exists: expected a new folder"):
        draw(11, 1, tmp_path / "new", sealed=drawn.sealed, progress=False)
    with pytest.raises(ValueError, match="count = 0"):
        draw(11, 0, tmp_path / "new", progress=False)
    assert list(tmp_path.iterdir()) == []


def test_truth_is_drawn_beside_the_cases_unless_told_where(tmp_path: Path):
    draw(15, 1, tmp_path, jobs=1, num_samples=120, step=2e-4, progress=False)
    assert (tmp_path / "sealed" / "case-001.toml").is_file()


def test_every_effect_has_its_turn():
    cases = plan(1, 40)
    assert {case.effect for case in cases if case.kind == "effect"} == set(TWO_INERTIA.effects)
    assert [case.kind for case in cases].count("none") == 6
    assert [case.kind for case in cases].count("parameters_only") == 6
    assert cases == plan(1, 40) != plan(2, 40)


def test_mixed_cases_are_of_all_systems_alike():
    cases = plan(1, 41, system="mixed")
    systems = [case.system for case in cases]
    counts = [systems.count(kind) for kind in SYSTEMS]
    assert sum(counts) == 41
    assert max(counts) - min(counts) <= 1
    for case in cases:
        assert not case.effect or case.effect in SYSTEMS[case.system].effects
    with pytest.raises(ValueError, match=r"system = 'bowden': expected one of two_inertia, rigid_joint, .*, mixed"):
        plan(1, 4, system="bowden")


def test_the_rigid_joint_lacks_every_effect_that_the_library_knows():
    assert {case.effect for case in plan(1, 40, system="rigid_joint")} >= set(RIGID_JOINT.effects)
    assert set(RIGID_JOINT.effects) == {effect.name for effect in tl.system_info("rigid_joint").effects}


def test_a_drawn_rigid_joint_is_a_dataset_of_the_library(tmp_path: Path):
    draw(2, 2, tmp_path, system="rigid_joint", jobs=1, num_samples=300, step=5e-4, progress=False)
    for case in sorted((tmp_path / "cases").iterdir()):
        dataset, sealed = tl.load(case), read(tmp_path / "sealed" / f"{case.name}.toml")
        assert dataset.kind == "rigid_joint"
        assert set(dataset.system().parameters) >= {"inertia", "gravity_torque"}
        assert set(sealed["truth"]) >= {"inertia", "gravity_torque", "coulomb", "viscous"}
        assert any("inertia" in experiment.add for experiment in dataset.experiments) == (
            sealed["draw"]["excitation"] == "rich"
        )


def test_repeats_are_a_share_of_the_cases_and_change_nothing_else():
    cases = plan(1, 40, repeats=0.25)
    assert [case.has_repeats for case in cases].count(True) == 10
    assert [(case.kind, case.effect) for case in cases] == [(case.kind, case.effect) for case in plan(1, 40)]
    assert not any(case.has_repeats for case in plan(1, 40, repeats=0.0))


def test_other_motions_of_the_same_kind_take_the_places_of_the_repeats():
    pair = [
        draw_rig(np.random.default_rng(4), effect="", kind="none", num_samples=200, has_repeats=has_repeats)
        for has_repeats in (True, False)
    ]
    repeated, single = (rig.experiments for rig in pair)
    places = [i for i, run in enumerate(repeated) if run.repeat]
    assert len(places) == 3
    assert [run.repeat for run in single] == [None] * 10
    moved = [not np.array_equal(a.reference, b.reference) for a, b in zip(repeated, single, strict=True)]
    assert [i for i, other in enumerate(moved) if other] == places[1:]
    assert not np.array_equal(single[places[1]].reference, single[places[2]].reference)
    assert replace(pair[0], experiments=()) == replace(pair[1], experiments=())


def test_two_inertia_cases_of_a_seed_stay_the_same(drawn: Drawn):
    """The stated numbers have five digits, so they are equal on every machine; the logs may differ in their last."""
    stated = b"".join((case / "dataset.toml").read_bytes() for case in sorted(drawn.cases.iterdir()))
    assert hashlib.sha256(stated).hexdigest().startswith(STATED)
    for name, last in LAST_ROWS.items():
        row = pd.read_csv(drawn.cases / name / "run-10.csv").iloc[-1]
        np.testing.assert_allclose(row, last, rtol=0, atol=2e-4)


def test_twin_without_effect_states_the_truth(tmp_path: Path):
    folder = make_twin(tmp_path / "none", kind="none", num_samples=100, step=2e-4)
    sealed = read(folder / "sealed.toml")
    stated = {name: entry["value"] for name, entry in read(folder / "dataset.toml")["system"]["parameters"].items()}
    assert sealed["verdict"] == "no_gap"
    assert stated == sealed["truth"]
    off = make_twin(tmp_path / "off", kind="parameters_only", num_samples=100, step=2e-4)
    values = read(off / "dataset.toml")["system"]["parameters"]
    ratios = {name: values[name]["value"] / true for name, true in sealed["truth"].items()}
    assert ratios.pop("gear_ratio") == 1.0
    assert all(0.099 < abs(ratio - 1.0) < 0.201 for ratio in ratios.values())
    with pytest.raises(ValueError, match="kind = 'noone'"):
        make_twin(tmp_path / "no", kind="noone")


def test_bundled_twin_is_small_and_strong_enough():
    sealed = read(BUNDLED / "sealed.toml")
    assert sealed["effects"] == ["joint:stribeck"]
    assert 3.0 < sealed["draw"]["gap_noise"] < 4.0
    assert sum(path.stat().st_size for path in BUNDLED.iterdir()) < 3e6


def fake_reports(monkeypatch: pytest.MonkeyPatch, sealed: Path, *, right: bool) -> None:
    """Stand in for the diagnosis: a process that writes a report, right or wrong, knowing the answers."""

    def answer(case: Path, out: Path) -> list[str]:
        truth = read(sealed / f"{case.name}.toml")
        effects = truth["effects"] if right else ["cable:backlash"]
        named = [dict(zip(("element", "effect"), e.split(":"), strict=True), probability=0.9) for e in effects]
        verdict = truth["verdict"] if right else "effect"
        shrinkage = {"from_refitted": {"value": 0.95 if named else None}}
        report = {"verdict": verdict, "effects": named, "selected": effects, "shrinkage": shrinkage, "seconds": 1.0}
        script = f"import pathlib; pathlib.Path({str(out / 'report.json')!r}).write_text({json.dumps(report)!r})"
        return [sys.executable, "-c", script]

    monkeypatch.setattr(runner, "command", answer)


@pytest.mark.parametrize("right", [True, False])
def test_run_and_score(drawn: Drawn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, right: bool):
    fake_reports(monkeypatch, drawn.sealed, right=right)
    verdicts = run(drawn.cases, tmp_path, jobs=2, progress=False)
    result = score(drawn.sealed, tmp_path)
    assert len(json.loads(verdicts.read_text())["reports"]) == 4
    assert result.summary["top1"] == result.summary["top3"] == float(right)
    assert result.summary["verdict right"] == 1.0 if right else result.summary["verdict right"] < 1.0
    assert result.verdicts.to_numpy().sum() == 4
    alarms = [result.summary[f"false alarms on {truth}"] for truth in ("no_gap", "parameters_only")]
    assert {float(not right)} == {alarm for alarm in alarms if alarm == alarm}
    assert "top1" in str(result)


def test_changed_report_is_noticed(drawn: Drawn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    fake_reports(monkeypatch, drawn.sealed, right=False)
    run(drawn.cases, tmp_path, progress=False)
    fake_reports(monkeypatch, drawn.sealed, right=True)
    before = (tmp_path / "case-001" / "report.json").read_text()
    run(drawn.cases, tmp_path, progress=False)
    assert (tmp_path / "case-001" / "report.json").read_text() == before  # resumed, not run again
    (tmp_path / "case-001" / "report.json").write_text(before.replace("0.9", "0.8"))
    with pytest.raises(ValueError, match="is not the report that was hashed"):
        score(drawn.sealed, tmp_path)


def test_failed_case_is_recorded(drawn: Drawn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    script = "import sys; sys.exit('out of luck')"
    monkeypatch.setattr(runner, "command", lambda case, out: [sys.executable, "-c", script])
    verdicts = json.loads(run(drawn.cases, tmp_path, progress=False).read_text())["reports"]
    assert verdicts["case-001"] == {"verdict": "failed", "message": "exit 1: out of luck"}
    summary = score(drawn.sealed, tmp_path).summary
    assert summary["top1"] == summary["verdict right"] == summary["median shrinkage"] == 0.0
    assert summary["failed"] == 4
    alarms = [summary[f"false alarms on {truth}"] for truth in ("no_gap", "parameters_only")]
    assert {1.0} == {alarm for alarm in alarms if alarm == alarm}


def test_case_that_takes_too_long_has_failed(drawn: Drawn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(runner, "command", lambda case, out: [sys.executable, "-c", "import time; time.sleep(60)"])
    verdicts = json.loads(run(drawn.cases, tmp_path, jobs=4, timeout=0.2, progress=False).read_text())["reports"]
    assert verdicts["case-001"] == {"verdict": "failed", "message": "no verdict within 0.2 s"}


def test_case_that_failed_gets_no_second_try(drawn: Drawn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """One failure is written before the next case begins, and stands in the verdicts of the call that goes on."""
    ended: list[str] = []

    def interrupted(command: list[str], out: Path, timeout: float) -> str:
        if ended:
            raise KeyboardInterrupt
        ended.append(out.name)
        out.mkdir(parents=True)
        return "exit 1: out of luck"

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runner, "_diagnose", interrupted)
        with pytest.raises(KeyboardInterrupt):
            run(drawn.cases, tmp_path, progress=False)
    fake_reports(monkeypatch, drawn.sealed, right=True)
    verdicts = json.loads(run(drawn.cases, tmp_path, progress=False).read_text())["reports"]
    assert verdicts["case-001"] == {"verdict": "failed", "message": "exit 1: out of luck"}
    assert [entry["verdict"] for entry in verdicts.values()].count("failed") == 1


def test_drawn_case_that_was_never_run_counts_as_wrong(drawn: Drawn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    fake_reports(monkeypatch, drawn.sealed, right=True)
    shutil.copytree(drawn.cases, tmp_path / "cases")
    shutil.rmtree(tmp_path / "cases" / "case-001")
    run(tmp_path / "cases", tmp_path / "reports", progress=False)
    summary = score(drawn.sealed, tmp_path / "reports").summary
    assert summary["cases"] == 4
    assert summary["failed"] == 1
    assert summary["verdict right"] == 0.75


@pytest.mark.parametrize(
    ("verdict", "probability", "selected", "recall", "named"),
    [
        ("unknown_effect", 0.9, [], 1.0, 0.0),
        ("unknown_effect", 0.7, ["cable:backlash"], 1.0, 0.0),
        ("effect", 0.9, ["cable:backlash"], 0.0, 1.0),
        ("no_gap", 0.9, [], 0.0, 0.0),
        ("failed", 0.0, [], 0.0, 1.0),
    ],
)
def test_score_of_unknown_causes(
    tmp_path: Path, verdict: str, probability: float, selected: list[str], recall: float, named: float
):
    (tmp_path / "truth").mkdir()
    truth = 'format = "tendonlab-sealed/1"\neffects = []\nverdict = "unknown_effect"\naccept = []\n[draw]\n'
    (tmp_path / "truth" / "case-001.toml").write_text(truth + 'cause = "bump"\nsystem = "two_inertia"\n')
    effects = [{"element": "cable", "effect": "backlash", "probability": probability}]
    report = tmp_path / "case-001" / "report.json"
    report.parent.mkdir()
    report.write_text(json.dumps({"verdict": verdict, "selected": selected, "effects": effects}))
    told = {"verdict": verdict, "sha256": hashlib.sha256(report.read_bytes()).hexdigest()}
    (tmp_path / "verdicts.json").write_text(json.dumps({"reports": {"case-001": told}}))
    result = score(tmp_path / "truth", tmp_path)
    assert result.summary["unknown recall"] == result.causes.loc["bump", "unknown_hit"] == recall
    assert result.summary["unknown named with P > 0.8"] == named


def test_score_keeps_cases_with_and_without_repeats_apart(
    drawn: Drawn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    fake_reports(monkeypatch, drawn.sealed, right=True)
    run(drawn.cases, tmp_path / "reports", progress=False)
    shutil.copytree(drawn.sealed, tmp_path / "truth")
    truth = tmp_path / "truth" / "case-001.toml"
    truth.write_text(truth.read_text().replace("repeats = true", "repeats = false"))
    parts = score(tmp_path / "truth", tmp_path / "reports").parts
    assert parts.loc["cases"].to_dict() == {"with repeats": 3, "without repeats": 1}


def test_run_needs_cases(tmp_path: Path):
    with pytest.raises(ValueError, match=r"dataset\.toml, found none"):
        run(tmp_path / "nothing", tmp_path / "out", progress=False)


def test_command_is_given_the_case_and_nothing_else():
    words = command(Path("cases/case-001"), Path("out/case-001"))
    assert words[1:] == ["-m", "tendonlab", "diagnose", "cases/case-001", "--out", "out/case-001", "--no-figures"]


def test_command_line_scores(drawn: Drawn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys):
    fake_reports(monkeypatch, drawn.sealed, right=True)
    parser = argparse.ArgumentParser()
    add_parser(parser.add_subparsers(dest="command", required=True))
    for words in (
        ["blind", "run", str(drawn.cases), "--out", str(tmp_path)],
        ["blind", "score", str(drawn.sealed), str(tmp_path), "--csv", str(tmp_path / "score.csv")],
    ):
        given = parser.parse_args(words)
        assert given.run(given) == 0
    assert "top1" in capsys.readouterr().out
    assert len(pd.read_csv(tmp_path / "score.csv")) == 4


def test_flow_of_the_documentation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys):
    """Its commands as written, on cases fewer and shorter than it draws, by a diagnosis that knows the answers."""

    def draw_less(seed: int, count: int, out: Path, **options: Any) -> Path:
        shorter = {"jobs": 1, "num_samples": 120, "step": 2e-4, "progress": False}
        return draw(seed, min(count, 2), out, **(options | shorter))

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(drawing, "draw", draw_less)
    lines = re.findall(r"^python -m tendonlab\.blind (.*)$", PAGE.read_text(encoding="utf-8"), re.M)
    assert [line.split()[0] for line in lines] == ["draw", "run", "score", "follow"]
    fake_reports(monkeypatch, Path(shlex.split(lines[2])[1]), right=True)
    for line in lines[:3]:  # no answer of these ends in a tie to follow
        monkeypatch.setattr(sys, "argv", ["blind", *shlex.split(line)])
        assert commands.main() == 0, capsys.readouterr().err
    assert re.search(r"verdict right +1\n", capsys.readouterr().out)


def test_refusal_is_one_line_and_exit_code_2(drawn: Drawn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys):
    (tmp_path / "answers.toml").write_bytes((drawn.sealed / "case-001.toml").read_bytes())
    monkeypatch.setattr(sys, "argv", ["blind", "run", str(drawn.cases), "--out", str(tmp_path)])
    assert commands.main() == 2
    assert capsys.readouterr().err.startswith(f"ValueError: {tmp_path / 'answers.toml'}: a sealed truth")


def test_strengths_bound_the_target_and_change_nothing_else() -> None:
    usual = draw_rig(np.random.default_rng(7), effect="joint:stribeck", kind="effect")
    strong = draw_rig(np.random.default_rng(7), effect="joint:stribeck", kind="effect", strengths=(3.0, 20.0))
    assert 3.0 <= strong.target <= 20.0
    assert np.log(strong.target / 3.0) / np.log(20.0 / 3.0) == pytest.approx(np.log(usual.target) / np.log(6.0))
    assert (strong.truth, strong.noise, strong.seed) == (usual.truth, usual.noise, usual.seed)
    assert {case.strengths for case in plan(3, 4, strengths=(3.0, 20.0))} == {(3.0, 20.0)}


@pytest.mark.parametrize("given", [(0.0, 2.0), (3.0, 1.0), (1.0, float("inf"))])
def test_strengths_that_are_no_range_are_refused(given: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match=rf"strengths = {given[0]}, {given[1]}: expected two numbers"):
        plan(3, 4, strengths=given)

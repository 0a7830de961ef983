"""Each command of the command line: what it prints, what it writes, and its exit code."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

import tendonlab as tl
from interrupting import small_tasks_and_ctrl_c
from tendonlab.checking.finding import Check, Finding
from tendonlab.cli import demo
from tendonlab.cli.commands import main
from tendonlab.cli.text import check_text
from twin import TwinDiagnosis

Printed = pytest.CaptureFixture[str]


def run(*arguments: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    """The command in a process of its own, as a user runs it."""
    command = [sys.executable, "-m", "tendonlab", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, encoding="utf-8", timeout=300, check=False)


def complaint(capsys: Printed) -> str:
    """The one line on stderr; nothing else may have been printed."""
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    return printed.err


def test_version(capsys: Printed) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out == f"tendonlab {tl.__version__}\n"


def test_systems_lists_every_kind_with_its_signals(capsys: Printed) -> None:
    assert main(["systems"]) == 0
    out = capsys.readouterr().out
    for kind in tl.kinds():
        info = tl.system_info(kind)
        assert f"{kind}: units of a rotary axis" in out.splitlines()
        assert all(
            f"- {signal.name} (" in out or f"- {signal.name}: " in out for signal in (*info.inputs, *info.outputs)
        )
    assert "- joint_inertia (kg·m²): " in out


@pytest.mark.parametrize(("axis", "unit"), [("rotary", "N·m"), ("linear", "N")])
def test_effects_lists_each_with_equation_source_and_units(capsys: Printed, axis: str, unit: str) -> None:
    assert main(["effects", "two_inertia", "--axis", axis]) == 0
    text = " ".join(capsys.readouterr().out.split())
    for effect in tl.system_info("two_inertia").effects:
        assert (effect.name in text) != effect.structural
        assert effect.structural or f"{effect.equation} [{effect.source}]" in text
    assert f"joint_static_excess ({unit}): static minus kinetic friction" in text
    assert "easily mistaken for motor:stribeck; what separates them: motion that loads the cable" in text


def test_systems_lists_the_kinds_that_are_named(capsys: Printed) -> None:
    assert main(["systems", "rigid_joint", "two_inertia"]) == 0
    headings = [line for line in capsys.readouterr().out.splitlines() if ": units of a rotary axis" in line]
    assert [heading.split(":")[0] for heading in headings] == ["rigid_joint", "two_inertia"]


def test_effects_without_a_system_lists_all(capsys: Printed) -> None:
    assert main(["effects"]) == 0
    out = capsys.readouterr().out
    assert all(f"{kind}: effects" in out for kind in tl.kinds())


def test_datasets_list_names_licence_and_citation(capsys: Printed) -> None:
    assert main(["datasets", "list"]) == 0
    out = capsys.readouterr().out
    assert "emps" in out
    assert "Licence:" in out
    assert "Cite:" in out


def test_simulate_compares_with_what_was_measured(capsys: Printed, tiny: Path, tmp_path: Path) -> None:
    file = tmp_path / "out.csv"
    assert main(["simulate", str(tiny), "--out", str(file)]) == 0
    out = capsys.readouterr().out
    assert "run-5 (test): 600 samples" in out
    assert "joint_angle" in out
    written = pd.read_csv(file, index_col="t")
    expected = tl.load(tiny).system().simulate(tl.load(tiny)["run-5"]).outputs
    pd.testing.assert_frame_equal(written, expected, rtol=1e-8)  # nine digits are written


def test_simulate_says_how_it_replays(capsys: Printed, tiny: Path) -> None:
    assert main(["simulate", str(tiny)]) == 0
    assert "Replayed from the logged command alone" in capsys.readouterr().out
    assert main(["simulate", str(demo.bundled())]) == 0
    assert "in the closed loop of the known controller" in capsys.readouterr().out


def test_simulate_prints_nothing_to_stderr(tiny: Path, tmp_path: Path) -> None:
    done = run("simulate", tiny, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "joint_angle" in done.stdout


def test_simulate_takes_values_and_effects(tiny: Path, tmp_path: Path) -> None:
    arguments = ["--experiment", "run-1", "--effects", "joint:stribeck", "--out", str(tmp_path / "out.csv")]
    values = ["coulomb=0.04", "joint_static_excess=0.02", "joint_stribeck_velocity=0.1"]
    assert main(["simulate", str(tiny), *arguments, "--set", *values]) == 0
    rig = tl.load(tiny)
    sim = rig.system().with_parameters({"coulomb": 0.04})
    sim = sim.with_effects({"joint:stribeck": {"static_excess": 0.02, "stribeck_velocity": 0.1}})
    written = pd.read_csv(tmp_path / "out.csv", index_col="t")
    pd.testing.assert_frame_equal(written, sim.simulate(rig["run-1"]).outputs, rtol=1e-8)


def test_sweep_takes_a_grid_or_a_table(capsys: Printed, tiny: Path, tmp_path: Path) -> None:
    assert (
        main(["sweep", str(tiny), "--grid", "inertia=0.4,0.5", "viscous=0.3:0.5:3", "--reduce", "rms", "--quiet"]) == 0
    )
    printed = capsys.readouterr()
    assert "6 runs, 0 failed" in printed.out
    assert printed.err == ""
    (tmp_path / "points.csv").write_text("inertia,viscous\n0.4,0.3\n0.5,0.4\n")
    table = ["--points", str(tmp_path / "points.csv"), "--out", str(tmp_path / "runs.zarr"), "--quiet"]
    assert main(["sweep", str(tiny), *table]) == 0
    assert "2 runs, 0 failed" in capsys.readouterr().out
    assert (tmp_path / "runs.zarr" / "joint_angle").is_dir()
    assert main(["sweep", str(tiny), "--grid", "inertia=0.4", "--reduce", "rms", "--quiet"]) == 0
    assert "1 run, 0 failed" in capsys.readouterr().out
    assert main(["sweep", str(tiny), "--grid", "inertia=much"]) == 2
    assert "--grid inertia=much: expected NAME=VALUE,VALUE,..." in capsys.readouterr().err


def test_identify_finds_the_parameters_and_prints_nothing_else(tiny: Path, tmp_path: Path) -> None:
    """The solver and its logging are guests: stderr stays empty."""
    done = run("identify", tiny, "--quiet", "--out", tmp_path / "fit.json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "viscous" in done.stdout
    json.loads((tmp_path / "fit.json").read_text(encoding="utf-8"))


def test_identify_adds_effects(capsys: Printed, tiny: Path) -> None:
    assert main(["identify", str(tiny), "--effects", "joint:stribeck", "actuation:offset"]) == 0
    out = capsys.readouterr().out
    assert "joint_static_excess" in out
    assert "actuation_offset" in out


@pytest.mark.cpu(10)
def test_diagnose_says_the_verdict_and_writes_the_report(tiny: Path, tmp_path: Path) -> None:
    """The tiny rig lacks nothing but good parameter values."""
    done = run("diagnose", tiny, "--out", "report", "--quiet", "--no-figures", "--seed", "3", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "noise floor" in done.stdout
    assert "report.html" in done.stdout
    assert {path.name for path in (tmp_path / "report").iterdir()} == {"report.html", "report.json"}
    report = json.loads((tmp_path / "report" / "report.json").read_text(encoding="utf-8"))
    assert (report["verdict"], report["seed"]) == ("parameters_only", 3)


def test_demo_names_the_missing_effect(twin_diagnosis: TwinDiagnosis) -> None:
    out = twin_diagnosis.folder / "tendonlab-demo"
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    assert (report["verdict"], report["selected"]) == ("effect", ["joint:stribeck"])
    assert "Stribeck friction at the joint" in twin_diagnosis.printed.stdout
    assert "tendonlab-demo/report.html" in twin_diagnosis.printed.stdout
    assert {path.name for path in out.iterdir() if path.suffix == ".png"} >= {"gap.png", "overlay.png", "where.png"}
    assert (out / "report.html").is_file()


def test_demo_prints_nothing_but_progress_to_stderr(twin_diagnosis: TwinDiagnosis) -> None:
    lines = twin_diagnosis.printed.stderr.splitlines()
    assert [line for line in lines if not re.fullmatch(r"(screen|refit) .*: \d+ of \d+ effects", line)] == []


def test_the_bundled_rig_comes_without_its_truth() -> None:
    folder = demo.bundled()
    assert tl.load(folder).name == "two_inertia"
    assert not (folder / "sealed.toml").exists()
    with pytest.raises(tl.DatasetError, match="'two-inertia': expected one of two_inertia"):
        demo.bundled("two-inertia")


def test_blind_is_among_the_commands(capsys: Printed, tmp_path: Path) -> None:
    assert main(["blind", "run", str(tmp_path / "nowhere"), "--out", str(tmp_path / "reports")]) == 2
    assert "nowhere" in complaint(capsys)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["diagnose", "{tiny}", "--library", "joint:glue"], "joint:glue"),
        (["diagnose", "nowhere"], "DatasetError: nowhere/dataset.toml: no such file"),
        (["identify", "{tiny}", "--effects", "joint:stribek"], "'joint:stribek' is no effect of rigid_joint; did"),
        (["simulate", "{tiny}", "--experiment", "run-9"], "no experiment 'run-9'"),
        (["simulate", "{tiny}", "--set", "coulomb=-1"], "coulomb = -1.0: expected a value in [0, inf) N*m"),
        (["simulate", "{tiny}", "--set", "coulomb"], "--set coulomb: expected NAME=VALUE with a number"),
        (["simulate", "{tiny}", "--effects", "joint:stribeck"], "joint_static_excess: missing"),
        (["simulate", "{tiny}", "--out", "{tiny}/absent/out.csv"], "absent/out.csv: cannot be written"),
        (["simulate", "{tiny}", "--out", "{tiny}"], "is a folder; expected the name of a file"),
        (["identify", "{tiny}", "--out", "{tiny}/absent/fit.json"], "absent/fit.json: cannot be written"),
        (["diagnose", "{tiny}", "--out", "{tiny}/run-1.csv"], "run-1.csv' is a file: expected a folder"),
        (["sweep", "{tiny}", "--grid", "inertia=0.4", "inertia=0.5"], "--grid inertia=0.5: duplicate name 'inertia'"),
        (["sweep", "{tiny}", "--points", "nofile.csv"], "nofile.csv: no such file; expected a CSV with one column per"),
        (["sweep", "{tiny}", "--points", "{tiny}"], ": is a folder; expected a CSV with one column per parameter"),
        (["datasets", "prepare", "emps", "--out", "{tiny}/run-1.csv"], "run-1.csv' is a file: expected a folder"),
        (["demo", "--out", "{tiny}/run-1.csv"], "run-1.csv' is a file: expected a folder"),
        (["diagnose", "emps"], "`tendonlab datasets prepare emps` fetches this recording"),
        (["systems", "rigid_join"], "did you mean 'rigid_joint'?"),
        (["effects", "two_inertial"], "did you mean 'two_inertia'?"),
        (["datasets", "prepare", "empd"], "'empd' is no public dataset"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_exit_code_2(
    capsys: Printed, tiny: Path, arguments: list[str], told: str
) -> None:
    assert main([argument.format(tiny=tiny) for argument in arguments]) == 2
    printed = capsys.readouterr()
    assert printed.err.startswith("tendonlab: ")
    assert printed.err.count("\n") == 1
    assert told in printed.err


@pytest.mark.parametrize(
    ("arguments", "told"), [([], "tendonlab demo"), (["datasets"], "prepare"), (["blind"], "draw")]
)
def test_a_command_without_a_verb_is_explained(capsys: Printed, arguments: list[str], told: str) -> None:
    assert main(arguments) == 0
    printed = capsys.readouterr()
    assert printed.out.startswith("usage: tendonlab")
    assert told in printed.out
    assert printed.err == ""


def test_a_wrong_command_line_is_exit_code_2(capsys: Printed) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["diagnoze", "here"])
    assert ended.value.code == 2
    assert "diagnoze" in capsys.readouterr().err


def test_ctrl_c_is_one_line_and_exit_code_130(capsys: Printed, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(path: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("tendonlab.data.load", interrupted)
    assert main(["simulate", "anything"]) == 130
    assert complaint(capsys) == "tendonlab: interrupted\n"


@pytest.mark.parametrize("kept", [True, False])
def test_a_sweep_that_is_interrupted_says_what_is_kept_and_ends_with_130(
    capsys: Printed, monkeypatch: pytest.MonkeyPatch, tiny: Path, tmp_path: Path, kept: bool
) -> None:
    """Chunks of a point; Ctrl-C arrives after the second of six runs."""
    out = tmp_path / "runs.zarr"
    command = ["sweep", str(tiny), "--grid", "inertia=0.4:0.5:6", "--quiet", *(["--out", str(out)] if kept else [])]

    with small_tasks_and_ctrl_c(monkeypatch, after=2):
        assert main(command) == 130
    printed = capsys.readouterr()
    left = int(re.findall(r"6 runs, 0 failed, (\d) interrupted", printed.out)[0])
    resumed = f"stored in {out}; the same command does the rest" if kept else "done, none stored: --out FOLDER stores"
    assert f"tendonlab: interrupted; {6 - left} of 6 runs {resumed}" in printed.err
    assert main(command) == 0
    assert "6 runs, 0 failed\n" in capsys.readouterr().out


def test_a_reader_that_leaves_is_no_error(tmp_path: Path) -> None:
    command = f"{sys.executable} -m tendonlab effects | head -n 1"
    done = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, encoding="utf-8", check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_terminal_without_the_letters_still_gets_the_answer(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tendonlab", "effects", "rigid_joint"]
    plain = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(command, cwd=tmp_path, env=plain, capture_output=True, encoding="ascii", check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert "coulomb (N?m): kinetic friction" in done.stdout


def test_a_seed_that_is_none_is_refused_before_the_work(capsys: Printed, tiny: Path) -> None:
    assert main(["diagnose", str(tiny), "--seed", "-1"]) == 2
    assert "seed = -1: expected a whole number of at least 0" in complaint(capsys)


def test_check_says_what_reading_the_logs_assumed() -> None:
    found = Check(dataset="rig", findings=())
    assert "Assumed" not in check_text(found)
    assert "Assumed\n  - inputs that were not logged are taken as 0" in check_text(
        found, ["inputs that were not logged are taken as 0"]
    )


def test_check_says_once_what_experiments_share() -> None:
    def gap(experiment: str, detail: str = "2 gaps in time") -> Finding:
        return Finding(problem="sampling", detail=detail, experiment=experiment)

    text = check_text(Check(dataset="rig", findings=(gap("a"), gap("b", "3 gaps in time"), gap("c"), gap("d"))))
    assert "  - sampling (a; alike in c, d): 2 gaps in time\n  - sampling (b): 3 gaps in time" in text


def test_check_prints_what_it_found_and_writes_it(tmp_path: Path, capsys: Printed) -> None:
    file = tmp_path / "check.json"
    assert main(["check", "data/two_inertia", "--out", str(file)]) == 0
    assert capsys.readouterr().out.startswith("two_inertia: Nothing in the logs forbids a diagnosis.")
    assert json.loads(file.read_text())["blocks"] is False

"""`tendonlab rehearse` as a user types it, with a stubbed diagnosis."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.cli.commands import main
from tendonlab.rehearsal import rehearse as module
from tendonlab.report.diagnosis import Diagnosis

PLAN = """
format = "tendonlab-plan/1"
rate = 100
[[experiments]]
name = "slow"
shape = "slow_reversals"
amplitude = 0.4
speed = 0.3
duration = 4
[[experiments]]
name = "chirp"
shape = "chirp"
amplitude = 0.3
frequencies = [0.2, 1]
duration = 4
split = "test"
""".replace("speed", 'split = "train"\nspeed')
FEW = ["--effects", "load:offset", "--sizes", "0.5", "5", "--repeats-per-size", "1", "--jobs", "1", "--quiet"]


@pytest.fixture
def stubbed(monkeypatch: pytest.MonkeyPatch, stub: Callable[[tl.Dataset], Diagnosis]) -> None:
    def diagnose(dataset: tl.Dataset, **_: Any) -> Diagnosis:
        return stub(dataset)

    monkeypatch.setattr(module, "library_diagnose", diagnose)


@pytest.mark.cpu(15)
@pytest.mark.usefixtures("stubbed")
def test_the_answers_are_printed_and_the_page_is_written(
    pendulum: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["rehearse", str(pendulum), *FEW, "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert "4 simulated rigs were diagnosed." in printed
    assert "Constant disturbance on the load" in printed
    assert "the library's own laws" in printed
    assert (tmp_path / "rehearsal.html").is_file()


@pytest.mark.cpu(15)
@pytest.mark.usefixtures("stubbed")
def test_a_plan_needs_no_logs(planned: Path, capsys: pytest.CaptureFixture[str]) -> None:
    still = (
        '[[experiments]]\nname = "still"\nshape = "steps"\namplitude = 0.1\nhold = 9\nduration = 4\nsplit = "train"\n'
    )
    (planned / "plan.toml").write_text(PLAN + still, encoding="utf-8")
    assert main(["rehearse", str(planned), "--plan", str(planned / "plan.toml"), *FEW]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "the stated controller drives the rigs along the reference" in printed
    assert "The planned experiment still never moves: reference_angle = 0 rad throughout." in printed


@pytest.mark.cpu(15)
def test_ctrl_c_says_what_is_kept_and_ends_with_130(
    pendulum: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    stub: Callable[[tl.Dataset], Diagnosis],
) -> None:
    calls: list[str] = []

    def diagnose(dataset: tl.Dataset, **_: Any) -> Diagnosis:
        calls.append(dataset.name)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return stub(dataset)

    monkeypatch.setattr(module, "library_diagnose", diagnose)
    assert main(["rehearse", str(pendulum), *FEW, "--out", str(tmp_path)]) == 130
    kept = f"tendonlab: interrupted; 2 of 4 rigs stored in {tmp_path}; the same command does the rest\n"
    printed = capsys.readouterr()
    assert printed.err == kept
    said = " ".join(printed.out.split())  # lines break where the path lets them
    assert "2 simulated rigs were diagnosed; 2 were left out because the rehearsal was interrupted" in said
    assert main(["rehearse", str(pendulum), *FEW, "--out", str(tmp_path)]) == 0


def test_without_a_plan_logs_are_needed(planned: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["rehearse", str(planned), *FEW]) == 2
    assert "key experiments: is missing" in capsys.readouterr().err

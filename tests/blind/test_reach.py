"""The runner refuses to give a verdict while the answers lie where the diagnosis could read them."""

from __future__ import annotations

import errno
import json
import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from sealed_cases import Drawn

from tendonlab.blind import reach, run, runner, score
from tendonlab.blind.twin import make_twin


@pytest.fixture
def rig(drawn: Drawn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder study/cases with nothing else near it; cases that are diagnosed all the same fail at once."""
    shutil.copytree(drawn.cases, tmp_path / "study" / "cases")
    script = "raise SystemExit('diagnosed')"
    monkeypatch.setattr(runner, "command", lambda case, out: [sys.executable, "-c", script])
    return tmp_path


def refused(rig: Path, found: Path) -> None:
    """`run` names the file and diagnoses nothing."""
    with pytest.raises(ValueError, match="a sealed truth, where the diagnosis could read it") as error:
        run(rig / "study" / "cases", rig / "reports", progress=False)
    assert str(error.value).startswith(f"{found}: ")
    assert "move it away" in str(error.value)
    assert not list(rig.glob("reports/*/log.txt"))


def runs(rig: Path) -> None:
    verdicts = json.loads(run(rig / "study" / "cases", rig / "reports", progress=False).read_text(encoding="utf-8"))
    assert {entry["message"] for entry in verdicts["reports"].values()} == {"exit 1: diagnosed"}


PLACES = [
    "study/sealed/case-001.toml",  # where `draw` puts it by itself
    "study/case-001.toml",
    "study/answers.txt",
    "study/old/2/3/4/5/6/7/notes",
    "study/.hidden/answers.toml",
    "study/cases/answers.toml",
    "study/cases/case-002/extra/run-11.csv",
    "reports/answers.toml",
    "reports/case-001/.answers",
]


@pytest.mark.parametrize("place", PLACES)
def test_a_drawn_truth_is_found_under_any_name(drawn: Drawn, rig: Path, place: str) -> None:
    (rig / place).parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(drawn.sealed / "case-001.toml", rig / place)
    refused(rig, rig / place)
    (rig / place).rename(rig / "answers")  # two folders up is out of reach
    runs(rig)


def test_what_is_called_sealed_is_not_opened_but_refused(rig: Path) -> None:
    """An archive says nothing of what it holds."""
    (rig / "study" / "Sealed.zip").write_bytes(b"PK")
    refused(rig, rig / "study" / "Sealed.zip")


def test_a_link_to_the_truth_is_followed(drawn: Drawn, rig: Path) -> None:
    (rig / "study" / "more").symlink_to(drawn.sealed, target_is_directory=True)
    refused(rig, rig / "study" / "more" / "case-001.toml")


def test_links_that_go_round_end(rig: Path) -> None:
    (rig / "study" / "again").symlink_to(rig / "study", target_is_directory=True)
    (rig / "study" / "itself").symlink_to("itself")
    (rig / "study" / "gone").symlink_to("nowhere")
    os.mkfifo(rig / "study" / "pipe")  # whoever opened it would wait for ever
    runs(rig)


@pytest.mark.parametrize("name", ["score.csv", "score.json"])
def test_a_score_tells_the_truth_too(drawn: Drawn, rig: Path, name: str) -> None:
    runs(rig)
    result = score(drawn.sealed, rig / "reports")
    found = rig / "study" / name
    result.cases.to_csv(found) if name == "score.csv" else found.write_text(json.dumps(result.to_dict(), indent=1))
    with pytest.raises(ValueError, match=name):
        run(rig / "study" / "cases", rig / "reports", progress=False)


def test_the_truth_of_the_bundled_twin_is_one(rig: Path) -> None:
    twin = make_twin(rig / "study" / "twin", num_samples=100, step=2e-4)
    (twin / "sealed.toml").rename(twin / "rest.toml")
    refused(rig, twin / "rest.toml")


def test_more_than_can_be_looked_through_is_refused(rig: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is left out in silence."""
    count = len(list((rig / "study").rglob("*")))
    monkeypatch.setattr(reach, "MOST_ENTRIES", count)
    runs(rig)
    monkeypatch.setattr(reach, "MOST_ENTRIES", count - 1)
    with pytest.raises(ValueError, match=f"study: more than {count - 1} files and folders.* in a folder of their own"):
        run(rig / "study" / "cases", rig / "reports", progress=False)


@pytest.mark.parametrize("can_be_entered", [False, True])
def test_closed_folders(drawn: Drawn, rig: Path, monkeypatch: pytest.MonkeyPatch, can_be_entered: bool) -> None:
    """One that cannot be listed hides nothing from who knows the names, if it can be entered.

    Told by stand-ins for the system's answers, since nothing is closed to root.
    """
    closed = rig / "study" / "closed"
    shutil.copytree(drawn.sealed, closed)
    listed = Path.iterdir

    def iterdir(folder: Path) -> Iterator[Path]:
        if folder == closed:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(folder))
        return listed(folder)

    monkeypatch.setattr(Path, "iterdir", iterdir)
    monkeypatch.setattr(os, "access", lambda path, mode: can_be_entered)
    if can_be_entered:
        with pytest.raises(PermissionError, match="closed"):
            reach.refuse_truth(rig / "study")
    else:
        reach.refuse_truth(rig / "study")

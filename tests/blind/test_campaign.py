"""From drawing to the map by one command, with a diagnosis that knows the answers in place of the real one."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from tendonlab.blind import campaign as module
from tendonlab.blind import commands, runner
from tendonlab.blind.campaign import JOURNAL, campaign
from tendonlab.blind.drawing import draw
from tendonlab.blind.runner import REPORT, VERDICTS
from tendonlab.blind.scoring import truth_of

SEEDS = (40_000_001, 70_000_001)
STAGES = ["draw calibration", "run calibration", "draw test", "run test", "fit", "page"]
RIGID = {"system": "rigid_joint", "faults": 0.0}


def knowing(sealed: Path) -> Callable[[Path, Path], Sequence[str]]:
    """Commands that write a right report."""

    def command(case: Path, out: Path) -> Sequence[str]:
        truth = truth_of(sealed / case.parents[1].name, case.name)
        verdict, there = truth["verdict"], dict.fromkeys(truth["effects"], 0.9)
        evidence = {"verdict": {"no_gap": 0.05, "effect": 0.05, verdict: 0.9}, "effects": {"a:b": 0.1, **there}}
        effects = [dict(zip(("element", "effect"), name.split(":"), strict=True), probability=0.9) for name in there]
        report = {
            "verdict": verdict, "selected": list(there), "effects": effects, "seconds": 1.0,
            "details": {"evidence": evidence, "mean_square": {"refitted": 9.0}}, "split": {"train": ["a", "b"]},
        }  # fmt: skip
        return [sys.executable, "-c", f"open({str(out / REPORT)!r}, 'w').write({json.dumps(report)!r})"]

    return command


@pytest.fixture
def sealed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Folder of the truths; short records, and a diagnosis that knows them."""

    def draw_short(seed: int, count: int, out: Path, **options: Any) -> Path:
        return draw(seed, count, out, **(options | {"jobs": 1, "num_samples": 60, "step": 1e-3}))

    monkeypatch.setattr(module, "draw", draw_short)
    monkeypatch.setattr(runner, "command", knowing(tmp_path / "sealed"))
    return tmp_path / "sealed"


def made(out: Path, sealed: Path, **options: Any) -> list[module.Stage]:
    usual: dict[str, Any] = {"seeds": SEEDS, "counts": (2, 2), "changed": RIGID, "jobs": 2, "progress": False}
    return list(campaign(out, sealed=sealed, **(usual | options)))


def test_one_command_leads_from_the_protocol_to_the_map(
    sealed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["campaign", "out", "--sealed", str(sealed), "--seeds", *map(str, SEEDS), "--counts", "2", "2"]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", ["blind", *words, "--system", "rigid_joint", "--faults", "0"])
    assert commands.main() == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in lines] == [*STAGES, "all"]
    content = json.loads((tmp_path / "out" / "calibration.json").read_text(encoding="utf-8"))
    assert content["series"]["fitted on"] == ["seed-40000001"]
    assert content["series"]["tested on"] == ["seed-70000001"]
    assert sum(content[part]["fitted on"]["rigid_joint"] for part in ("with repeats", "without repeats")) >= 2
    page = (tmp_path / "out" / "blind-results.md").read_text(encoding="utf-8")
    assert "tendonlab blind campaign out --sealed" in page
    assert page.startswith("# Blind results\n\n2 rigs.")
    truths = [truth_of(sealed / f"seed-{seed}", "case-001")["protocol"] for seed in SEEDS]
    assert [(of["purpose"], of["changed"]) for of in truths] == [
        ("calibration", ["faults", "system"]), ("test", ["faults", "system"]),
    ]  # fmt: skip


def test_an_interrupted_campaign_goes_on_where_it_stopped(
    sealed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was done is not touched again; of the stage that was interrupted the cases that are done stay."""
    out, run = tmp_path / "out", module.run

    def killed(cases: Path, reports: Path, **options: Any) -> Path:
        if "7000" in str(cases):
            raise KeyboardInterrupt
        return run(cases, reports, **options)

    monkeypatch.setattr(module, "run", killed)
    with pytest.raises(KeyboardInterrupt):
        made(out, sealed)
    first = out / "seed-40000001" / "reports" / VERDICTS
    truth = sealed / "seed-70000001" / "case-001.toml"
    before = [path.stat().st_mtime_ns for path in (first, truth)]
    monkeypatch.setattr(module, "run", run)
    stages = made(out, sealed)
    assert [stage.name for stage in stages] == STAGES
    assert [stage.was_done for stage in stages] == [True, True, True, False, False, False]
    assert [path.stat().st_mtime_ns for path in (first, truth)] == before
    again = made(out, sealed)
    assert [stage.was_done for stage in again] == [True, True, True, True, False, False]
    assert again[0].seconds == stages[0].seconds > 0.0


def test_a_campaign_of_other_settings_is_refused(sealed: Path, tmp_path: Path) -> None:
    """Before anything is drawn: seeds of another purpose, truths within reach, and another count than it began with."""
    out = tmp_path / "out"
    with pytest.raises(ValueError, match="seed = 70000001: expected one from 40000000 to 69999999"):
        made(out, sealed, seeds=SEEDS[::-1])
    for within in (out / "sealed", out, tmp_path):
        with pytest.raises(ValueError, match="expected a folder apart from"):
            made(out, within)
    assert not out.exists()
    sealed.mkdir()
    settings = {"counts": [2, 2], "seeds": list(SEEDS)}
    module.Journal(sealed / JOURNAL, settings)._save()
    with pytest.raises(ValueError, match=r"counts = \[2, 3\]: expected \[2, 2\], with which this was begun"):
        module.Journal.open(sealed / JOURNAL, settings | {"counts": [2, 3]}, out)


def test_another_time_limit_is_another_campaign(sealed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module.Journal, "through", lambda self, work: self._save() or iter(()))
    made(tmp_path / "out", sealed, timeout=60.0)
    made(tmp_path / "out", sealed, timeout=60.0, changed=RIGID | {"pairs": 0.25})  # as the protocol has it
    with pytest.raises(ValueError, match=r"timeout = 90\.0: expected 60\.0, with which this was begun"):
        made(tmp_path / "out", sealed, timeout=90.0)


def test_reports_are_not_scored_against_other_truths(sealed: Path, tmp_path: Path) -> None:
    """Where the journal is gone, or the truths of a series are, nothing is drawn over the cases."""
    out = tmp_path / "out"
    (out / "seed-40000001" / "cases").mkdir(parents=True)
    with pytest.raises(ValueError, match=r"campaign.json is missing: expected it beside the truths of .*seed-40000001"):
        made(out, sealed)
    assert not sealed.exists()


def test_the_test_series_is_told_on_request(sealed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Once more with the missing effects as the library, into the folder of the truths."""
    asked: list[tuple[Path, ...]] = []
    monkeypatch.setattr(module, "tell", lambda *folders, **_: asked.append(folders))
    monkeypatch.setattr(module, "_page", lambda *_, **options: asked.append((options["tells"],)))
    assert [stage.name for stage in made(tmp_path / "out", sealed, tells=True)] == [
        *STAGES[:4],
        "tell test",
        *STAGES[4:],
    ]
    cases = tmp_path / "out" / "seed-70000001" / "cases"
    assert asked == [(sealed / "seed-70000001", cases, sealed / "told-70000001"), (True,)]

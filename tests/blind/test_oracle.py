"""What a diagnosis reaches that is told the effects, beside what was reached without."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from blind.sealed_cases import Drawn
from tendonlab.blind import oracle
from tendonlab.blind.oracle import shares_of_oracle, tell
from tendonlab.blind.runner import REPORT
from tendonlab.blind.scoring import truth_of


def report(with_effect: float, *, refitted: float = 5.0, floor: float = 1.0) -> dict[str, object]:
    angle = {"noise_floor": floor, "nominal": 9.0, "refitted": refitted, "with_effect": with_effect}
    return {"verdict": "effect", "gap": {"joint_angle": angle}}


REFUSED: dict[str, object] = {  # as a fault of the data: nothing was fitted
    "verdict": "data_fault",
    "gap": {"joint_angle": {"noise_floor": 1.0, "nominal": 9.0, "refitted": None, "with_effect": None}},
}


def write(folder: Path, **reports: dict[str, object]) -> Path:
    for name, of in reports.items():
        (folder / name).mkdir(parents=True)
        (folder / name / REPORT).write_text(json.dumps(of), encoding="utf-8")
    return folder


def test_shares_are_of_what_the_told_diagnosis_reached_over_its_floor(tmp_path: Path) -> None:
    best = report(1.0)
    told = write(tmp_path / "told", same=best, half=best, none=best, crash=best, hopeless=report(6.0))
    write(told, refused=best, both_refused=REFUSED)
    half = (1.0 + 0.25 * 24.0) ** 0.5  # gap: sqrt(rms² - 1), half of sqrt(24)
    own = {"same": report(1.0, floor=0.5), "half": report(half), "none": report(5.0), "hopeless": report(1.0)}
    own |= {"refused": REFUSED, "both_refused": REFUSED}
    shares = shares_of_oracle(write(tmp_path / "reports", **own), told)
    assert shares.to_dict() == pytest.approx({"same": 1.0, "half": 0.5, "none": 0.0, "crash": 0.0, "refused": 0.0})


def test_only_cases_that_lack_known_effects_are_told(
    drawn: Drawn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The command gets the missing effects as its library, and nothing else of the truth."""

    def noted(case: Path, out: Path) -> Sequence[str]:
        script = "import json, pathlib, sys; pathlib.Path(sys.argv[1]).write_text(json.dumps(sys.argv[2:]))"
        return [sys.executable, "-c", script, str(out / REPORT)]

    monkeypatch.setattr(oracle, "command", noted)
    out = tell(drawn.sealed, drawn.cases, tmp_path / "told", progress=False)
    truths = {case.name: truth_of(drawn.sealed, case.name) for case in drawn.cases.iterdir()}
    expected = {name: ["--library", *of["effects"]] for name, of in truths.items() if of["verdict"] == "effect"}
    found = {path.parent.name: json.loads(path.read_text()) for path in out.glob(f"*/{REPORT}")}
    assert found == expected
    assert 0 < len(found) < len(truths)


def test_reports_that_tell_the_truth_stay_away_from_the_cases(drawn: Drawn) -> None:
    with pytest.raises(ValueError, match="these reports tell the truth; expected a folder outside"):
        tell(drawn.sealed, drawn.cases, drawn.cases.parent / "told", progress=False)

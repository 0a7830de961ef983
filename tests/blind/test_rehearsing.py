"""What a rehearsal predicts of drawn rigs, beside what becomes of them: with a made-up rehearsal and diagnosis."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from rehearsal.stubs import says
from tendonlab.blind import rehearsing, runner
from tendonlab.blind.comparing import answer_of, compare
from tendonlab.blind.reach import refuse_truth
from tendonlab.blind.rehearsing import Designs, amount, amplitude_of, comparable, rehearse

DESIGNS = Designs(seed=31090, fastest=100.0, repeats=1.0, num_samples=120, step=2e-4, sizes=(0.3, 3.0))
OFFSET, BRISTLE = "load:offset", "joint:presliding"
AMOUNTS = {OFFSET: ("load_offset", (0.02, 0.2)), BRISTLE: ("joint_bristle_stiffness", (400.0, 40.0))}
COUNTS = (0, 8)  # of 8 rigs, at the small and at the large size


def rehearsal(command: Sequence[str], **_: object) -> subprocess.CompletedProcess[str]:
    """In place of `tendonlab rehearse`."""
    out = Path(command[command.index("--out") + 1])
    out.mkdir()
    entries = []
    for effect, (parameter, amounts) in AMOUNTS.items():
        rows = zip(DESIGNS.sizes, amounts, COUNTS, strict=True)
        sizes = [{"gap": gap, "amount": size, "found": found, "tried": 8} for gap, size, found in rows]
        entries.append({"effect": effect, "parameter": parameter, "sizes": sizes})
    (out / "rehearsal.json").write_text(json.dumps({"effects": entries}))
    return subprocess.CompletedProcess(command, 0, "", "")


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """One design, of which the diagnosis finds the offsets alone."""
    sealed, out = tmp_path_factory.mktemp("apart"), tmp_path_factory.mktemp("designs")

    def diagnosis(case: Path, folder: Path) -> list[str]:
        (effect,) = tomllib.loads((sealed / "design-001" / f"{case.name}.toml").read_text())["effects"]
        text = json.dumps(says(OFFSET if effect == OFFSET else None).to_dict())
        return [sys.executable, "-c", f"open({str(folder / 'report.json')!r}, 'w').write({text!r})"]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rehearsing.subprocess, "run", rehearsal)
        patch.setattr(rehearsing, "run", lambda *args, **options: None)
        rehearse(DESIGNS, 1, out, sealed=sealed, progress=False)
    with pytest.MonkeyPatch.context() as patch:  # goes on where it stopped, without another rehearsal
        patch.setattr(runner, "command", diagnosis)
        rehearse(DESIGNS, 1, out, sealed=sealed, progress=False)
    return sealed, out


def test_each_effect_is_missing_at_the_sizes_of_its_rehearsal(folders: tuple[Path, Path]) -> None:
    truths = [tomllib.loads(path.read_text()) for path in sorted((folders[0] / "design-001").glob("*.toml"))]
    found = {(t["effects"][0], round(abs(t["truth"][AMOUNTS[t["effects"][0]][0]]), 4)) for t in truths}
    assert found == {(effect, size) for effect, (_, sizes) in AMOUNTS.items() for size in sizes}
    assert len(truths) == 4
    assert all(t["draw"]["is_documented_form"] for t in truths)
    assert all(t["draw"]["target"] == t["draw"]["gap_noise"] > 0.0 for t in truths)


def test_the_rigs_are_the_same_recorded_anew(folders: tuple[Path, Path]) -> None:
    design = folders[1] / "design-001"
    texts = [tomllib.loads((f / "dataset.toml").read_text()) for f in (design / "rig", *(design / "cases").iterdir())]
    assert len(texts) == 5
    assert all(text | {"name": ""} == texts[0] | {"name": ""} for text in texts)
    truths = [tomllib.loads(path.read_text())["truth"] for path in (folders[0] / "design-001").iterdir()]
    assert len({truth["inertia"] for truth in truths}) == 1
    tables = [pd.read_csv(f / "run-01.csv") for f in (design / "rig", *(design / "cases").iterdir())]
    noise = [np.diff(table["q"], 4) for table in tables]  # of motion that is smooth
    assert max(abs(np.corrcoef(noise)[np.triu_indices(5, 1)])) < 0.9


def test_the_cases_do_not_tell_the_truth(folders: tuple[Path, Path]) -> None:
    refuse_truth(folders[1])
    for within in (folders[1] / "truth", folders[1].parent):
        with pytest.raises(ValueError, match="the diagnosis could read the truths there"):
            rehearse(DESIGNS, 1, folders[1], sealed=within, progress=False)


def test_another_call_takes_no_folder_of_other_settings(folders: tuple[Path, Path]) -> None:
    with pytest.raises(ValueError, match=r"settings.json: seed = 1: expected 31090, with which this was begun"):
        rehearse(replace(DESIGNS, seed=1), 1, folders[1], sealed=folders[0], progress=False)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"system": "bowden"}, "system = 'bowden': expected one of two_inertia"),
        ({"seed": -1}, "seed = -1: expected at least 0"),
        ({"repeats": 1.5}, r"repeats = 1\.5: expected a share from 0 to 1"),
        ({"num_effects": 0}, "num_effects = 0: expected at least 1"),
        ({"rehearsed": 0}, "rehearsed = 0: expected at least 1"),
        ({"realised": -1}, "realised = -1: expected at least 1"),
        ({"step": 0.0}, r"step = 0\.0: expected a number above 0"),
        ({"sizes": ()}, r"sizes = \(\): expected numbers above 0 that rise"),
        ({"sizes": (0.0, 1.0)}, r"sizes = \(0\.0, 1\.0\): expected numbers above 0 that rise"),
        ({"sizes": (3.0, 1.0)}, r"sizes = \(3\.0, 1\.0\): expected numbers above 0 that rise"),
        ({"fastest": 1.0}, "fastest = 1 Hz: expected at least 100 Hz"),
    ],
)
def test_designs_that_cannot_be_drawn_are_refused_before_anything_is_written(
    wrong: dict[str, object], message: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=message):
        rehearse(replace(DESIGNS, **wrong), 1, tmp_path / "out", sealed=tmp_path / "truth", progress=False)  # type: ignore[arg-type]
    assert not (tmp_path / "out").exists()


def test_a_failed_rehearsal_leaves_its_design_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    failed = subprocess.CompletedProcess([], 2, "", "DatasetError: too short\n")
    monkeypatch.setattr(rehearsing.subprocess, "run", lambda *args, **options: failed)
    rehearse(DESIGNS, 1, tmp_path / "out", sealed=tmp_path / "truth", progress=False)
    assert "design-001 is left out: DatasetError: too short" in capsys.readouterr().err
    with pytest.raises(ValueError, match="expected a complete design, found none"):
        compare([(tmp_path / "truth", tmp_path / "out")])


def test_effects_are_compared_by_one_parameter_that_both_have(folders: tuple[Path, Path]) -> None:
    rig = DESIGNS.draw(0)
    known = comparable(rig, tl.load(folders[1] / "design-001" / "rig"))
    assert {OFFSET, BRISTLE, "joint:stribeck", "actuation:delay"} <= set(known)
    assert not {"joint:asymmetry", "joint:coulomb"} & set(known)  # two amplitudes; in the simulator
    for effect, (parameter, sizes) in AMOUNTS.items():
        lacking = replace(rig, effect=effect)
        amplitudes = [amplitude_of(lacking, parameter, size) for size in sizes]
        assert [amount(lacking, parameter, at) for at in amplitudes] == pytest.approx(sizes)
        assert amplitudes[0] < amplitudes[1]  # a softer bristle is a larger effect


def test_predicted_and_realised_shares(folders: tuple[Path, Path]) -> None:
    """Half is predicted, by symmetry of the counts; half is found, all offsets and no bristle."""
    result = compare([folders])
    (pooled,) = result.pooled.to_dict(orient="records")
    assert (pooled["rehearsed"], pooled["realised"], pooled["realised %"]) == ("16 of 32", "2 of 4", 50.0)
    assert pooled["realised 95 %"] == "7 to 93"
    assert pooled["predicted %"] == pytest.approx(50.0, abs=0.1)
    assert result.mean == pytest.approx(0.0, abs=0.1)
    assert result.effects["realised %"].to_dict() == {BRISTLE: 0.0, OFFSET: 100.0}
    assert result.effects["points"].to_dict() == pytest.approx({BRISTLE: 50.0, OFFSET: -50.0}, abs=0.1)
    assert result.repeats["realised"].to_dict() == {True: "2 of 4"}
    assert result.sizes["predicted %"].loc[0.3] < 15 < 85 < result.sizes["predicted %"].loc[3.0]
    assert "predicted less realised, over 1 design: " in str(result)
    assert result.to_dict()["format"] == "tendonlab-score/1"  # a diagnosis must not read it


def test_a_case_without_a_report_was_not_found(folders: tuple[Path, Path], tmp_path: Path) -> None:
    out = Path(shutil.copytree(folders[1], tmp_path / "out"))
    file = out / "design-001" / "reports" / "verdicts.json"
    told = json.loads(file.read_text())
    told["reports"] = {name: {"verdict": "failed"} for name in told["reports"]}
    file.write_text(json.dumps(told))
    assert compare([(folders[0], out)]).pooled["realised"].tolist() == ["0 of 4"]


@pytest.mark.parametrize("lost", ["design-001/case-002.toml", "design-001"])
def test_a_missing_truth_is_named(folders: tuple[Path, Path], tmp_path: Path, lost: str) -> None:
    """Of a case, and of a design: neither is left out in silence."""
    sealed = Path(shutil.copytree(folders[0], tmp_path / "truth"))
    (sealed / lost).rename(tmp_path / "lost")
    with pytest.raises(ValueError, match=r"truth/design-001/case-00\d\.toml is missing: expected the truth of"):
        compare([(sealed, folders[1])])


def test_a_report_is_judged_as_the_diagnosis_it_was() -> None:
    why = says(OFFSET, others=(BRISTLE,), group=(OFFSET, BRISTLE))
    read = answer_of(json.loads(json.dumps(why.to_dict())))
    assert (read.verdict, list(read.selected), [e.name for e in read.effects]) == (
        "effect",
        [OFFSET],
        [OFFSET, BRISTLE],
    )

"""The page of several blind series: what it counts, on truths and reports that are stated here."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path
from typing import Any

import pytest

from tendonlab.blind.commands import main
from tendonlab.blind.oracle import shares_of_oracle
from tendonlab.blind.results import Results, results
from tendonlab.blind.results_page import PAGE, write
from tendonlab.blind.runner import REPORT, VERDICTS
from tendonlab.diagnosis.answer.calibration import shipped_content

EFFECTS = ("joint:stribeck", "joint:presliding", "load:offset")


def truth(verdict: str, *effects: str, gap: float, repeats: bool = False, cause: str = "", own: bool = True) -> Any:
    draw = {"system": "rigid_joint", "gap_noise": gap, "repeats": repeats, "is_documented_form": own}
    named = {"cause": cause} if cause else {}
    return {"verdict": verdict, "effects": list(effects), "accept": [], "draw": {**draw, **named}}


def report(
    verdict: str, *selected: str, probability: float = 0.9, tied: tuple[str, ...] = (), left: float = 1.0
) -> Any:
    ranked = [*selected, *(name for name in EFFECTS if name not in selected)]
    chances = {name: probability if name in selected else 0.02 for name in ranked}
    entries = [
        {"element": name.partition(":")[0], "effect": name.partition(":")[2], "probability": p, "parameters": {}}
        for name, p in chances.items()
    ]
    evidence = {"verdict": {"effect": 0.1, "unknown_effect": 0.05, verdict: 0.85}, "effects": chances}
    shrunk = {"from_refitted": {"value": 0.97 if selected else None}}
    return {
        "verdict": verdict, "selected": list(selected), "effects": entries, "indistinguishable": [list(tied)],
        "gap": {"joint_angle": {"noise_floor": 1.0, "refitted": 9.0, "with_effect": left}},
        "shrinkage": shrunk, "details": {"evidence": evidence, "mean_square": {"refitted": 9.0}},
        "split": {"train": ["a", "b"]}, "seconds": 1.0,
    }  # fmt: skip


SERIES: dict[str, tuple[Any, Any]] = {
    "strong": (truth("effect", "joint:stribeck", gap=8.0), report("effect", "joint:stribeck")),
    "beside": (truth("effect", "joint:stribeck", gap=4.0), report("effect", "joint:stribeck", "load:offset")),
    "partly": (
        truth("effect", "joint:stribeck", gap=5.0, own=False),
        report("unknown_effect", "joint:stribeck", left=3.0),
    ),
    "weak": (truth("effect", "load:offset", gap=1.5), report("effect", "joint:stribeck", tied=EFFECTS)),
    "nothing": (truth("no_gap", gap=0.0), report("no_gap")),
    "alarm": (truth("parameters_only", gap=0.0), report("effect", "load:offset")),
    "creeps": (truth("unknown_effect", gap=6.0, repeats=True, cause="creep"), report("unknown_effect")),
    "fools": (truth("unknown_effect", gap=2.0, repeats=True, cause="stop"), report("effect", "load:offset")),
    "crash": (truth("unknown_effect", gap=9.0, repeats=True, cause="creep"), None),
}


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    sealed, reports = tmp_path / "seed-1", tmp_path / "reports"
    sealed.mkdir()
    told = {}
    for name, (true, given) in SERIES.items():
        lines = ['format = "tendonlab-sealed/1"', f'verdict = "{true["verdict"]}"']
        lines += [f"{key} = {json.dumps(true[key])}" for key in ("effects", "accept")]
        lines += ["[draw]", *(f"{key} = {json.dumps(value)}" for key, value in true["draw"].items())]
        (sealed / f"{name}.toml").write_text("\n".join(lines), encoding="utf-8")
        if given is None:
            told[name] = {"verdict": "failed"}
            continue
        (reports / name).mkdir(parents=True)
        text = json.dumps(given)
        (reports / name / REPORT).write_text(text, encoding="utf-8")
        told[name] = {"verdict": given["verdict"], "sha256": hashlib.sha256(text.encode()).hexdigest()}
    (reports / VERDICTS).write_text(json.dumps({"reports": told}), encoding="utf-8")
    return sealed, reports


def rewrite(reports: Path, name: str, given: Any) -> None:
    """Another report on a case, hashed as if it had been written at once."""
    (reports / name / REPORT).write_text(json.dumps(given), encoding="utf-8")
    content = json.loads((reports / VERDICTS).read_text(encoding="utf-8"))
    digest = hashlib.sha256((reports / name / REPORT).read_bytes()).hexdigest()
    content["reports"][name] = {"verdict": given["verdict"], "sha256": digest}
    (reports / VERDICTS).write_text(json.dumps(content), encoding="utf-8")


@pytest.fixture
def found(folders: tuple[Path, Path]) -> Results:
    return results([folders])


def test_each_share_counts_the_cases_that_it_concerns(found: Results) -> None:
    counts = {q: [(one.hits, one.num) for one in both] for q, both in found.shares().items()}
    assert counts["single effect established, nothing beside it, gap/noise ≥ 3"] == [(2, 3), (0, 0)]
    assert counts["the same, gap/noise 1–3"] == [(0, 1), (0, 0)]
    assert counts["ranked first, gap/noise ≥ 1"] == [(3, 4), (0, 0)]
    assert counts["an effect named where none is missing"] == [(1, 2), (0, 0)]
    assert counts["unknown cause found, gap/noise ≥ 3"] == [(0, 0), (1, 2)]  # a crash is wrong
    assert counts["unknown cause found, gap/noise 1–3"] == [(0, 0), (0, 1)]
    assert counts["unknown cause reported as an effect with P > 0.8"] == [(0, 0), (2, 3)]
    assert counts["verdict right"] == [(4, 6), (1, 3)]
    assert "pair: both established" not in counts  # none was drawn


def test_the_effect_of_a_group_of_three_counts_a_third(found: Results) -> None:
    of = found.means()["ranked first, a group of at most three counted as 1/size, gap/noise ≥ 1"][0]
    assert (of.mean, of.num) == (pytest.approx((3 + 1 / 3) / 4), 4)
    assert of.ci95 == pytest.approx((0.5, 1.0))  # of the samples of four rigs 5 % hold the one third thrice or more


def test_effects_that_were_reported_in_place_of_the_true_one_are_counted(
    folders: tuple[Path, Path], found: Results
) -> None:
    """Right first effects are left out; where nothing is reported, the verdict takes the place."""
    assert found.confused_effects() == {"load:offset": (1, {"joint:stribeck": 1})}
    sealed, reports = folders
    verdicts = json.loads((reports / VERDICTS).read_text(encoding="utf-8"))
    verdicts["reports"]["beside"] = {"verdict": "failed"}
    (reports / VERDICTS).write_text(json.dumps(verdicts), encoding="utf-8")
    again = results([(sealed, reports)]).confused_effects()
    assert again["joint:stribeck"] == (3, {"failed": 1})


def test_an_effect_that_nobody_reported_stands_in_no_place(folders: tuple[Path, Path]) -> None:
    """Of a report that selects nothing the verdict counts, whichever effect it ranks first; a right effect that was
    selected stands in nobody's place."""
    rewrite(folders[1], "weak", report("no_gap"))
    given = report("effect", "joint:stribeck")
    given["effects"][1]["probability"] = 0.95  # not selected
    rewrite(folders[1], "strong", given)
    assert results([folders]).confused_effects() == {"load:offset": (1, {"no_gap": 1})}


def test_another_map_changes_the_probabilities_and_the_page_says_so(folders: tuple[Path, Path], tmp_path: Path) -> None:
    content = shipped_content()
    even = {"temperature": 1.0, "lapse": 0.5}
    for part in ("with repeats", "without repeats"):
        content[part] = content[part] | {"map": {"verdicts": even, "effects": even}}
    path = tmp_path / "calibration.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    pages = []
    for name, of in (("shipped", None), ("own", path)):
        write(results([folders], map_file=of), tmp_path / name, "tendonlab blind results")
        pages.append((tmp_path / name / PAGE).read_text(encoding="utf-8"))
    assert "of the shipped map are" in pages[0]
    assert "of the fitted map are" in pages[1]
    rows = [next(line for line in page.splitlines() if line.startswith("| all, without")) for page in pages]
    stated = [float(row.split("|")[3].split(";")[1]) for row in rows]
    assert stated[1] < stated[0] - 0.1


def test_a_map_that_was_confirmed_elsewhere_is_still_the_shipped_one(
    folders: tuple[Path, Path], tmp_path: Path
) -> None:
    content = shipped_content()
    content["with repeats"] = content["with repeats"] | {"confirmed": [], "least runs": 99}
    (tmp_path / "calibration.json").write_text(json.dumps(content | {"tendonlab": "x"}), encoding="utf-8")
    assert results([folders], map_file=tmp_path / "calibration.json").map_is_shipped


@pytest.mark.parametrize(
    ("text", "message"),
    [('{"format": "a/1"}', "format = 'a/1': expected"), ("[]", "format = None"), ("a", "Expecting")],
)
def test_a_file_that_is_no_map_is_named(folders: tuple[Path, Path], tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "own.json").write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=rf"/own\.json: {message}"):
        results([folders], map_file=tmp_path / "own.json")


def test_misses_are_those_whose_strictest_check_fails(found: Results) -> None:
    """A right effect of another form is no miss where something is left over; a right one with a wrong one is."""
    names = [name.partition("/")[2] for name in found.misses().index]
    assert names == ["crash", "beside", "fools", "weak", "alarm"]


def test_the_page_holds_tables_figures_and_misses(folders: tuple[Path, Path], tmp_path: Path) -> None:
    out = tmp_path / "docs"
    page = write(results([folders]), out, "tendonlab blind results")
    assert page == out / PAGE
    text = page.read_text(encoding="utf-8")
    assert "| verdict right | 4 of 6 (22–96 %) | 1 of 3 (1–91 %) |" in text
    assert "| load:offset | 1 of 1: joint:stribeck 1 |" in text
    assert re.search(r"\| probability of the true effect.* \| 0\.\d\d \(0\.\d\d–0\.\d\d; of 4 rigs\) \| – \|", text)
    assert re.search(r"\| all, without repeats \| 6 \|.*; −?0\.\d+ \(−0\.\d+ to 0\.\d+\);", text)
    assert "| seed-1/crash | rigid_joint | yes | creep | 9 | failed | – |" in text
    for name in ("blind-reliability", "blind-strength"):
        assert (out / "figures" / f"{name}.svg").is_file()
        assert f"figures/{name}.svg" in text


def told(folder: Path, *names: str) -> Path:
    """A folder of diagnoses that were told the effects, which shrank the whole gap of these cases."""
    best = {"verdict": "effect", "gap": {"joint_angle": {"noise_floor": 1.0, "refitted": 9.0, "with_effect": 1.0}}}
    for name in names:
        store(folder / name / REPORT, best)
    return folder


def store(path: Path, content: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content), encoding="utf-8")


def shrunk(found: Results) -> list[tuple[int, int]]:
    """Of how many rigs the gap shrank as far as it could, and how many there are: without and with repeats."""
    counted = next(both for quantity, both in found.shares().items() if quantity.startswith("held-out gap shrunk"))
    return [(one.hits, one.num) for one in counted]


def test_the_gap_shrank_as_far_as_where_the_effects_were_told(folders: tuple[Path, Path], tmp_path: Path) -> None:
    """All cases but one shrink the gap as far as it goes; of the one that is not told nothing is known."""
    sealed, reports = folders
    best = told(tmp_path / "told", "strong", "beside", "partly")
    assert shrunk(results([folders], [(sealed, best)])) == [(2, 3), (0, 0)]
    with pytest.raises(ValueError, match="expected the truths of one of the series"):
        results([folders], [(reports, best)])


def test_logs_that_were_refused_shrink_no_gap(folders: tuple[Path, Path], tmp_path: Path) -> None:
    """Refused by the diagnosis, its gap stays; refused by the one that was told as well, nothing could shrink."""
    _, reports = folders
    best = told(tmp_path / "told", "strong", "beside")
    refused = {"verdict": "data_fault", "gap": {}}
    store(reports / "strong" / REPORT, refused)
    assert shares_of_oracle(reports, best).to_dict() == {"strong": 0.0, "beside": 1.0}
    store(best / "strong" / REPORT, refused)
    assert shares_of_oracle(reports, best).to_dict() == {"beside": 1.0}


def test_the_command_takes_several_series(
    folders: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    own = tmp_path / "my map.json"
    own.write_text(json.dumps(shipped_content()), encoding="utf-8")
    pair = ["--on", *map(str, folders)]
    monkeypatch.setattr(
        "sys.argv", ["blind", "results", *pair, *pair, "--map", str(own), "--out", str(tmp_path / "out")]
    )
    assert main() == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "out" / PAGE)
    text = (tmp_path / "out" / PAGE).read_text(encoding="utf-8")
    assert "18 rigs" in text
    assert f"--map '{own}' --out {tmp_path / 'out'}\n" in text  # as a shell reads it


def test_no_series_is_an_error() -> None:
    with pytest.raises(ValueError, match="no series: expected at least one"):
        results([])

"""Ties that one more experiment can settle: what is one, and how many were settled."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tendonlab.blind.commands import main
from tendonlab.blind.runner import REPORT, VERDICTS, sha256
from tendonlab.blind.ties import Settlement, settled, tie_of

MOTION = {"description": "slowly", "separates": ["a:b", "c:d"], "expected_gain": 40.0, "reference": "next-1.csv"}


def report(
    probabilities: dict[str, float], *groups: list[str], proposed: dict[str, Any] | None = None
) -> dict[str, Any]:
    effects = [
        {"element": name.partition(":")[0], "effect": name.partition(":")[2], "probability": p}
        for name, p in probabilities.items()
    ]
    words = {"verdict": "effect", "selected": [next(iter(probabilities))], "indistinguishable": [*groups]}
    return words | {"effects": effects, "next_experiments": [MOTION | (proposed or {})]}


@pytest.mark.parametrize(
    "given",
    [
        report({"a:b": 0.5, "c:d": 0.4}, ["a:b", "c:d"]),
        report({"a:b": 0.6, "c:d": 0.3}),  # both are open, though no group
    ],
)
def test_two_open_effects_that_an_experiment_separates_are_a_tie(given: dict[str, Any]) -> None:
    tie = tie_of(given)
    assert tie is not None
    assert (tie.effects, tie.promised) == ({"a:b", "c:d"}, 40.0)


@pytest.mark.parametrize(
    "given",
    [
        report({"a:b": 0.9, "c:d": 0.05}),  # decided
        report({"a:b": 0.45, "e:f": 0.45, "c:d": 0.05}, ["a:b", "e:f"]),  # a:b or its twin, but not c:d
        report({"a:b": 0.5, "c:d": 0.001}),  # something unknown is there, but c:d is not
        report({"a:b": 0.6, "c:d": 0.3}, proposed={"expected_gain": 9.0}),
        report({"a:b": 0.6, "c:d": 0.3}, proposed={"separates": ["a:b"]}),  # an effect or nothing
        report({"a:b": 0.6, "c:d": 0.3}, proposed={"separates": ["joint_position", "time"]}),
        report({"a:b": 0.6, "c:d": 0.3}, proposed={"reference": None}),
    ],
)
def test_what_is_decided_or_cannot_be_separated_is_no_tie(given: dict[str, Any]) -> None:
    assert tie_of(given) is None


def test_the_first_experiment_with_a_reference_counts() -> None:
    given = report({"a:b": 0.6, "c:d": 0.3})
    words = {"description": "ask", "separates": ["a:b", "e:f"], "expected_gain": None}
    given["next_experiments"] = [words, *given["next_experiments"]]
    tie = tie_of(given)
    assert tie is not None
    assert tie.effects == {"a:b", "c:d"}


TIED = report({"a:b": 0.5, "c:d": 0.4}, ["a:b", "c:d"])


def written(
    folder: Path, reports: dict[str, dict[str, Any]], truths: dict[str, str], first: dict[str, Any] = TIED
) -> tuple[Path, Path, Path]:
    """Truths, the `first` report with a tie on every case, and the new `reports`."""
    sealed, before, after = folder / "truth", folder / "before", folder / "after"
    sealed.mkdir(parents=True)
    for name, effects in truths.items():
        drawn = '[draw]\nsystem = "rigid_joint"\nis_documented_form = false'
        text = f'format = "tendonlab-sealed/1"\nverdict = "effect"\n{effects}\n{drawn}\n'
        (sealed / f"{name}.toml").write_text(text, encoding="utf-8")
    for where, told in ((before, dict.fromkeys(truths, first)), (after, reports)):
        verdicts = {}
        for name, words in told.items():
            (where / name).mkdir(parents=True)
            (where / name / REPORT).write_text(json.dumps(words), encoding="utf-8")
            verdicts[name] = {"verdict": "effect", "sha256": sha256(where / name / REPORT)}
        (where / VERDICTS).write_text(json.dumps({"reports": verdicts}), encoding="utf-8")
    return sealed, before, after


def counted(folder: Path, new: dict[str, Any], truth: str = 'effects = ["a:b"]') -> Settlement:
    return settled(*written(folder, {"case-001": new}, {"case-001": truth}))


@pytest.mark.parametrize(
    ("new", "outcome"),
    [
        (report({"a:b": 0.95, "c:d": 0.02}), "settled"),
        (report({"a:b": 0.45, "e:f": 0.45, "c:d": 0.02}, ["a:b", "e:f"]), "settled"),  # from c:d, not from its twin
        (report({"a:b": 0.7, "c:d": 0.2}), "settled"),  # established: the group is gone, and a:b selected
        (report({"a:b": 0.45}) | {"verdict": "unknown_effect"}, "settled"),  # in another form than the library's
        (report({"a:b": 0.7, "c:d": 0.2}) | {"selected": []}, "open"),
        (report({"a:b": 0.7, "c:d": 0.2}) | {"selected": ["a:b", "c:d"]}, "open"),
        (report({"a:b": 0.7, "c:d": 0.2}, ["a:b", "c:d"]), "open"),
        (report({"a:b": 0.9, "c:d": 0.9}, ["a:b", "c:d"]), "open"),
        (report({"a:b": 0.9, "c:d": 0.9}), "wrong"),  # the right one, and one that is not there
        (report({"c:d": 0.95, "a:b": 0.01}), "wrong"),
        (report({"x:y": 0.95}), "open"),
    ],
)
def test_a_tie_is_settled_where_the_right_effect_alone_is_sure(
    new: dict[str, Any], outcome: str, tmp_path: Path
) -> None:
    result = counted(tmp_path, new)
    assert list(result.ties["outcome"]) == [outcome]
    assert result.settled == (outcome == "settled")


@pytest.mark.parametrize(
    ("truth", "counts"),
    [
        ('effects = ["x:y"]', False),
        ('effects = ["x:y"]\naccept = ["a:b"]', False),  # close in the first logs only
        ('effects = ["a:b"]\naccept = ["c:d"]', True),
        ('effects = ["a:b", "c:d"]', False),
    ],
)
def test_ties_of_which_one_effect_is_right_count(truth: str, counts: bool, tmp_path: Path) -> None:
    result = counted(tmp_path, report({"a:b": 0.95}), truth)
    assert (len(result.ties), result.others) == ((1, 0) if counts else (0, 1))


@pytest.mark.parametrize("twin", ["actuation:offset", "load:offset"])
def test_an_exact_twin_of_what_is_missing_is_right(twin: str, tmp_path: Path) -> None:
    """The bias is close to the offset in the first logs, and the new ones are to tell it."""
    names = {"a:b": twin, "c:d": "sensor.joint_angle:bias"}
    truth = 'effects = ["load:offset"]\naccept = ["actuation:offset", "sensor.joint_angle:bias"]'
    new = report({"actuation:offset": 0.45, "load:offset": 0.45}, ["actuation:offset", "load:offset"])
    where = written(tmp_path, {"case-001": new}, {"case-001": truth})
    path = where[1] / "case-001" / REPORT
    text = path.read_text(encoding="utf-8")
    for old, name in names.items():
        text = text.replace(f'"{old}"', f'"{name}"')
        parts = [f'"element": "{one[0]}", "effect": "{one[2]}"' for one in (old.partition(":"), name.partition(":"))]
        text = text.replace(*parts)
    path.write_text(text, encoding="utf-8")
    (where[1] / VERDICTS).write_text(
        json.dumps({"reports": {"case-001": {"verdict": "effect", "sha256": sha256(path)}}}), encoding="utf-8"
    )
    result = settled(*where)
    assert list(result.ties["right"]) == [twin]
    assert list(result.ties["outcome"]) == ["settled"]


def test_what_was_established_before_asks_for_more(tmp_path: Path) -> None:
    """The tie of two effects that are no group: the first report had selected the right one already."""
    first, truths = report({"a:b": 0.7, "c:d": 0.2}), {"case-001": 'effects = ["a:b"]'}
    for p, outcome in ((0.75, "open"), (0.85, "settled")):
        sealed, before, after = written(tmp_path / outcome, {"case-001": report({"a:b": p, "c:d": 0.1})}, truths, first)
        assert list(settled(sealed, before, after).ties["outcome"]) == [outcome]


def test_a_case_without_a_new_report_is_open(tmp_path: Path) -> None:
    truths = {"case-001": 'effects = ["a:b"]'}
    sealed, before, after = written(tmp_path, {"case-001": report({"a:b": 0.95})}, truths)
    (after / VERDICTS).write_text(json.dumps({"reports": {"case-001": {"verdict": "failed"}}}), encoding="utf-8")
    assert list(settled(sealed, before, after).ties["outcome"]) == ["open"]


def test_cases_without_a_tie_are_an_error(tmp_path: Path) -> None:
    sealed, _, after = written(tmp_path, {"case-001": report({"a:b": 0.95})}, {"case-001": 'effects = ["a:b"]'})
    with pytest.raises(ValueError, match=r"expected reports with a tie on the cases of .*, found none"):
        settled(sealed, after, after)


def test_the_command_prints_the_share_with_an_interval(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    truths = {f"case-00{i}": 'effects = ["a:b"]' for i in (1, 2, 3, 4)}
    sure, still = report({"a:b": 0.95}), TIED
    where = written(tmp_path, dict(zip(truths, (sure, sure, sure, still), strict=True)), truths)
    out = tmp_path / "ties.json"
    monkeypatch.setattr("sys.argv", ["blind", "settled", *map(str, where), "--json", str(out)])
    assert main() == 0
    assert "ties settled: 3 of 4 (95 % interval 19 to 99 %)" in capsys.readouterr().out
    told = json.loads(out.read_text(encoding="utf-8"))
    assert (told["settled"], told["ties"], len(told["cases"])) == (3, 4, 4)
    assert told["ci95"] == pytest.approx([0.1941, 0.9937], abs=1e-4)  # Clopper-Pearson, from tables

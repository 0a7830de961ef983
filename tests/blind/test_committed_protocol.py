"""The protocol that is shipped: what it draws, what it refuses, and what the truths say of it."""

from __future__ import annotations

import hashlib
import re
import tomllib
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tendonlab.blind import commands, drawing
from tendonlab.blind.drawing import draw
from tendonlab.blind.planning import Wanted, plan
from tendonlab.blind.protocol import FILE, listed_of, read
from tendonlab.blind.rig import draw_rig, forms_of
from tendonlab.blind.strength import Strength
from tendonlab.blind.systems import RIGID_JOINT, SYSTEMS

SEED = 70_000_001
TEXT = (files("tendonlab.blind") / FILE).read_text(encoding="utf-8")
SHORT = {"jobs": 1, "num_samples": 120, "step": 5e-4, "progress": False}


def standard(count: int) -> list[Wanted]:
    options = read().drawn(SEED, purpose="test")
    return plan(SEED, count, **{name: value for name, value in options.items() if name != "origin"})


def written(folder: Path, old: str = "", new: str = "") -> Path:
    """The standard protocol with one passage changed."""
    assert old in TEXT
    path = folder / "own.toml"
    path.write_text(TEXT.replace(old, new, 1), encoding="utf-8")
    return path


def can(case: Wanted) -> bool:
    return len(forms_of(SYSTEMS[case.system], case.effect)) > 1


def test_the_standard_protocol_draws_the_shares_that_it_states() -> None:
    cases = standard(600)
    assert {kind: [case.system for case in cases].count(kind) for kind in SYSTEMS} == dict.fromkeys(SYSTEMS, 100)
    kinds = [case.kind for case in cases]
    assert [kinds.count(kind) for kind in ("unknown", "effect", "none", "parameters_only")] == [120, 336, 72, 72]
    assert sum(case.has_repeats for case in cases) == 200
    assert sum(case.has_fault for case in cases) == 30
    pairs = [case for case in cases if case.is_pair]
    hidden = [case for case in pairs if (case.strengths, case.second) == ((20.0, 100.0), (0.5, 5.0))]
    assert (len(pairs), len(hidden)) == (84, 34)
    assert {(case.strengths, case.second) for case in cases if case not in hidden} == {((0.5, 100.0), (0.5, 100.0))}


def test_half_of_the_single_effects_have_another_form_though_many_have_none() -> None:
    single = [case for case in standard(600) if case.kind == "effect" and not case.is_pair]
    able = [np.mean([len(forms_of(of, effect)) > 1 for effect in of.effects]) for of in SYSTEMS.values()]
    assert np.mean(able) == pytest.approx(0.58, abs=0.005)  # as the page says
    assert sum(bool(case.is_other_form) for case in single) == len(single) // 2
    assert all(can(case) for case in single if case.is_other_form)


def test_the_form_that_is_wanted_changes_nothing_else_of_a_rig() -> None:
    made = [
        draw_rig(
            np.random.default_rng(3), effect="joint:stribeck", kind="effect", system=RIGID_JOINT, is_other_form=other
        )
        for other in (None, False, True)
    ]
    assert [rig.form for rig in made[1:]] == [0, 1]
    as_drawn, *chosen = (replace(rig, form=0, experiments=()) for rig in made)
    assert chosen == [as_drawn, as_drawn]


def test_rigs_are_drawn_again_as_often_as_the_rule_says(monkeypatch: pytest.MonkeyPatch) -> None:
    """An effect that is never strong enough gives way to the next one after `tries` rigs."""
    strength = Strength(
        amplitude=1.0, gap_noise=0.1, nominal_gap_noise=1.0, floor=np.ones(1), limited=True, met=False, separation={}
    )

    def tuned(rigs: dict[int, Any]) -> dict[int, Any]:
        return {
            i: (rig, [replace(strength, met=rig.effect == "joint:viscous" or rig.kind != "effect")])
            for i, rig in rigs.items()
        }

    monkeypatch.setattr(drawing, "tuned", tuned)
    case = Wanted(system="rigid_joint", kind="effect", effect="joint:coulomb", has_repeats=False, tries=2)
    (settled,) = drawing.settle([(0, case)], seed=1, num_samples=50)
    assert settled.redrawn == ["joint:coulomb"] * 2
    assert settled.rig.effect == "joint:viscous"


def test_seeds_of_another_purpose_are_refused() -> None:
    with pytest.raises(ValueError, match="seed = 7: expected one from 70000000 to 99999999, which serve test"):
        read().drawn(7, purpose="test")
    with pytest.raises(ValueError, match="purpose = 'tests': expected one of development, calibration, test"):
        read().drawn(SEED, purpose="tests")
    with pytest.raises(ValueError, match=r"seed = 100000000: expected one from 0 to 39999999 \(development\), "):
        read().drawn(100_000_000)


@pytest.mark.parametrize(("seed", "purpose"), [(7, "development"), (40_000_000, "calibration"), (99_999_999, "test")])
def test_a_seed_serves_its_purpose_also_where_none_is_given(seed: int, purpose: str) -> None:
    """Else cases of a test seed could be fitted."""
    assert read().drawn(seed)["origin"]["purpose"] == purpose


@pytest.mark.parametrize("name", ["strengths", "second"])
def test_other_strengths_are_those_of_all_pairs(name: str) -> None:
    """The strong and the weak ones of the protocol give way, and the truth says so."""
    options = read().drawn(SEED, changed={name: (2.0, 4.0)})
    assert options.pop("origin")["changed"] == ["dominant", name]
    usual = {"strengths": (0.5, 100.0), "second": (2.0, 4.0)} | {name: (2.0, 4.0)}
    pairs = [case for case in plan(SEED, 300, **options) if case.is_pair]
    assert {(case.strengths, case.second) for case in pairs} == {(usual["strengths"], usual["second"])}
    assert read().drawn(SEED, changed={"strengths": (0.5, 100.0)})["dominant"] == 0.4
    assert read().drawn(SEED, changed={name: (2.0, 4.0), "dominant": 0.2})["dominant"] == 0.2


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("tendonlab-protocol/1", "tendonlab-protocol/2", "format = 'tendonlab-protocol/2'"),
        ("pairs = 0.25", "pairs = 1.25", "pairs = 1.25: expected a share"),
        ("pairs = 0.25", "couples = 0.25", r"draw\.couples = 0\.25: expected one of system, "),
        ("met_within = 0.18", "met_within = 0.1", "met_within = 0.1: expected more than 0.12"),
        ("[40_000_000", "[30_000_000", "seeds 30000000 to 39999999 serve development and calibration"),
        ("test = [70", "trial = [70", "expected those of development, calibration, test"),
        ('"lorentzian"', '"cauchy"', r"rigs\.two_inertia\.forms = .*'cauchy'.*: expected what this generator draws"),
        ("nothing_share = 0.15", "nothing_share = 0.5", "expected at most 1"),
        ("[draw]", "[drawn]", r"drawn = .*: expected one of format, version, draw"),
        ("[rigs.ccsrm]", "[rigs.ccsr]", r"rigs\.ccsr = .*: expected one of two_inertia, "),
        (
            "[rigs.ccsrm]\nsample_times",
            "[rigs.ccsrm]\nperiods",
            r"rigs\.ccsrm\.periods = \[0\.01, 0\.004\]: expected one of",
        ),
        ("strengths = [0.5, 100.0]", "strengths = [0.5]", r"draw\.strengths = \[0\.5\]: expected two numbers"),
        ("pairs = 0.25", 'pairs = "a"', "draw.pairs = 'a': expected a number"),
        ("pairs = 0.25", "pairs = true", "draw.pairs = True: expected a number"),
        ("tries = 3", "tries = 2.5", "draw.tries = 2.5: expected a whole number"),
        ('system = "mixed"', "system = 1", "draw.system = 1: expected a text"),
        ("version = 1", "version = 1.5", "version = 1.5: expected a whole number"),
        ("69_999_999]", "69_999_999.5]", r"seeds\.calibration = \[40000000, 69999999\.5\]: expected two whole numbers"),
        ("pairs = 0.25", "pairs = ", "Invalid value"),
    ],
)
def test_a_protocol_that_contradicts_itself_or_the_generator_is_refused(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=rf"^{re.escape(str(tmp_path))}/own.toml: .*{message}"):
        read(written(tmp_path, old, new))


def test_the_protocol_lists_every_form_of_the_generator_and_its_changes() -> None:
    given = tomllib.loads(TEXT)
    assert given["rigs"] == {kind: listed_of(kind) for kind in SYSTEMS}
    dates = [change["date"] for change in given["changes"]]
    assert dates == sorted(dates)
    assert f"Version {given['version']}" in given["changes"][-1]["what"]


def test_a_truth_says_by_which_protocol_it_was_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The options of the command line change the protocol, and the truth names them."""

    def draw_short(seed: int, count: int, out: Path, **options: Any) -> Path:
        return draw(seed, count, out, **(options | SHORT))

    monkeypatch.setattr(drawing, "draw", draw_short)
    words = ["--seed", str(SEED), "--count", "1", "--protocol", "standard", "--purpose", "test", "--faults", "0.05"]
    out = ["draw", str(tmp_path / "a"), "--sealed", str(tmp_path / "b"), "--system", "rigid_joint"]
    monkeypatch.setattr("sys.argv", ["blind", *out, *words])
    assert commands.main() == 0
    truth = tomllib.loads((tmp_path / "b" / "case-001.toml").read_text(encoding="utf-8"))
    sha256 = hashlib.sha256(TEXT.encode()).hexdigest()
    assert truth["protocol"] == {"version": 1, "sha256": sha256, "purpose": "test", "changed": ["system"]}
    assert truth["draw"]["system"] == "rigid_joint"
    assert 0.4 < truth["draw"]["target"] < 100.0


def test_a_purpose_needs_a_protocol(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    monkeypatch.setattr("sys.argv", ["blind", "draw", str(tmp_path / "a"), "--purpose", "test"])
    assert commands.main() == 2
    assert "--purpose test: expected a --protocol" in capsys.readouterr().err
    assert not (tmp_path / "a").exists()


def test_an_interrupted_draw_goes_on_with_the_same_bits(tmp_path: Path) -> None:
    """A case whose truth is missing is written again, also where its logs were begun; the others stay untouched."""
    options = {"system": "rigid_joint", **SHORT}
    where = [(tmp_path / name, tmp_path / f"{name}-sealed") for name in ("whole", "broken")]
    for out, sealed in where:
        draw(3, 3, out, sealed=sealed, **options)
    (whole, truths), (broken, rest) = where
    (rest / "case-002.toml").unlink()
    (broken / "cases" / "case-002" / "run-10.csv").unlink()
    kept = (rest / "case-001.toml").stat().st_mtime_ns
    draw(3, 3, broken, sealed=rest, resumes=True, **options)
    assert (rest / "case-001.toml").stat().st_mtime_ns == kept
    for one, other in ((whole, broken), (truths, rest)):
        assert contents(one) == contents(other)
    with pytest.raises(FileExistsError, match="expected a new folder"):
        draw(3, 3, broken, sealed=rest, **options)
    with pytest.raises(FileExistsError, match="cases exists: expected a new folder"):
        draw(3, 3, broken, sealed=tmp_path / "elsewhere", resumes=True, **options)
    assert contents(whole) == contents(broken)


def contents(folder: Path) -> dict[str, str]:
    return {str(p.relative_to(folder)): p.read_text("utf-8") for p in sorted(folder.rglob("*")) if p.is_file()}

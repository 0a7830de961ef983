"""Series that hold given effects only, or one kind of excitation."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import pytest

from tendonlab.blind import commands
from tendonlab.blind.commands import add_parser
from tendonlab.blind.drawing import _rig
from tendonlab.blind.planning import plan
from tendonlab.blind.protocol import FORMAT, read

CHOSEN = ("joint:stribeck", "actuation:delay")


def options(*words: str) -> dict[str, Any]:
    parser = argparse.ArgumentParser()
    add_parser(parser.add_subparsers())
    return commands._drawn(parser.parse_args(["blind", "draw", "out", *words]))


def test_given_effects_go_round_in_turn() -> None:
    cases = plan(1, 20, system="rigid_joint", effects=CHOSEN)
    effects = [case.effect for case in cases if case.kind == "effect"]
    assert [effects.count(name) for name in CHOSEN] == [7, 7]
    assert [case.kind for case in cases].count("none") == 3


def test_each_kind_of_rig_lacks_those_that_it_has() -> None:
    chosen = ("motor:stribeck", "joint:viscous", "sheath:slack")
    cases = plan(1, 60, system="mixed", effects=chosen)
    assert {case.effect for case in cases if case.system == "two_inertia"} == {"motor:stribeck", "joint:viscous", ""}
    assert {case.effect for case in cases if case.system == "bowden_pair"} == {"sheath:slack", ""}


def test_effects_that_a_kind_of_rig_does_not_have_are_refused() -> None:
    with pytest.raises(ValueError, match="effects = motor:stribeck: expected some of a rigid_joint, joint:coulomb, "):
        plan(1, 4, system="rigid_joint", effects=("motor:stribeck",))
    with pytest.raises(ValueError, match="effects = motor:stribeck: expected some of a rigid_joint"):
        plan(1, 12, system="mixed", effects=("motor:stribeck",))


def test_one_kind_of_excitation_changes_the_motions_alone() -> None:
    usual, poor = (plan(1, 12, system="rigid_joint", excitation=kind) for kind in (None, "poor"))
    pairs = [tuple(_rig(i, case[i], seed=1, tries=0, num_samples=60) for case in (usual, poor)) for i in range(12)]
    assert {rig.excitation for rig, _ in pairs} == {"rich", "poor"}
    assert {rig.excitation for _, rig in pairs} == {"poor"}
    assert all((a.truth, a.effect, a.loop) == (b.truth, b.effect, b.loop) for a, b in pairs)
    with pytest.raises(ValueError, match="excitation = 'fair': expected one of rich, poor"):
        plan(1, 4, excitation="fair")


def test_on_the_command_line_all_rigs_lack_one_of_the_effects() -> None:
    drawn = options("--system", "rigid_joint", "--effects", *CHOSEN, "--excitation", "poor")
    cases = plan(1, 10, **drawn)
    assert {case.kind for case in cases} == {"effect"}
    assert {case.effect for case in cases} == set(CHOSEN)
    assert {case.excitation for case in cases} == {"poor"}
    assert not options().keys() & {"effects", "excitation", "effect_share"}


def test_a_truth_says_that_effects_were_chosen_against_the_protocol() -> None:
    drawn = options("--protocol", "standard", "--seed", "5", "--effects", *CHOSEN, "--unknown", "0")
    assert drawn["origin"]["changed"] == ["effect_share", "effects", "nothing_share", "unknown_share"]


def test_a_protocol_of_your_own_may_name_effects(tmp_path: Path) -> None:
    own = tmp_path / "own.toml"
    seeds = "[seeds]\ndevelopment = [0, 9]\ncalibration = [10, 19]\ntest = [20, 29]\n"
    own.write_text(
        f'format = "{FORMAT}"\nversion = 1\n[draw]\nsystem = "rigid_joint"\neffects = ["joint:stribeck"]\n{seeds}',
        encoding="utf-8",
    )
    assert read(own).options["effects"] == ("joint:stribeck",)
    own.write_text(own.read_text(encoding="utf-8").replace('["joint:stribeck"]', "[1]"), encoding="utf-8")
    with pytest.raises(ValueError, match=r"draw\.effects = \[1\]: expected a list of texts"):
        read(own)

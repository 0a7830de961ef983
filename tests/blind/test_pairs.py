"""Rigs that lack two effects."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.blind import draw
from tendonlab.blind.pairs import paired
from tendonlab.blind.planning import plan
from tendonlab.blind.rig import draw_rig, full_truth, nominal_effects, nominal_parameters
from tendonlab.blind.scoring import compared
from tendonlab.blind.systems import RIGID_JOINT


def test_a_second_effect_is_of_another_kind_and_no_rival() -> None:
    for seed in range(40):
        rig = draw_rig(np.random.default_rng(seed), effect="joint:stribeck", kind="effect", system=RIGID_JOINT)
        second = paired(rig, np.random.default_rng(seed), strengths=(1.0, 6.0)).second
        assert second not in ("joint:stribeck", *RIGID_JOINT.rivals["joint:stribeck"])
        assert "joint_velocity" in rig.outputs or "joint_velocity" not in second


def test_the_share_of_pairs_counts_cases_that_lack_an_effect() -> None:
    cases = plan(4, 40, system="rigid_joint", pairs=0.5)
    assert sum(case.is_pair for case in cases) == round(0.5 * sum(case.kind == "effect" for case in cases))
    assert all(case.kind == "effect" for case in cases if case.is_pair)
    with pytest.raises(ValueError, match=r"pairs = 1.5: expected a share from 0 to 1"):
        plan(4, 40, pairs=1.5)


def test_a_weak_effect_hides_behind_a_dominant_one(tmp_path: Path) -> None:
    """The second effect has strengths of its own; those of the first are as without it."""
    strengths = {"strengths": (20.0, 40.0), "second": (1.0, 3.0)}
    cases = plan(4, 10, system="rigid_joint", pairs=1.0, **strengths)
    assert {(case.strengths, case.second) for case in cases} == {((20.0, 40.0), (1.0, 3.0))}
    assert {case.second for case in plan(4, 10, strengths=(2.0, 9.0))} == {(2.0, 9.0)}
    with pytest.raises(ValueError, match=r"second = 3.0, 1.0: expected two numbers"):
        plan(4, 10, second=(3.0, 1.0))
    draw(
        6, 2, tmp_path, system="rigid_joint", pairs=1.0, jobs=1, num_samples=300, step=5e-4, progress=False, **strengths
    )
    truths = [tomllib.loads(path.read_text())["draw"] for path in sorted((tmp_path / "sealed").glob("*.toml"))]
    pairs = [truth for truth in truths if "second_gap_noise" in truth]
    assert pairs
    assert all(truth["second_gap_noise"] < 0.3 * truth["gap_noise"] for truth in pairs)


def test_both_effects_act_and_the_simulator_knows_neither(tmp_path: Path) -> None:
    draw(5, 2, tmp_path, system="rigid_joint", pairs=1.0, jobs=1, num_samples=200, step=5e-4, progress=False)
    truths = [tomllib.loads(path.read_text()) for path in sorted((tmp_path / "sealed").glob("*.toml"))]
    pairs = [truth for truth in truths if len(truth["effects"]) == 2]
    assert pairs
    for path, truth in zip(sorted((tmp_path / "cases").iterdir()), truths, strict=True):
        logs = tl.load(path)
        assert not set(truth["effects"]) & set(logs.nominal_effects)
        assert len(truth["effects"]) < 2 or truth["draw"]["second_gap_noise"] > 0.5


def test_parameters_of_a_pair_are_those_of_both() -> None:
    rig = draw_rig(np.random.default_rng(1), effect="joint:coulomb", kind="effect", system=RIGID_JOINT)
    both = replace(rig, second="joint:viscous", second_amplitude=0.5)
    truth = full_truth(both, 0.7)
    assert truth["joint_coulomb"] == pytest.approx(0.7 * rig.truth["joint_coulomb"])
    assert truth["joint_viscous"] == pytest.approx(0.5 * rig.truth["joint_viscous"])
    assert nominal_effects(both) == ()
    assert not {"joint_coulomb", "joint_viscous"} & set(nominal_parameters(both))


@pytest.mark.parametrize(
    ("selected", "verdict", "expected"),
    [
        (["a:b", "c:d"], "effect", (True, True, False)),
        (["a:b"], "unknown_effect", (False, True, False)),
        (["a:b", "x:y"], "effect", (False, True, True)),
        (["a:b", "c:d"], "parameters_only", (False, False, False)),
    ],
)
def test_a_pair_is_found_whole_or_in_part(selected: list[str], verdict: str, expected: tuple[bool, bool, bool]) -> None:
    report = {"verdict": verdict, "selected": selected, "effects": []}
    found = compared({"effects": ["a:b", "c:d"], "verdict": "effect"}, report)
    assert tuple(found[name] for name in ("pair_both", "pair_one", "pair_wrong")) == expected

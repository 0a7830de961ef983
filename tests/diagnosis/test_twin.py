"""The bundled rig, whose withheld effect is known, and the same rig with nothing withheld."""

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.blind.twin import make_twin
from tendonlab.cli.demo import bundled
from twin import TwinDiagnosis

DATA = Path(__file__).parents[2] / "data"


@pytest.fixture(scope="module")
def truth() -> dict[str, Any]:
    return tomllib.loads((DATA / "two_inertia" / "sealed.toml").read_text(encoding="utf-8"))


def test_the_withheld_effect_is_selected(twin_diagnosis: TwinDiagnosis, truth: dict[str, Any]) -> None:
    found = twin_diagnosis.diagnosis
    assert list(found.selected) == truth["effects"]
    assert found.verdict == truth["verdict"]
    assert found.effects[0].name == truth["effects"][0]


def test_parameters_of_the_effect_are_near_the_truth(twin_diagnosis: TwinDiagnosis, truth: dict[str, Any]) -> None:
    """Within 5 %: the rig's controller acts on noisy readings, which shake its dry friction; the replay's does not."""
    fitted = twin_diagnosis.diagnosis.effects[0].parameters
    assert set(fitted) == {"static_excess", "stribeck_velocity"}
    for own, value in fitted.items():
        assert value["value"] == pytest.approx(truth["truth"][f"joint_{own}"], rel=0.05)


@pytest.mark.slow
def test_the_gap_shrinks_as_it_does_for_one_who_knows_the_effect(
    twin_diagnosis: TwinDiagnosis, truth: dict[str, Any]
) -> None:
    oracle = tl.diagnose(tl.load(bundled()), library=truth["effects"], progress=False)
    assert list(oracle.selected) == truth["effects"]
    for origin in ("from_nominal", "from_refitted"):
        found = twin_diagnosis.diagnosis.shrinkage[origin]["value"]
        assert found == pytest.approx(oracle.shrinkage[origin]["value"], abs=0.03)


def test_every_held_out_run_is_drawn_the_one_that_tuning_leaves_worst_first(twin_diagnosis: TwinDiagnosis) -> None:
    """The curves of each give its row of the held-out gaps: sqrt(MSE - 1) over samples and outputs, in noise floors."""
    found = twin_diagnosis.diagnosis
    assert found.overlays[0].name == found.held_out["refitted"].idxmax()
    assert sorted(run.name for run in found.overlays) == sorted(found.held_out.index)
    for run in found.overlays:
        assert list(run.inputs) == ["motor_torque", "reference_angle"]
        for stage in ("nominal", "refitted", "with_effect"):
            curves = getattr(run, stage)
            errors = [(run.measured[name] - curves[name]) / run.floor[name] for name in run.measured]
            gap = math.sqrt(max(0.0, np.nanmean(np.square(errors)) - 1.0))
            assert gap == pytest.approx(found.held_out.loc[run.name, stage], rel=1e-6)


def test_probabilities_are_probabilities(twin_diagnosis: TwinDiagnosis) -> None:
    found = twin_diagnosis.diagnosis
    assert sum(found.verdict_probability.values()) == pytest.approx(1.0)
    assert max(found.verdict_probability, key=found.verdict_probability.__getitem__) == found.verdict
    assert all(0 <= e.probability <= 1 for e in found.effects)
    assert sum(s["probability"] for s in found.sets) <= 1 + 1e-9
    assert all(math.isfinite(v) for row in found.gap.values() for v in row.values())


@pytest.mark.slow
def test_nothing_is_found_where_the_simulator_is_right(tmp_path: Path) -> None:
    found = tl.diagnose(tl.load(make_twin(tmp_path / "rig", kind="none")), progress=False)
    assert found.verdict == "no_gap"
    assert found.selected == ()


@pytest.mark.slow
def test_no_effect_is_found_where_parameters_are_off(tmp_path: Path) -> None:
    found = tl.diagnose(tl.load(make_twin(tmp_path / "rig", kind="parameters_only")), progress=False)
    assert found.verdict == "parameters_only"
    assert found.selected == ()


def test_unknown_effects_are_refused() -> None:
    with pytest.raises(tl.errors.ParameterError, match="joint:stribek"):
        tl.diagnose(tl.load(bundled()), library=["joint:stribek"], progress=False)
    with pytest.raises(tl.errors.ParameterError, match="expected 'default' or a list"):
        tl.diagnose(tl.load(bundled()), library="all", progress=False)

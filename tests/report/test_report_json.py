"""report.json keeps the contract: its keys, its types, and None in place of NaN."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.report.diagnosis import Diagnosis, EffectFinding, Overlay, plain

CONTRACT = [
    "format", "tendonlab", "dataset", "system", "seed", "seconds", "verdict", "verdict_probability", "calibrated",
    "replay", "gap", "where", "effects", "sets", "selected", "explained", "indistinguishable", "invisible",
    "shrinkage", "next_experiments", "data", "warnings",
]  # fmt: skip
FURTHER = ["caveats", "held_out", "split", "details"]
VERDICTS = {"data_fault", "no_gap", "parameters_only", "effect", "unknown_effect"}
EFFECT = {"effect", "element", "probability", "parameters", "held_out_gain", "shrinkage", "extra"}


def test_keys_are_those_of_the_contract(diagnosis: Diagnosis) -> None:
    written = diagnosis.to_dict()
    assert list(written) == CONTRACT + FURTHER
    assert set(written["verdict_probability"]) == VERDICTS
    assert written["format"] == "tendonlab-diagnosis/1"
    assert isinstance(written["calibrated"], bool)
    for values in written["gap"].values():
        assert set(values) == {"noise_floor", "nominal", "refitted", "with_effect"}
    assert set(written["where"]) == {"signals", "elements", "regimes"}
    assert set(written["shrinkage"]) == {"from_nominal", "from_refitted"}
    for found in written["effects"]:
        assert set(found) == EFFECT


def test_file_is_strict_json_and_equals_to_dict(diagnosis: Diagnosis, tmp_path: Path) -> None:
    diagnosis.report(tmp_path, figures=False)
    text = (tmp_path / "report.json").read_text(encoding="utf-8")
    read = json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    assert read == diagnosis.to_dict()
    assert json.dumps(read, allow_nan=False)


def test_nan_is_written_as_none(with_effect: Diagnosis) -> None:
    gap = {"joint_angle": {"noise_floor": 1e-3, "nominal": np.nan, "refitted": np.float64(0.2), "with_effect": np.inf}}
    written = replace(with_effect, gap=gap, explained=float("nan")).to_dict()
    assert written["gap"]["joint_angle"] == {"noise_floor": 1e-3, "nominal": None, "refitted": 0.2, "with_effect": None}
    assert written["explained"] is None


def test_arrays_and_numpy_scalars_become_plain() -> None:
    made = plain({"a": np.arange(3), "b": (np.float32(0.5), np.bool_(True)), "c": Path("x")})
    assert made == {"a": [0, 1, 2], "b": [0.5, True], "c": "x"}
    assert type(made["b"][1]) is bool


def test_a_value_without_a_json_form_is_named() -> None:
    with pytest.raises(ParameterError, match=r"value\.a\[1\] is a complex"):
        plain({"a": [1, 2j]})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"verdict": "maybe"}, "verdict = 'maybe': expected one of data_fault, no_gap"),
        ({"gap": {"joint_angle": {"noise_floor": 1.0}}}, "gap of joint_angle lacks nominal"),
        ({"shrinkage": {}}, "shrinkage lacks from_nominal"),
        ({"selected": ("stribeck",)}, "'stribeck': expected element:effect"),
        ({"replay": {}}, "replay lacks kind"),
        ({"verdict_probability": {"effect": 1.0}}, "verdict_probability lacks data_fault"),
        ({"data": ({"problem": "sign"},)}, r"data\[0\] lacks signal"),
    ],
)
def test_a_broken_result_says_what_is_missing(with_effect: Diagnosis, change: dict[str, object], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        replace(with_effect, **change)


def test_an_overlay_of_another_length_is_refused() -> None:
    time, short = np.arange(4.0), {"joint_angle": np.zeros(3)}
    with pytest.raises(ParameterError, match=r"measured\['joint_angle'\] has shape \(3,\): expected \(4,\)"):
        Overlay(name="a", time=time, measured=short, nominal=short, refitted=short, with_effect=short, floor={})
    with pytest.raises(ParameterError, match=r"inputs\['motor_torque'\] has shape \(3,\): expected \(4,\)"):
        Overlay(
            name="a",
            time=time,
            measured={},
            nominal={},
            refitted={},
            with_effect={},
            floor={},
            inputs={"motor_torque": np.zeros(3)},
        )


def test_effect_without_shrinkage_writes_null() -> None:
    found = EffectFinding(effect="delay", element="actuation", probability=0.1)
    assert found.name == "actuation:delay"
    assert found.to_dict()["shrinkage"] is None

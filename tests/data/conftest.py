"""A small valid dataset that tests write to disk, whole or broken on purpose."""

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest


class Draft:
    """A dataset in the making: `toml` is the content of dataset.toml, `frames` the CSV files by name."""

    def __init__(self, toml: dict[str, Any], frames: dict[str, pd.DataFrame]) -> None:
        self.toml = toml
        self.frames = frames

    def write(self, folder: Path) -> Path:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "dataset.toml").write_text(to_toml(self.toml), encoding="utf-8")
        for name, frame in self.frames.items():
            frame.to_csv(folder / name, index=False)
        return folder


def to_toml(table: dict[str, Any], where: str = "") -> str:
    """TOML of nested dicts: scalars first, then tables and arrays of tables."""
    plain = {k: v for k, v in table.items() if not isinstance(v, dict) and not _is_tables(v)}
    text = "".join(f"{json.dumps(key)} = {_value(value)}\n" for key, value in plain.items())
    for key, value in table.items():
        dotted = f"{where}.{json.dumps(key)}" if where else json.dumps(key)
        if isinstance(value, dict):
            text += f"[{dotted}]\n{to_toml(value, dotted)}"
        elif _is_tables(value):
            text += "".join(f"[[{dotted}]]\n{to_toml(item, dotted)}" for item in value)
    return text


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def _value(value: Any) -> str:
    if isinstance(value, float):
        return repr(value)  # TOML writes nan and inf as Python does
    return json.dumps(value, ensure_ascii=False)


def _frame(phase: float) -> pd.DataFrame:
    t = np.arange(20) * 0.01
    return pd.DataFrame({"t": t, "u": np.sin(9 * t + phase), "q": 0.1 * t + phase, "dq": 0.1 + 0 * t, "T": 25.0 + t})


GOOD: dict[str, Any] = {
    "format": "tendonlab-dataset/1",
    "name": "tiny",
    "description": "made by hand",
    "system": {
        "kind": "rigid_joint",
        "parameters": {
            "inertia": {"value": 0.02, "sd": 0.001},
            "gravity_torque": {"value": 0.5, "sd": 0.05},
            "torque_constant": {"value": 1.0, "sd": 0},
            "coulomb": {"value": 0.05},
            "viscous": {"value": 0.01, "min": 0.0},
        },
    },
    "signals": {
        "motor_torque": {"column": "u", "unit": "N*m"},
        "joint_angle": {"column": "q", "unit": "rad"},
        "joint_velocity": {"column": "dq", "unit": "rad/s", "noise_sd": 0.001},
    },
    "experiments": [
        {"name": "one", "file": "one.csv", "split": "train"},
        {"name": "two", "file": "two.csv", "split": "test"},
    ],
}


TWO_INERTIA: dict[str, Any] = {
    "kind": "two_inertia",
    "parameters": {
        "motor_inertia": {"value": 1e-4},
        "joint_inertia": {"value": 0.02},
        "gear_ratio": {"value": 10.0, "sd": 0},
        "cable_stiffness": {"value": 100.0},
        "cable_damping": {"value": 0.1},
        "gravity_torque": {"value": 0.5},
        "motor_viscous": {"value": 2e-4},
        "motor_coulomb": {"value": 0.01},
        "joint_viscous": {"value": 0.01},
        "joint_coulomb": {"value": 0.05},
    },
}


@pytest.fixture
def draft() -> Draft:
    return Draft(copy.deepcopy(GOOD), {"one.csv": _frame(0.0), "two.csv": _frame(0.3)})


@pytest.fixture
def two_inertia(draft: Draft) -> Draft:
    draft.toml["system"] = copy.deepcopy(TWO_INERTIA)
    del draft.toml["signals"]["joint_velocity"]
    return draft


@pytest.fixture
def write(tmp_path: Path) -> Callable[[Draft], Path]:
    return lambda draft: draft.write(tmp_path / "tiny")

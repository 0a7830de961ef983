"""Right logs of a cable mechanism whose tensions lag in a small motion, as friction with memory has it."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl

pytestmark = [pytest.mark.slow, pytest.mark.cpu(60)]
TIME = np.arange(0.0, 8.0, 0.004)
GEOMETRY = {"pulley_radius": 0.018, "initial_wrap_angle": 1.69, "smallest_level": 0.001}
VALUES = GEOMETRY | {
    "cable_stiffness": 4.2e4, "pretension": 48.0, "inertia": 0.0023, "friction_coefficient": 0.157,
    "static_friction_coefficient": 0.204, "stribeck_velocity": 0.0012, "bristle_stiffness": 2.7e5,
    "bristle_damping": 800.0, "contact_viscous": 334.0,
}  # fmt: skip
EFFECTS = ("contact:capstan", "contact:presliding", "contact:stribeck", "contact:viscous")
RUNS = {"a": (0.5, 0.4), "b": (0.3, 0.9), "c": (0.6, 0.25), "d": (0.2, 1.4)}  # rad, Hz


@pytest.fixture(scope="module")
def logs() -> dict[str, pd.DataFrame]:
    noise = np.random.default_rng(1)
    rig = tl.System(kind="ccsrm", parameters=VALUES, effects=EFFECTS)
    driven = {name: size * np.sin(2 * np.pi * rate * TIME) for name, (size, rate) in RUNS.items()}
    driven["small"] = 0.01 * np.sin(2 * np.pi * 0.2 * TIME) + 0.003 * np.sin(2 * np.pi * 5.0 * TIME)
    found = {}
    for name, angle in driven.items():
        given = pd.DataFrame({"driver_angle": angle}, index=pd.Index(TIME, name="t"))
        seen = rig.simulate(given).outputs
        sd = [2e-5 if "angle" in column else 0.1 for column in seen.columns]
        found[name] = given.join(seen + sd * noise.normal(size=seen.shape))
    return found


def blocking(logs: dict[str, pd.DataFrame], folder: Path) -> list[tuple[str, str | None]]:
    lines = ["format = 'tendonlab-dataset/1'", "name = 'rig'", "time = { column = 't', unit = 's' }"]
    lines += ["[system]", "kind = 'ccsrm'", "[system.parameters]"]
    lines += [f"{k} = {{ value = {v if k in GEOMETRY else 1.05 * v} }}" for k, v in VALUES.items()]
    lines += [f"[signals.{name}]" for name in logs["a"].columns]
    for name, frame in logs.items():
        frame.to_csv(folder / f"{name}.csv")
        lines += ["[[experiments]]", f"name = '{name}'", f"file = '{name}.csv'"]
    (folder / "dataset.toml").write_text("\n".join(lines), encoding="utf-8")
    return [(f.problem, f.experiment) for f in tl.check(tl.load(folder)).findings if f.blocks]


def test_tensions_that_friction_with_memory_delays_are_right(logs: dict[str, pd.DataFrame], tmp_path: Path) -> None:
    assert blocking(logs, tmp_path) == []


def test_an_experiment_whose_outputs_are_all_late_is_told(logs: dict[str, pd.DataFrame], tmp_path: Path) -> None:
    late = logs["b"].copy()
    late.iloc[:, 1:] = np.array([np.interp(TIME - 0.03, TIME, late[name]) for name in late.columns[1:]]).T
    assert set(blocking({**logs, "b": late}, tmp_path)) == {("clock", "b")}

"""What experiments of sampled systems state: time that matters, conditions that hold, inputs that are numbers."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from examples import T, example

TOML = """
format = "tendonlab-dataset/1"
name = "rig"

[system]
kind = "{kind}"
nominal_effects = {effects}

[system.parameters]
{parameters}

[signals]
{signals}

[[experiments]]
name = "one"
file = "one.csv"
conditions = {{ {conditions} }}
split = "train"
"""


def write(folder: Path, kind: str, *, time: str, conditions: str = "") -> Path:
    of, info = example(kind), tl.system_info(kind)
    names = [*of.inputs, *(s.name for s in info.outputs)]
    data = pd.DataFrame({name: of.inputs.get(name, np.sin(7 * T)) for name in names})
    data.assign(**{time: T}).to_csv(folder / "one.csv", index=False)
    parameters = "\n".join(f"{n} = {{ value = {v} }}" for n, v in of.parameters.items())
    signals = "\n".join(f"[signals.{name}]" for name in names)
    effects = [*info.default_nominal_effects, *of.effects]
    text = TOML.format(kind=kind, effects=effects, parameters=parameters, signals=signals, conditions=conditions)
    (folder / "dataset.toml").write_text(text, encoding="utf-8")
    return folder


def test_steady_points_need_no_time(tmp_path: Path) -> None:
    rig = tl.load(write(tmp_path, "friction_map", time="unused"))
    assert list(rig["one"].time) == list(range(len(T)))


@pytest.mark.parametrize("kind", ["bowden_pair", "tendon_routing"])
def test_where_samples_follow_each_other_a_missing_time_is_told(tmp_path: Path, kind: str) -> None:
    """Counting rows as seconds would change every rate by the sampling frequency."""
    with pytest.raises(tl.DatasetError, match="column 't': is missing"):
        tl.load(write(tmp_path, kind, time="time"))


def test_a_condition_is_not_swept_over(tmp_path: Path) -> None:
    rig = tl.load(write(tmp_path, "friction_map", time="t", conditions="relative_load = 2.0"))
    with pytest.raises(tl.ParameterError, match="relative_load: the conditions of the experiment fix it at 2"):
        tl.sweep(rig.system(), {"relative_load": [1.0, 5.0]}, experiment=rig["one"], progress=False)
    free = tl.sweep(rig.system(), {"relative_load": [1.0, 5.0]}, experiment=rig["one"].data, progress=False)
    assert np.ptp(free["friction_torque"].to_numpy(), axis=0).max() > 0


@pytest.mark.parametrize("kind", ["friction_map", "bowden_pair", "ccsrm", "rigid_joint"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_an_input_that_is_no_number_is_named(kind: str, value: float) -> None:
    of = example(kind)
    system = tl.System(
        kind=kind,
        parameters=of.parameters,
        effects=(*tl.system_info(kind).default_nominal_effects, *of.effects),
    )
    inputs = pd.DataFrame(dict(of.inputs), index=pd.Index(T, name="t"))
    name = inputs.columns[0]
    inputs.iloc[7, 0] = value
    with pytest.raises(tl.DatasetError, match=rf"{name} = {value} at t = {T[7]:g} s; expected a finite number"):
        system.simulate(inputs)
    with pytest.raises(tl.DatasetError, match="expected it to increase"):
        system.simulate(inputs.assign(**{name: 0.1})[::-1])

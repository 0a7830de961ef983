"""A tiny rig on disk: a pendulum with dry friction, simulated with the library and read with noise."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl

TRUTH = {"inertia": 0.02, "gravity_torque": 0.5, "torque_constant": 1.0, "coulomb": 0.05, "viscous": 0.03}
NOISE_SD = 1e-3  # rad
RATE = 200.0  # Hz
HEAD = """
format = "tendonlab-dataset/1"
name = "tiny"
[system]
kind = "rigid_joint"
[system.parameters]
inertia = { value = 0.022, sd = 0.003 }
gravity_torque = { value = 0.5, sd = 0 }
torque_constant = { value = 1.0, sd = 0 }
coulomb = { value = 0.06, sd = 0.01 }
viscous = { value = 0.027, sd = 0.004 }
[signals]
motor_torque = { column = "u", unit = "N*m" }
joint_angle = { column = "q", unit = "rad" }
"""
EXPERIMENT = """
[[experiments]]
name = "{name}"
file = "{name}.csv"
split = "{split}"
"""


@pytest.fixture(scope="session")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the tiny rig: four experiments to fit, one held out."""
    folder = tmp_path_factory.mktemp("tiny")
    system = tl.System(kind="rigid_joint", parameters=TRUTH, effects=("joint:coulomb", "joint:viscous"))
    random = np.random.default_rng(5)
    time = np.arange(0.0, 3.0, 1 / RATE)
    text = HEAD
    for place, split in enumerate(["train", "train", "train", "train", "test"]):
        torque = 0.3 * np.sin((2 + 1.5 * place) * time + place) + 0.1 * np.sin(9 * time)
        command = pd.DataFrame({"motor_torque": torque}, index=pd.Index(time, name="t"))
        angle = system.simulate(command)["joint_angle"] + NOISE_SD * random.normal(size=len(time))
        name = f"run-{place + 1}"
        pd.DataFrame({"u": torque, "q": angle.to_numpy()}, index=command.index).to_csv(folder / f"{name}.csv")
        text += EXPERIMENT.format(name=name, split=split)
    (folder / "dataset.toml").write_text(text, encoding="utf-8")
    return folder

"""A pendulum with two short experiments to fit and one held out, in memory and on disk; and a stubbed diagnosis."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from rehearsal.stubs import says
from tendonlab.report.diagnosis import Diagnosis

SYSTEM = """
format = "tendonlab-dataset/1"
name = "pendulum"
[system]
kind = "rigid_joint"
[system.parameters]
inertia = { value = 0.02, sd = 0.001 }
gravity_torque = { value = 0.5, sd = 0.02 }
coulomb = { value = 0.05, sd = 0.005 }
viscous = { value = 0.03, sd = 0.003 }
[signals]
motor_torque = { column = "u" }
joint_angle = { column = "q", noise_sd = 1e-3 }
"""
CONTROLLER = """
reference_angle = { column = "r" }
[controller]
kind = "pd"
kp = 8.0
kd = 0.4
measured = "joint_angle"
reference = "reference_angle"
"""
EXPERIMENT = '[[experiments]]\nname = "{0}"\nfile = "{0}.csv"\nsplit = "{1}"\n'


@pytest.fixture(scope="session")
def pendulum(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a rig that a torque drives: two experiments to fit, one held out."""
    folder = tmp_path_factory.mktemp("pendulum")
    truth = {"inertia": 0.02, "gravity_torque": 0.5, "coulomb": 0.05, "viscous": 0.03, "torque_constant": 1.0}
    system = tl.System(kind="rigid_joint", parameters=truth, effects=("joint:coulomb", "joint:viscous"))
    random, time, text = np.random.default_rng(3), np.arange(0.0, 3.0, 0.01), SYSTEM
    for place, split in enumerate(["train", "train", "test"]):
        torque = 0.3 * np.sin((2 + 1.5 * place) * time) + 0.1 * np.sin(9 * time + place)
        command = pd.DataFrame({"motor_torque": torque}, index=pd.Index(time, name="t"))
        angle = system.simulate(command)["joint_angle"] + 1e-3 * random.normal(size=len(time))
        table = pd.DataFrame({"u": torque, "q": angle.to_numpy()}, index=command.index)
        table.to_csv(folder / f"run-{place + 1}.csv")
        text += EXPERIMENT.format(f"run-{place + 1}", split)
    (folder / "dataset.toml").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def planned(tmp_path: Path) -> Path:
    """Folder of a rig with a controller and without logs."""
    (tmp_path / "dataset.toml").write_text(SYSTEM + CONTROLLER, encoding="utf-8")
    return tmp_path


@pytest.fixture
def stub() -> Callable[[tl.Dataset], Diagnosis]:
    """A diagnosis that names an offset of the load where the mean angle is off by more than 5 mrad."""

    def diagnose(dataset: tl.Dataset) -> Diagnosis:
        run = dataset.experiments[0]
        clean = dataset.system().simulate(run)["joint_angle"]
        off = abs(float((run.data["joint_angle"] - clean).mean()))
        return says("load:offset" if off > 0.005 else None)

    return diagnose

"""The EMPS benchmark as a dataset: a linear axis with ball screw under cascaded position and velocity control."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tendonlab.data.public import write_folder
from tendonlab.errors import DatasetError

RECORDS = {"DATA_EMPS.mat": ("estimation", "train"), "DATA_EMPS_PULSES.mat": ("pulses", "test")}
GAINS = ("kp", "kv", "gtau")

# The nominal values are round: the ones that the benchmark's authors identified would leave nothing to find. The rail
# is level, and the force is the drive's gain times its voltage.
TEMPLATE = '''\
format = "tendonlab-dataset/1"
name = "emps"
description = """
EMPS, the electro-mechanical positioning system: DC motor, ball screw and carriage on a rail under cascaded position
and velocity control; 1 kHz, 24.84 s a record. Experiment "pulses" repeats the motion of "estimation" with disturbance
pulses of 5 V added to the controller's output; motor_torque is the total drive voltage and contains them already.
The logged voltage follows from the logged position by its backward difference over 1 ms (0.036 V rms are left; 0.072 V
by a central one): the controller is sampled at 1 kHz.
Licence: open benchmark; the files are copies in the Apache-2.0 repository forgi86/sysid-neural-continuous on GitHub.
Citation: A. Janot, M. Gautier, M. Brunot, "Data set and reference models of EMPS", Workshop on Nonlinear System
Identification Benchmarks, Eindhoven, 2019.
"""

[system]
kind = "rigid_joint"
axis = "linear"
nominal_effects = ["joint:viscous", "actuation:offset"]

[system.parameters]
inertia = { value = 100.0, sd = 10.0 }
viscous = { value = 200.0 }
actuation_offset = { value = 0.0 }
gravity_torque = { value = 0.0, sd = 0.0 }
torque_constant = { value = %(gtau)r, sd = 0.0 }

[controller]
kind = "cascade"
kp = %(kp)r
kd = %(kv)r
measured = "joint_angle"
reference = "reference_angle"
disturbance = "disturbance_voltage"
limit = 10.0
sample_time = 0.001

[signals.motor_torque]
column = "vir"
unit = "V"
hold = true

[signals.joint_angle]
column = "qm"
unit = "m"

[signals.reference_angle]
column = "qg"
unit = "m"
hold = false

[signals.disturbance_voltage]
column = "pulses"
unit = "V"
hold = true
%(experiments)s'''
EXPERIMENT = """
[[experiments]]
name = "%(name)s"
file = "%(name)s.csv"
split = "%(split)s"
"""


def write_emps(files: dict[str, Path], out: Path) -> None:
    """Write dataset.toml and a CSV for each record into `out`, from the MAT files by name.

    Raises DatasetError where a variable is missing, the records disagree on the gains, or `out` holds another
    dataset.toml."""
    from scipy.io import loadmat

    records = {name: loadmat(path) for name, path in files.items()}
    rows = {f"{RECORDS[name][0]}.csv": _to_csv(name, record) for name, record in records.items()}
    write_folder(out, _describe(records), rows)


def _describe(records: dict[str, dict[str, Any]]) -> str:
    gains = {name: [_scalar(file, record, name) for file, record in records.items()] for name in GAINS}
    for name, values in gains.items():
        if len(set(values)) != 1:
            raise DatasetError(f"{', '.join(records)}: {name} = {values}; expected the same in every record")
    experiments = "".join(EXPERIMENT % {"name": name, "split": split} for name, split in RECORDS.values())
    return TEMPLATE % {**{name: values[0] for name, values in gains.items()}, "experiments": experiments}


def _to_csv(file: str, record: dict[str, Any]) -> str:
    import pandas as pd

    time = _vector(file, record, "t")
    # stored as unsigned 8-bit, where a change of sign would wrap; the record for estimation has none
    pulses = _vector(file, record, "pulses_N") if "pulses_N" in record else np.zeros_like(time)
    columns = {name: _vector(file, record, name) for name in ("qg", "qm", "vir")}
    text: str = pd.DataFrame({"t": time, **columns, "pulses": pulses}).to_csv(index=False, lineterminator="\n")
    return text


def _vector(file: str, record: dict[str, Any], name: str) -> np.ndarray:
    if name not in record or record[name].size != max(record[name].shape):
        raise DatasetError(f"{file}: no vector {name!r}; expected the published record")
    vector: np.ndarray = np.asarray(record[name], dtype=float).reshape(-1)
    return vector


def _scalar(file: str, record: dict[str, Any], name: str) -> float:
    vector = _vector(file, record, name)
    if vector.size != 1:
        raise DatasetError(f"{file}: {name!r} has {vector.size} values; expected one")
    return float(vector[0])

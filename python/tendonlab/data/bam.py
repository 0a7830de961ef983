"""A pendulum on a small servo as a dataset: records of three gains and four motions."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from tendonlab.data.public import write_folder
from tendonlab.errors import DatasetError

COUNTS, PER_GAIN = 4096.0 / (2.0 * math.pi), 1.0 / (256.0 * 885.0)  # counts per rad, duty per count and unit of gain
SUPPLY = 7.3  # V, the middle of what the records read
HELD_OUT = 400  # the gain between the others
COLUMNS = ("goal_position", "input_volts", "torque_enable", "position")

# What the records' authors state of the rig, and the data sheet of the servo: stall torque, stall current and speed
# without load. The friction is a guess.
TEMPLATE = '''\
format = "tendonlab-dataset/1"
name = "bam_xl330"
description = """
Dynamixel XL330-M288 holding a pendulum of 0.49 kg at 0.10 m under its own position control; 200 samples per second, 6 s
a record. The proportional gains 100, 400 and 800 of the servo's firmware are 2.1, 8.4 and 16.8 V/rad at 7.3 V. The
torque is off after 2 s in the records "lift_and_drop".
Licence: Apache-2.0; the records are in the history of the repository Rhoban/bam on GitHub.
Citation: M. Duclusaud, G. Passault, V. Padois, O. Ly, "Extended friction models for the physics simulation of servo
actuators", ICRA 2025.
"""

[system]
kind = "servo_pendulum"

[system.parameters]
inertia = { value = 0.0049, sd = 0.0005 }
armature = { value = 0.002, sd = 0.002 }
gravity_torque = { value = 0.481, sd = 0.05 }
torque_constant = { value = 0.46, sd = 0.1 }
resistance = { value = 3.4, sd = 2.0 }
proportional_gain = { value = 8.4, sd = 0.0 }
voltage_limit = { value = 7.3, sd = 0.0 }
angle_offset = { value = 0.0, sd = 0.05 }
coulomb = { value = 0.02 }
viscous = { value = 0.01 }

[signals.target_angle]
column = "goal_position"
unit = "rad"

[signals.supply_voltage]
column = "input_volts"
unit = "V"

[signals.torque_enable]
column = "torque_enable"
unit = "1"

[signals.joint_angle]
column = "position"
unit = "rad"
resolution = 0.00153
'''
EXPERIMENT = """
[[experiments]]
name = "%(name)s"
file = "%(name)s.csv"
split = "%(split)s"
conditions = { proportional_gain = %(gain).6g }
"""


def write_bam(files: dict[str, Path], out: Path) -> None:
    """Write dataset.toml and a CSV for each record into `out`, from the JSON files by name.

    Raises DatasetError where a record lacks a field, or `out` holds another dataset.toml."""
    text, written = TEMPLATE, {}
    for file, path in files.items():
        record = json.loads(path.read_text(encoding="utf-8"))
        try:
            name, gain = f"{record['trajectory']}-{record['kp']}", record["kp"] * COUNTS * PER_GAIN * SUPPLY
            written[f"{name}.csv"] = _to_csv(record)
        except KeyError as missing:
            raise DatasetError(f"{file}: no field {missing}; expected the published record") from missing
        split = "test" if record["kp"] == HELD_OUT else "train"
        text += EXPERIMENT % {"name": name, "split": split, "gain": gain}
    write_folder(out, text, written)


def _to_csv(record: dict[str, Any]) -> str:
    rows = [",".join(("t", *COLUMNS))]
    for k, entry in enumerate(record["entries"]):
        values = (k * record["dt"], *(float(entry[name]) for name in COLUMNS))
        rows.append(",".join(f"{value:.9g}" for value in values))
    return "\n".join(rows) + "\n"

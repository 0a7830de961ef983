"""A small bench of two cables in sheaths, whose inputs are logged and nothing holds a position."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

import tendonlab as tl
from tendonlab import _core
from tendonlab.fitting.case import make_case
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import Fitter
from tendonlab.simulation.system import System

TIME, NOISE = np.arange(0.0, 6.0, 0.02), 0.05
PARAMETERS = {
    "input_radius": 0.05, "output_radius": 0.05, "sheath_length": 1.0, "cable_stiffness": 1e5, "pretension": 150.0,
    "wrap_angle": 4.2, "friction_coefficient": 0.07, "static_friction_coefficient": 0.08, "stribeck_velocity": 0.012,
    "threshold_velocity": 0.05, "threshold_slope": 4000.0, "sheath_viscous": 0.8, "curvature_skew": 0.0,
    "gate_share": 1.0,
}  # fmt: skip
HEAD = """
format = "tendonlab-dataset/1"
name = "bench"
description = "bench"
time = { column = "t", unit = "s" }
[system]
kind = "bowden_pair"
axis = "rotary"
nominal_effects = ["sheath:capstan", "sheath:viscous"]
[signals.input_torque]
column = "u"
unit = "N*m"
[signals.input_velocity]
column = "w (deg/s)"
unit = "deg/s"
[signals.output_torque]
column = "y"
unit = "N*m"
noise_sd = 0.05
[system.parameters]
"""


def bench(folder: Path) -> Fitter:
    """Four training runs and one more, of which the first two carry little: fits under the noise of its sensor."""
    system = System(kind="bowden_pair", parameters=PARAMETERS, effects=("sheath:capstan", "sheath:viscous"))
    sd = {"friction_coefficient": 0.01, "sheath_viscous": 0.1}
    rows = [f"{name} = {{ value = {value}, sd = {sd.get(name, 0.0)} }}" for name, value in PARAMETERS.items()]
    draw, parts = np.random.default_rng(1), []
    for k, (frequency, torque) in enumerate([(1.0, 1.0), (1.7, 1.0), (0.8, 14.0), (1.3, 14.0), (1.1, 10.0)]):
        velocity = 0.6 * np.cos(frequency * TIME) + 0.2 * np.cos(2.3 * frequency * TIME)  # in motion at once
        inputs = {"input_torque": torque * np.cos(0.7 * frequency * TIME), "input_velocity": velocity}
        made = system.simulate(pd.DataFrame(inputs, index=TIME)).outputs["output_torque"].to_numpy()
        read = made + NOISE * draw.standard_normal(len(TIME))
        log = {"t": TIME, "u": inputs["input_torque"], "w (deg/s)": np.degrees(velocity), "y": read}
        pd.DataFrame(log).to_csv(folder / f"{k}.csv", index=False)
        split = "test" if k == 4 else "train"
        parts.append(f'[[experiments]]\nname = "run-{k}"\nfile = "{k}.csv"\nsplit = "{split}"\n')
    (folder / "dataset.toml").write_text("\n".join([HEAD, *rows, *parts]))
    case = make_case(tl.load(folder), tolerance=1e-4)
    return Fitter(case, white(case.noise), _core.Cancel())

"""Both joints of `ccsrm` as logged, joint 1 late and less far."""

import numpy as np

from examples import Example, T
from examples.ccsrm import EXAMPLE as CCSRM

EXAMPLE = Example(
    parameters={name: value for name, value in CCSRM.parameters.items() if name != "inertia"},
    inputs={
        **CCSRM.inputs,
        "joint_angle": 0.11 * np.sin(2 * np.pi * 1.7 * T - 0.12) * (1 - np.cos(np.pi * T)),
    },
    scale=CCSRM.scale,
    events=False,
)

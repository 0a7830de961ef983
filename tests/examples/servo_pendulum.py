import numpy as np

from examples import Example, T

TARGET = np.sin(2 * np.pi * T) + 0.5 * np.sin(2 * np.pi * 2.3 * T + 1.0)
ORDER = {"effort": 0.3, "displacement": 0.3, "output": 0.3, "flow": 1.0, "stiffness": 5.0, "damping": 0.5, "time": 0.94}

EXAMPLE = Example(
    parameters={
        "inertia": 0.005,
        "armature": 0.002,
        "gravity_torque": 0.5,
        "torque_constant": 0.6,
        "resistance": 3.0,
        "proportional_gain": 15.0,
        "voltage_limit": 100.0,  # never met: that is a kink inside a step, which differences do not resolve
        "angle_offset": 0.02,
        "coulomb": 0.05,
        "viscous": 0.02,
    },
    inputs={"target_angle": TARGET, "torque_enable": 1.0 - T**2},
    scale=lambda element, dimension: ORDER.get(dimension, 1.0),  # a delay does not end on a sample: a kink is there
)

import numpy as np

from examples import Example, T

COMMAND = np.sin(2 * np.pi * T) + 0.5 * np.sin(2 * np.pi * 2.3 * T + 1.0)
ORDER = {"effort": 0.5, "displacement": 0.1, "output": 0.1, "flow": 1.0, "stiffness": 5.0, "damping": 0.5, "time": 0.94}

EXAMPLE = Example(
    parameters={"inertia": 0.02, "gravity_torque": 0.3, "torque_constant": 1.0, "coulomb": 0.05, "viscous": 0.02},
    inputs={"motor_torque": 0.6 * COMMAND},
    scale=lambda element, dimension: ORDER.get(dimension, 1.0),  # a delay does not end on a sample: a kink is there
)

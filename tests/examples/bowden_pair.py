import numpy as np

from examples import Example, T

# Loaded beyond its pretension for a while, faster and slower than the gate, which is soft enough to have a slope.
EXAMPLE = Example(
    parameters={
        "friction_coefficient": 0.06,
        "static_friction_coefficient": 0.08,
        "stribeck_velocity": 0.2,
        "threshold_velocity": 0.1,
        "threshold_slope": 60.0,
        "gate_share": 1.0,
        "input_radius": 0.05,
        "output_radius": 0.06,
        "sheath_length": 0.8,
        "cable_stiffness": 1e5,
        "pretension": 130.0,
        "wrap_angle": 3.6,
    },
    inputs={
        "input_torque": 15.0 * np.sin(2 * np.pi * T) + 4.0 * np.sin(6 * np.pi * T + 0.4),
        "input_velocity": 0.5 * np.cos(2 * np.pi * T + 0.2) + 0.1 * np.sin(8 * np.pi * T),
    },
    scale=lambda element, dimension: {"effort": 5.0, "flow": 0.3, "stiffness": 50.0, "damping": 5.0, "time": 0.2}.get(
        dimension, 1.0
    ),
    events=False,
)

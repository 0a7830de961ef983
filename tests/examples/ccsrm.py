import numpy as np

from examples import Example, T

ORDER = {
    "effort": 0.05,
    "flow": 0.5,
    "displacement": 0.1,
    "output": 0.05,
    "stiffness": 50.0,
    "damping": 0.05,
    "time": 0.94,
}
LINE = {"effort": 5.0, "flow": 0.01, "displacement": 1e-3, "stiffness": 1e4, "damping": 300.0}
DEFLECTION = 2e-5  # m: of a bristle

EXAMPLE = Example(
    parameters={
        "cable_stiffness": 5e4,
        "pretension": 50.0,
        "pulley_radius": 0.012,
        "initial_wrap_angle": 1.69,
        "inertia": 0.01,
        "friction_coefficient": 0.15,
        "smallest_level": 1e-3,
        "static_friction_coefficient": 0.18,
        "stribeck_velocity": 1e-3,
        "bristle_stiffness": 5.0 / DEFLECTION,
        "bristle_damping": 1e3,
        "contact_viscous": 500.0,
    },
    inputs={"driver_angle": 0.12 * np.sin(2 * np.pi * 1.7 * T) * (1 - np.cos(np.pi * T))},
    scale=lambda element, dimension: (LINE if element in ("contact", "cable") else ORDER).get(dimension, 1.0),
)

"""Through rest and both directions, up to the speeds of the bench."""

import numpy as np

from examples import Acting, Example, T

ORDER = {"effort": 0.2, "flow": 40.0, "damping": 0.005, "output": 0.1}

EXAMPLE = Example(
    parameters={
        "relative_load": 2.8,
        "transmission_ratio": 4.16,
        "coulomb": 0.0036,
        "static_friction": 0.04,
        "stribeck_velocity": 25.0,
        "viscous": 1e-3,
        "load_exponent": 0.35,
        "peak_exponent": 0.73,
        "stribeck_exponent": 3.0,
        "viscous_exponent": 0.92,
    },
    inputs={"speed": 100.0 * np.sin(2 * np.pi * T)},
    scale=lambda element, dimension: ORDER.get(dimension, 1.0),
    events=False,
    between="linear",
    acting={"contact:static_lugre": Acting(parameters={"contact_lugre_static_friction": 0.3})},  # unlike the kinetic
)

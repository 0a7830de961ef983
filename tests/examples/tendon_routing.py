import numpy as np

from examples import Example, T
from tendonlab.papers.s1.device import example_device

CABLE = {"effort": 20.0, "flow": 0.05, "displacement": 0.01, "stiffness": 2000.0, "damping": 400.0}
GEAR = {"effort": 2.0, "flow": 0.5, "displacement": 0.1, "stiffness": 20.0, "damping": 4.0}
JOINT = [np.sin(2 * np.pi * rate * T + start) for rate, start in ((1.0, 0.3), (0.7, 1.0), (1.3, 2.0), (0.9, 0.0))]
MOTOR = example_device().kinematics.joint_to_motor(np.stack(JOINT, axis=-1))


def scale(element: str, dimension: str) -> float:
    """A cable's, a gear's, or that of a motor torque. A delay does not end on a sample: there are kinks."""
    return {"cable": CABLE, "gear": GEAR}.get(element, {"output": 0.3, "time": 0.94}).get(dimension, 1.0)


EXAMPLE = Example(
    parameters={**example_device().parameters(), "cable_coulomb": 0.4},
    effects=("cable:coulomb",),  # a bristle asks for dry friction to take over
    inputs={
        **{f"motor_velocity_{i + 1}": MOTOR[:, i] for i in range(4)},
        **{f"external_torque_{i + 1}": peak * np.cos(3.0 * T + i) for i, peak in enumerate((6.0, 4.0, 0.8, 1.5))},
    },
    scale=scale,
    events=False,
    between="linear",
)

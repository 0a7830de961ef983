import numpy as np

from examples import Acting, Example, T
from tendonlab.papers import s2

RIG = s2.constants(viscous_reading="C")
# Of the motor: 0.1 N*m, 100 rad/s, 10 rad; of cables and guides: 100 N, 1 mm/s, 1 mm.
MOTOR = {"effort": 0.1, "flow": 100.0, "displacement": 10.0, "stiffness": 0.01, "damping": 1e-3, "inverse_flow": 0.01}
JOINT = {"effort": 1.0, "flow": 0.02, "displacement": 0.01, "stiffness": 100.0, "damping": 50.0}
GUIDE = {"effort": 20.0, "flow": 1e-3, "displacement": 1e-3, "stiffness": 2e4, "damping": 2e4}


def scale(element: str, dimension: str) -> float:
    """Of the order of the motion there; a delay does not end on a sample."""
    own = GUIDE if element.startswith(("bushing", "cable")) else JOINT if element in ("joint", "load") else MOTOR
    sensors = {"sensor.joint_angle": 0.01, "sensor.joint_velocity": 0.02, "sensor.motor_velocity": 100.0}
    extra = {"time": 0.94, "output": sensors.get(element, 100.0)}
    return {**own, **extra, **({"effort": 10.0} if element == "actuation" else {})}.get(dimension, 1.0)


def parameters() -> dict[str, float]:
    """The rig without the friction part of its bushings: their forces then do not jump where the sense changes, and
    differences mean something at every sample."""
    found = s2.parameters(RIG)
    for name in ("a", "b", "c"):
        for j in ("1", "2") if name == "b" else ("",):
            for cable in (1, 2):
                found[f"bushing_{cable}_{name}2{j}"] = found[f"bushing_{cable}_{name}1{j}"]
    return found


def acting() -> dict[str, Acting]:
    """A cable of less tension than its toe. A guide whose cable passes the edge of its branches both ways, and one that
    moves at its Stribeck velocity. Nuts that are driven and stop for 0.1 s, with guides as identified."""
    found = {"cable:toe_region": Acting(parameters={"cable_toe_tension": 300.0})}
    there_and_back = {"voltage": 100.0 * np.cos(2 * np.pi * T / 0.3)}
    for guide in ("bushing_1", "bushing_2"):
        edges = {f"{guide}_c1": 1e-3, f"{guide}_c2": 1e-3}
        low = {f"{guide}_static_excess": 20.0, f"{guide}_stribeck_velocity": 1e-3}
        found[f"{guide}:bushing_branches"] = Acting(parameters=edges, inputs=there_and_back)
        found[f"{guide}:stribeck"] = Acting(parameters=low)
    corners = [0.0, 0.0512, 0.1023, 0.1124, 0.2013, 0.2522]  # s: none on a sample
    nuts = np.interp(T, corners, [0.0, 0.02, 0.02, 0.0, 0.0, -0.02])
    guides = {name: value for name, value in s2.parameters(RIG).items() if name.startswith("bushing")}
    found["stiction:hold"] = Acting(
        parameters={**guides, "stiction_hold": 0.9}, inputs={"actuator_velocity": nuts}, between="linear"
    )
    return found


EXAMPLE = Example(
    parameters=parameters(),
    inputs={"voltage": 30.0 * np.sin(2 * np.pi * T) + 10.0 * np.sin(2 * np.pi * 2.3 * T + 1.0)},
    scale=scale,
    acting=acting(),
)

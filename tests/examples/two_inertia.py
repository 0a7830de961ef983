from examples import Example
from examples.rigid_joint import COMMAND, ORDER
from integrate.rig import FRICTION, INERTIAS

MOTOR_SIDE = ("motor", "actuation", "sensor.motor_angle")


def scale(element: str, dimension: str) -> float:
    """At the motor N times or 1/N of the joint's."""
    ratio = 10.0 if element in MOTOR_SIDE else 1.0
    moved = {"effort": 1 / ratio, "displacement": ratio, "output": ratio, "flow": ratio}
    moved |= {"stiffness": 1 / ratio**2, "damping": 1 / ratio**2}
    return ORDER.get(dimension, 1.0) * moved.get(dimension, 1.0)


EXAMPLE = Example(
    parameters={**INERTIAS, **FRICTION, "gravity_torque": 0.3}, inputs={"motor_torque": 0.06 * COMMAND}, scale=scale
)

"""S1: tension propagation with friction in coupled tendon transmissions of a four-joint arm exoskeleton.

The device's radii, ratios and coefficients are reconstructed, the paper prints none, and so is what rests on them.
The transmission for any number of joints is `tendonlab.TendonTransmission`; as a system of the library,
`tendon_routing`, it takes every effect."""

from tendonlab.papers.s1.arm import Arm
from tendonlab.papers.s1.bearing import BallBearing
from tendonlab.papers.s1.blocks import CONTROL_SCHEME, BlockDiagram, kinematics_diagram, statics_diagram
from tendonlab.papers.s1.compensation import FeedForward, FreeMotion, Trajectory, evaluate_free_motion, free_motion
from tendonlab.papers.s1.device import example_device, first_joints, gravity, without_tension_loss
from tendonlab.papers.s1.display import ForceDisplay, Hand, Wall
from tendonlab.papers.s1.drawing import draw_blocks, draw_routing
from tendonlab.papers.s1.experiments import compensated, effect_sizes, noisy_identification, reducer_loop, strategies
from tendonlab.papers.s1.identification import (
    decompose,
    fit_motor_friction,
    identify_joint,
    plan_identification,
    residual_error,
    shares_by_bearings,
    steady_average,
    true_motor_friction,
)
from tendonlab.papers.s1.printed import differences
from tendonlab.papers.s1.twin import write_dataset

__all__ = [
    "CONTROL_SCHEME",
    "Arm",
    "BallBearing",
    "BlockDiagram",
    "FeedForward",
    "ForceDisplay",
    "FreeMotion",
    "Hand",
    "Trajectory",
    "Wall",
    "compensated",
    "decompose",
    "differences",
    "draw_blocks",
    "draw_routing",
    "effect_sizes",
    "evaluate_free_motion",
    "example_device",
    "first_joints",
    "fit_motor_friction",
    "free_motion",
    "gravity",
    "identify_joint",
    "kinematics_diagram",
    "noisy_identification",
    "plan_identification",
    "reducer_loop",
    "residual_error",
    "shares_by_bearings",
    "statics_diagram",
    "steady_average",
    "strategies",
    "true_motor_friction",
    "without_tension_loss",
    "write_dataset",
]

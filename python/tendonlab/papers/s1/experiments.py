"""The numerical experiments around S1: cost of each effect, results of the strategies, and the loop of a reducer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from tendonlab.arguments import whole
from tendonlab.mechanics.tendons import Model, TendonTransmission
from tendonlab.papers.s1.compensation import FeedForward, FreeMotion, evaluate_free_motion, free_motion
from tendonlab.papers.s1.device import LOAD_LEVELS, example_device, gravity
from tendonlab.papers.s1.identification import (
    MotorFriction,
    Strategy,
    fit_motor_friction,
    identify_joint,
    plan_identification,
    require_joint,
    residual_error,
    true_motor_friction,
)

SPEEDS = (-6.0, -4.0, -2.0, 2.0, 4.0, 6.0)  # rad/s of the motor under test [reconstructed]
NOISY_SPEEDS = tuple(sign * float(v) for sign in (-1, 1) for v in range(1, 7))  # rad/s [reconstructed]


def effect_sizes(levels: Sequence[float] = LOAD_LEVELS) -> pd.DataFrame:
    """RMS torque, N·m, that each effect alone adds at motor 1 in the free motion, one column per level of gravity.
    Constant and viscous losses do not depend on the load; losses of tension and reducers grow with it."""
    plain, geared = example_device(reducers=False), example_device()
    losses = plain.losses
    none = losses.scaled(constant=0.0, tension=0.0, viscous=0.0)
    cases = {
        "constant": replace(plain, losses=losses.scaled(tension=0.0, viscous=0.0)),
        "viscous": replace(plain, losses=losses.scaled(constant=0.0, tension=0.0)),
        "tension": replace(plain, losses=losses.scaled(constant=0.0, viscous=0.0)),
        "reducer": replace(geared, losses=none),
    }
    at = free_motion()
    found: dict[str, dict[str, float]] = {name: {} for name in cases}
    for level in levels:
        load = level * gravity(at.joint_angle)
        ideal = plain.statics.inverse(load, at.joint_velocity, model="ideal").torque[:, 0]
        for name, device in cases.items():
            added = device.statics.inverse(load, at.joint_velocity).torque[:, 0] - ideal
            found[name][f"gravity x {level:g}"] = float(np.sqrt(np.mean(np.square(added))))
    return pd.DataFrame(found).T.rename_axis("effect")


def strategies(*, model: Model = "eq12", speeds: Sequence[float] = SPEEDS) -> pd.DataFrame:
    """Results of both strategies at each joint of the device without reducers, and the truth: `constant`, N·m, and
    `viscous`, N·m·s/rad; `residual`, N·m at 6 rad/s, is what friction of the other loops adds (S1 eq. 15)."""
    device, rows = example_device(reducers=False), []
    names: tuple[Strategy, ...] = ("S1", "S2")
    for strategy in names:
        for joint in range(1, device.num_joints + 1):
            found = identify_joint(device, joint, strategy=strategy, speeds=speeds, model=model)
            constant, viscous = true_motor_friction(device, joint)
            rows.append(
                {
                    "strategy": strategy, "joint": joint, "constant": found.constant, "true constant": constant,
                    "viscous": found.viscous, "true viscous": viscous,
                    "residual": residual_error(device, joint, strategy=strategy, speed=6.0, model=model),
                }
            )  # fmt: skip
    return pd.DataFrame(rows).set_index(["strategy", "joint"])


def noisy_identification(
    device: TendonTransmission,
    rng: np.random.Generator,
    *,
    joint: int = 1,
    passes: int = 1,
    noise: float = 0.03,
    speeds: Sequence[float] = NOISY_SPEEDS,
) -> MotorFriction:
    """Strategy S2 at `joint` where each torque is wrong by a normal share of sd `noise` [reconstructed], every speed
    driven `passes` times."""
    plan = plan_identification(device, joint, strategy="S2", speeds=speeds)
    nothing = np.zeros(device.num_joints)
    torque = device.statics.inverse(nothing, plan.joint_velocity, model="eq12").torque[:, joint - 1]
    speed, torque = np.tile(plan.speed, passes), np.tile(torque, passes)
    return fit_motor_friction(speed, torque * (1.0 + noise * rng.standard_normal(torque.size)))


def compensated(scale: float) -> FreeMotion:
    """The free motion of fig. 7 with `scale` times the true constant and viscous losses in the feed-forward. The device
    has no reducers and all other losses [reconstructed]."""
    device = example_device(reducers=False)
    return evaluate_free_motion(
        device, FeedForward(transmission=device, scale_constant=scale, scale_viscous=scale), free_motion()
    )


def reducer_loop(*, joint: int = 1, samples: int = 400) -> pd.DataFrame:
    """Motor torque, N·m, over joint torque, N·m, of a joint alone that turns to and fro against a weight, with its
    reducer and nothing else lost: driving and driven back part the way up from the way down. Source: S1 eq. 9."""
    device = example_device()
    require_joint(device, joint)
    whole("samples", samples, 1)
    lossless = replace(device, losses=device.losses.scaled(constant=0.0, tension=0.0, viscous=0.0))
    phase = np.linspace(0.0, 2 * np.pi, samples)
    torque, velocity = np.zeros((samples, device.num_joints)), np.zeros((samples, device.num_joints))
    torque[:, joint - 1], velocity[:, joint - 1] = 4.0 + 2.0 * np.sin(phase), np.cos(phase)
    motor = lossless.statics.inverse(torque, velocity).torque[:, joint - 1]
    ideal = replace(lossless, reducers=()).statics.inverse(torque, velocity).torque[:, joint - 1]
    columns = {"joint_torque": torque[:, joint - 1], "motor_torque": motor, "lossless": ideal}
    return pd.DataFrame(columns, index=pd.Index(phase, name="phase"))

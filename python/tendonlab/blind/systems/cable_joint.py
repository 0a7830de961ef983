"""The joint of S2: two geared rotations, pulled by two antagonist cables that slide in bushings.

The nuts that wind the cables are driven at a prescribed velocity, so nothing of motor and gear is seen but the ripple.
The bushings' forces were identified on a bench of their own, once for all rigs. The plant is in `cable_joint_plant`,
cables and bushings beside it, what a rig is put through in `cable_joint_session`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tendonlab.blind.description import Input, Output, Slot, System

from .cable_joint_plant import simulate
from .cable_joint_session import ANCHOR, session

BUSHINGS = {
    1: {
        "a1": 60.6,
        "a2": 4.35,
        "b11": -0.7088,
        "b12": 1.283,
        "b21": -1.5211,
        "b22": 0.9346,
        "c1": -0.152,
        "c2": -0.042,
    },
    2: {"a1": -15.1, "a2": 43.2, "b11": -1.411, "b12": 0.966, "b21": -1.066, "b22": -0.104, "c1": -0.029, "c2": -0.025},
}
TYPICAL = {
    "motor_inertia": 3.5e-5,
    "gear_ratio": 20.0,  # S2: 80; these nuts are faster
    "screw_pitch": 0.005,
    "torque_constant": 0.1024,
    "motor_resistance": 0.444,
    "motor_inductance": 4.71e-4,
    "anchor_distance": ANCHOR,
    "link_1_mass": 0.217,
    "link_1_inertia": 7e-4,
    "link_1_length": 0.15,
    "link_1_center": 0.047,
    "link_2_mass": 0.806,
    "link_2_inertia": 1.6e-4,
    "link_2_center": 0.012,
    "mounting_angle": -0.7,
    "gravity": 9.81,
    "pretension": 200.0,
    "cable_stiffness": 272e3,
    "cable_damping": 31.6e3,
    "joint_viscous": 0.08,
    **{f"bushing_{i}_{name}": value for i, numbers in BUSHINGS.items() for name, value in numbers.items()},
}
FREE = ("link_2_mass", "pretension", "cable_stiffness", "cable_damping", "joint_viscous")
SIDES = ("bushing_1", "bushing_2")
FORCES = ("sensor.cable_force_1", "sensor.cable_force_2")
OFFSETS = ("load:offset", *(f"{force}:bias" for force in FORCES))
STRETCH = ("cable:toe_region", "cable:preload_variation")
ANGLE = ("sensor.joint_angle:bias", "gear:ripple", "load:offset", "cable:preload_variation")
LATE = ("sensor.joint_angle:delay", "sensor.joint_velocity:delay", *(f"{force}:delay" for force in FORCES))
AT_REST = ("stiction:hold", "joint:coulomb", "joint:viscous", "joint:load_dependence")
WRAPS = tuple(
    tuple(f"{side}:{name}" for name in ("bushing_sine", "bushing_capstan", "coulomb", "viscous", "stribeck"))
    for side in SIDES
)
RIVALS: dict[str, tuple[str, ...]] = {}
for group in (OFFSETS, STRETCH, ANGLE, LATE, AT_REST, *WRAPS):
    RIVALS |= {
        name: tuple(dict.fromkeys((*RIVALS.get(name, ()), *(other for other in group if other != name))))
        for name in group
    }


def sizes(truth: Mapping[str, float]) -> dict[str, float]:
    """Of effects of amplitude 1 that have one parameter, named like them."""
    return {
        "cable:preload_variation": 0.3 * truth["pretension"],
        "stiction:hold": 0.3,
        "load:offset": 0.15,
        "sensor.joint_angle:bias": 0.01,
        "sensor.joint_velocity:bias": 0.002,
        "sensor.cable_force_1:bias": 3.0,
        "sensor.cable_force_2:bias": 3.0,
    } | dict.fromkeys(LATE, 0.004)


def strengthen(
    name: str, amplitude: float, *, truth: Mapping[str, float], shape: Mapping[str, float], seed: int
) -> dict[str, float] | None:
    """Parameters of friction, toe, ripple and the unknown causes at `amplitude`."""
    element, _, effect = name.partition(":")
    found = _cause(effect, amplitude, seed=seed) if element == "unknown" else {}
    if element in SIDES:
        found = _bushing(element, effect, amplitude, shape=shape)
    elif element == "joint":
        found = _joint(effect, amplitude, truth=truth)
    elif name == "cable:toe_region":
        found = {"cable_toe_tension": truth["pretension"] * amplitude}
    elif name == "gear:ripple":
        phase = np.random.default_rng([seed, 5]).uniform(0.0, 2.0 * np.pi)
        found = {"gear_ripple_sine": 0.1 * amplitude * np.sin(phase)}
        found |= {"gear_ripple_cosine": 0.1 * amplitude * np.cos(phase)}
    elif name == "cable:preload_variation":
        found = {"cable_preload_variation": sizes(truth)[name] * shape["sign"] * amplitude}
    return {key: float(value) for key, value in found.items()} or None


def _bushing(side: str, effect: str, amplitude: float, *, shape: Mapping[str, float]) -> dict[str, float]:
    return {
        "bushing_sine": {f"{side}_sine_coefficient": 0.1 * amplitude},
        "bushing_capstan": {f"{side}_capstan_coefficient": 0.1 * amplitude},
        "coulomb": {f"{side}_coulomb": 5.0 * amplitude},
        "viscous": {f"{side}_viscous": 300.0 * amplitude},
        "stribeck": {
            f"{side}_static_excess": 8.0 * amplitude,
            f"{side}_stribeck_velocity": 0.04 * shape["stribeck_velocity"],
        },
    }[effect]


def _joint(effect: str, amplitude: float, *, truth: Mapping[str, float]) -> dict[str, float]:
    return {
        "coulomb": {"joint_coulomb": 0.1 * amplitude},
        "viscous": {"joint_viscous": truth["joint_viscous"] * amplitude},
        "load_dependence": {"joint_load_dependence": 0.1 * amplitude},
    }[effect]


def _cause(cause: str, amplitude: float, *, seed: int) -> dict[str, float]:
    place, width, time = np.random.default_rng([seed, 6]).uniform((-0.3, 0.08, 0.3), (0.3, 0.2, 1.0))
    return {
        "bump": {"bump": amplitude, "bump_angle": place, "bump_width": width},
        "stop": {"stop_stiffness": 3.0 * amplitude, "stop_angle": 0.15 + 0.5 * place},
        "warming": {"warming": amplitude, "warming_time": 200.0 * time},
        "creep": {"creep": amplitude, "creep_time": time},
        "settling": {"settling": 0.1 * amplitude, "settling_time": 4.0 * time},
    }[cause]


CABLE_JOINT = System(
    kind="cable_joint",
    title="Synthetic joint of two geared links on two pretensioned cables in bushings",
    slots=(Slot("joint", 0.2, 1.0), *(Slot(side, 0.01, 200.0) for side in SIDES)),
    inputs=(Input("actuator_velocity", "w", "m/s", "%.9f", False),),
    outputs=(
        Output("joint_angle", "q", "rad", "%.7f", 8e-6, 6e-6, 0.97, 2.0 * np.pi / 2**18),
        Output("joint_velocity", "v", "rad/s", "%.5f", 1.5e-3, 1e-3, 0.97, 0.0),
        *(Output(f"cable_force_{i}", f"f{i}", "N", "%.3f", 1.2, 0.8, 0.97, 0.1) for i in (1, 2)),
    ),
    optional=("joint_velocity", 0.3, ("sensor.joint_velocity:bias", "sensor.joint_velocity:delay")),
    effects=(
        *(f"joint:{name}" for name in ("coulomb", "viscous", "load_dependence")),
        "gear:ripple",
        *STRETCH,
        *(name for wraps in WRAPS for name in wraps),
        "stiction:hold",
        "load:offset",
        *(f"sensor.{name}:{effect}" for effect in ("bias", "delay") for name in ("joint_angle", "joint_velocity")),
        *(f"{force}:{effect}" for effect in ("bias", "delay") for force in FORCES),
    ),
    nominal_effects=("joint:viscous", *(f"{side}:bushing_branches" for side in SIDES)),
    typical=TYPICAL,
    exact=tuple(name for name in TYPICAL if name not in FREE),
    contract={},
    sizes=sizes,
    forms={
        "ripple": ("once a turn", "with an overtone"),
        "preload_variation": ("cosine", "hyperbola"),
        "toe_region": ("parabola", "exponential"),
        "bushing_sine": ("sine", "wrapped at rest"),
        "bushing_capstan": ("capstan", "power of the wrap"),
        "hold": ("steady", "fading"),
    },
    largest={
        "ripple": 3.0,
        "preload_variation": 4.0,
        "toe_region": 8.0,
        "bushing_sine": 5.0,
        "bushing_capstan": 5.0,
        "hold": 1.0 / 0.3,
        "settling": 4.0,
        "stop": 10.0,
    },
    causes=("bump", "stop", "warming", "creep", "settling"),
    strengthen=strengthen,
    rivals=RIVALS,
    session=session,
    sample_times=(0.01, 0.005),
    duration=8.0,
    coarse_step=2.5e-3,
    fine_step=5e-4,
    simulate=simulate,
)

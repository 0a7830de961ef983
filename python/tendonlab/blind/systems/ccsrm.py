"""Two joints that two S-shaped, pretensioned cables couple to turn alike; joint 2 is driven, joint 1 carries a link."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tendonlab.blind import unknown
from tendonlab.blind.description import Input, Output, Slot, System

from .ccsrm_contact import USUAL_SPEED, USUAL_TENSION
from .ccsrm_plant import simulate
from .ccsrm_session import session
from .effects import FRICTION

TENSION = (0.1, 0.15, 0.95, 0.02)  # N
OUTPUTS = (
    Output("joint_angle", "q1", "rad", "%.7f", 3e-5, 1.5e-4, 0.99, 2 * np.pi / 131072),
    Output("tension_12", "T12", "N", "%.3f", *TENSION),
    Output("tension_21", "T21", "N", "%.3f", *TENSION),
    Output("tension_22", "T22", "N", "%.3f", *TENSION),
)
TYPICAL = {
    "cable_stiffness": 5e4,
    "pretension": 50.0,
    "pulley_radius": 0.012,
    "initial_wrap_angle": 1.69,
    "joint_inertia": 0.01,
    "joint_coulomb": 0.05,
    "joint_viscous": 0.02,
    "contact_kinetic": 0.16,
    "contact_bristle_stiffness": 1e6,
    "contact_bristle_damping": 1e3,
    "contact_viscous": 400.0,
}
CONTRACT = {
    "joint_inertia": "inertia",
    "contact_kinetic": "friction_coefficient",
    "contact_bristle_stiffness": "bristle_stiffness",
    "contact_bristle_damping": "bristle_damping",
}
BIASES = tuple(f"sensor.{output.name}:bias" for output in OUTPUTS)
DELAYS = tuple(f"sensor.{output.name}:delay" for output in OUTPUTS)
RIVALS = {name: tuple(other for other in BIASES if other != name) for name in BIASES}
RIVALS |= {name: (*(other for other in DELAYS if other != name), "cable:viscous") for name in DELAYS}
RIVALS |= {
    "joint:coulomb": ("joint:load_dependence",),
    "joint:load_dependence": ("joint:stribeck",),
    "joint:stribeck": ("joint:presliding", "contact:stribeck"),
    "joint:presliding": ("joint:stribeck",),
    "joint:viscous": ("cable:viscous",),
    "joint:asymmetry": ("contact:asymmetry", "sensor.joint_angle:bias"),
    "contact:viscous": ("cable:viscous",),
    "contact:stribeck": ("joint:stribeck",),
    "contact:asymmetry": ("joint:asymmetry", "sensor.tension_22:bias"),
    "contact:coulomb": ("contact:load_dependence", "contact:stribeck"),
    "contact:load_dependence": ("contact:coulomb", "contact:stribeck"),
    "cable:viscous": ("contact:viscous", "ends:compliance"),
    "ends:compliance": ("cable:viscous",),
}


def sizes(truth: Mapping[str, float]) -> dict[str, float]:
    angle = 0.1 * truth["pretension"] / (truth["cable_stiffness"] * truth["pulley_radius"])
    found = {name: angle if "angle" in name else 2.0 for name in BIASES}
    return found | dict.fromkeys(DELAYS, 0.003)


def strengthen(
    name: str, amplitude: float, *, truth: Mapping[str, float], shape: Mapping[str, float], seed: int
) -> dict[str, float] | None:
    """Parameters of contacts, cables and unknown causes; the joint and the sensors are as elsewhere."""
    element, _, effect = name.partition(":")
    if element == unknown.PREFIX:
        return _cause(effect, amplitude, truth=truth, seed=seed)
    speed = shape["stribeck_velocity"] * truth["pulley_radius"]
    found = {
        "contact:viscous": {"contact_viscous": amplitude * truth["contact_viscous"]},
        "contact:stribeck": {"contact_excess": 0.4 * amplitude, "contact_stribeck_velocity": speed},
        "contact:asymmetry": {"contact_asymmetry": 0.15 * shape["sign"] * amplitude},
        "contact:coulomb": {"contact_coulomb": 0.05 * truth["pretension"] * amplitude},
        "contact:load_dependence": {"contact_load_dependence": 0.05 * amplitude},
        "cable:viscous": {"cable_viscous": 0.01 * truth["cable_stiffness"] * amplitude},
        "ends:compliance": {"ends_compliance": 0.1 * amplitude / truth["cable_stiffness"]},
    }
    return found.get(name)


def _cause(cause: str, amplitude: float, *, truth: Mapping[str, float], seed: int) -> dict[str, float]:
    draw = np.random.default_rng([seed, 4])
    place, width, time = draw.uniform(-0.3, 0.3), draw.uniform(0.08, 0.2), draw.uniform(0.3, 1.0)
    found = {
        "bump": {"bump": amplitude, "bump_angle": place, "bump_width": width},
        "warming": {"warming": amplitude, "warming_time": 200.0 * time},
        "dwell": {"dwell": amplitude, "dwell_time": 0.3 * time, "dwell_distance": 0.005 * truth["pulley_radius"]},
        "creep": {"creep": amplitude, "creep_time": time},
        "eccentric": {"eccentric": 0.01 * amplitude, "eccentric_phase": 10.0 * place},
    }
    return {name: float(value) for name, value in found[cause].items()}


CCSRM = System(
    kind="ccsrm",
    title="Synthetic pair of joints coupled by two S-shaped cables, one joint driven",
    slots=(Slot("contact", USUAL_SPEED, USUAL_TENSION), Slot("joint", 1.0, 0.3)),
    inputs=(Input("driver_angle", "q2", "rad", "%.7f", False),),
    outputs=OUTPUTS,
    optional=("tension_12", 0.4, ("sensor.tension_12:bias", "sensor.tension_12:delay")),
    effects=(
        *(f"joint:{effect}" for effect in FRICTION),
        *(f"contact:{effect}" for effect in ("viscous", "stribeck", "asymmetry", "coulomb", "load_dependence")),
        "cable:viscous",
        "ends:compliance",
        *BIASES,
        *DELAYS,
    ),
    nominal_effects=("contact:capstan", "contact:presliding", "contact:viscous", "joint:coulomb", "joint:viscous"),
    typical=TYPICAL,
    exact=("pulley_radius", "initial_wrap_angle"),
    contract=CONTRACT,
    sizes=sizes,
    forms={"compliance": ("linear", "stiffening"), "cable:viscous": ("linear", "relaxing")},
    largest={"compliance": 8.0, "eccentric": 4.0},
    causes=("bump", "warming", "dwell", "creep", "eccentric"),
    strengthen=strengthen,
    rivals=RIVALS,
    session=session,
    sample_times=(0.01, 0.004),
    duration=4.8,
    coarse_step=1e-3,
    fine_step=2e-4,
    simulate=simulate,
)

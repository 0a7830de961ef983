"""The bench of S3: a drive and a load that two pretensioned cables in sheaths join.

A rig has a friction coefficient, a gate that holds the output at low speed, and viscous friction; what its cables and
sheaths do is in `bowden_sheath` and `bowden_plant`, what it is put through in `bowden_session`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tendonlab.blind.description import Input, Output, Slot, System

from .bowden_plant import simulate
from .bowden_session import session

TYPICAL = {
    "input_radius": 0.05,
    "output_radius": 0.05,
    "sheath_length": 1.0,
    "cable_stiffness": 1e5,
    "pretension": 150.0,
    "wrap_angle": 4.2,
    "friction_coefficient": 0.07,
    "static_friction_coefficient": 0.08,  # between the two the velocity is below the gate's: the logs do not show them
    "stribeck_velocity": 0.012,
    "threshold_velocity": 0.05,
    "threshold_slope": 4000.0,
    "sheath_viscous": 1.0,
}
FREE = ("friction_coefficient", "threshold_velocity", "threshold_slope", "sheath_viscous")
CONSTANTS = ("actuation:offset", "sensor.output_torque:bias", "sheath:asymmetry")
LATE = ("sensor.output_torque:delay", "sheath:presliding", "cable:compliance")
GAINS = ("actuation:gain_error", "sheath:curvature_skew", "sheath:load_dependence")
LEVELS = ("sheath:coulomb", "sheath:slack", "sheath:load_dependence", "sheath:stribeck")
RIVALS: dict[str, tuple[str, ...]] = {}
for group in (CONSTANTS, LATE, GAINS, LEVELS):
    RIVALS |= {name: (*RIVALS.get(name, ()), *(other for other in group if other != name)) for name in group}


def friction_level(truth: Mapping[str, float]) -> float:
    """Dry friction of the bends, N*m."""
    hold = 2.0 * truth["output_radius"] * truth["pretension"]
    return float(hold * -np.expm1(-truth["friction_coefficient"] * truth["wrap_angle"]))


def sizes(truth: Mapping[str, float]) -> dict[str, float]:
    level = friction_level(truth)
    return {
        "sheath:curvature_skew": 0.4,
        "sheath:slack": 0.5,
        "cable:compliance": 0.5,
        "actuation:gain_error": 0.05,
        "actuation:offset": 0.1 * level,
        "actuation:drive_inertia": 0.1,
        "sensor.output_torque:bias": 0.1 * level,
        "sensor.output_torque:delay": 0.003,
    }


def strengthen(
    name: str, amplitude: float, *, truth: Mapping[str, float], shape: Mapping[str, float], seed: int
) -> dict[str, float] | None:
    """Parameters of friction and of the unknown causes at `amplitude`."""
    draw = np.random.default_rng([seed, 5])
    first, second = draw.uniform(0.0, 1.0, 2)
    level = friction_level(truth)
    signed = shape["sign"] * amplitude
    found = {
        "sheath:coulomb": {"sheath_coulomb": 0.3 * level * amplitude},
        "sheath:viscous": {"sheath_viscous": truth["sheath_viscous"] * amplitude},
        "sheath:stribeck": {
            "sheath_static_excess": 0.3 * level * amplitude,
            "sheath_stribeck_velocity": 3.0 * shape["stribeck_velocity"],
        },
        "sheath:load_dependence": {"sheath_load_dependence": 0.05 * amplitude},
        "sheath:asymmetry": {
            "sheath_level_asymmetry": 0.2 * shape["asymmetry_mix"] * signed,
            "sheath_viscous_asymmetry": 0.5 * signed * truth["sheath_viscous"],
        },
        "sheath:presliding": {"sheath_bristle_stiffness": level / (0.01 * (0.1 + amplitude))},
        "unknown:bump": {"bump": amplitude, "bump_angle": 0.4 * first - 0.2, "bump_width": 0.08 + 0.12 * second},
        "unknown:warming": {"warming": amplitude, "warming_time": 100.0 + 200.0 * first},
        "unknown:dwell": {
            "dwell": amplitude,
            "dwell_time": 0.1 + 0.2 * first,
            "dwell_distance": 0.05 + 0.1 * second,
        },
        "unknown:fade": {"fade": amplitude, "fade_time": 1.0 + 2.0 * first, "fade_torque": 10.0},
        "unknown:settling": {"settling": amplitude, "settling_time": 2.0 + 4.0 * first},
    }
    return {key: float(value) for key, value in found[name].items()} if name in found else None


BOWDEN_PAIR = System(
    kind="bowden_pair",
    title="Synthetic bench of two pretensioned cables in sheaths",
    slots=(Slot("sheath", 0.4, 10.0),),
    inputs=(
        Input("input_torque", "u", "N*m", "%.5f", False),
        Input("input_velocity", "w", "rad/s", "%.6f", False),
    ),
    outputs=(Output("output_torque", "y", "N*m", "%.5f", 0.06, 0.04, 0.97, 0.01),),
    effects=(
        *(f"sheath:{name}" for name in ("curvature_skew", "slack", "coulomb", "viscous")),
        *(f"sheath:{name}" for name in ("stribeck", "presliding", "load_dependence", "asymmetry")),
        "cable:compliance",
        *(f"actuation:{name}" for name in ("gain_error", "offset", "drive_inertia")),
        *(f"sensor.output_torque:{name}" for name in ("bias", "delay")),
    ),
    nominal_effects=("sheath:capstan", "sheath:viscous"),
    typical=TYPICAL,
    exact=tuple(name for name in TYPICAL if name not in FREE),
    contract={"actuation_drive_inertia": "actuation_inertia", "cable_compliance": "cable_stretch_share"},
    sizes=sizes,
    forms={
        "presliding": ("bristle", "bristles in turn"),
        "slack": ("by torque", "by tension"),
        "curvature_skew": ("linear", "at the ends"),
        "compliance": ("linear", "stiffening"),
    },
    largest={
        "curvature_skew": 2.5,
        "slack": 2.0,
        "compliance": 4.0,
        "drive_inertia": 8.0,
        "bump": 4.0,
        "settling": 0.6,
    },
    causes=("bump", "warming", "dwell", "fade", "settling"),
    strengthen=strengthen,
    rivals=RIVALS,
    twins=lambda effect, outputs: tuple(x for x in CONSTANTS[:2] if effect in CONSTANTS[:2] and x != effect),
    session=session,
    sample_times=(0.01, 0.005, 0.004),
    duration=12.0,
    coarse_step=0.004,
    fine_step=0.004,
    simulate=simulate,
    is_quasistatic=True,
)

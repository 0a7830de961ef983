"""Effects that every kind of rig has: their functional forms, sizes and limits."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

FRICTION = ("coulomb", "viscous", "stribeck", "presliding", "load_dependence", "asymmetry")
FORMS = {  # the documented form first; effects that are not here have but one
    "coulomb": ("constant", "fading with speed"),
    "viscous": ("linear", "power of speed"),
    "stribeck": ("gaussian", "lorentzian"),
    "presliding": ("lugre", "dahl", "maxwell slip"),
    "load_dependence": ("proportional", "power of load"),
    "asymmetry": ("by direction", "by direction and speed"),
    "backlash": ("deadzone", "smooth"),
    "deadband": ("deadzone", "smooth"),
}
SIGNED = ("offset", "gain_error", "bias")
LARGEST = {  # amplitude; a rig with more of the effect would be repaired, not diagnosed
    "coulomb": 3.0,
    "viscous": 4.0,
    "stribeck": 2.0,
    "presliding": 6.0,
    "load_dependence": 5.0,
    "asymmetry": 1.9,
    "backlash": 6.0,
    "offset": 6.0,
    "gain_error": 4.0,
    "deadband": 6.0,
    "delay": 7.0,
    "bias": 10.0,
}


def draw_shape(draw: np.random.Generator) -> dict[str, float]:
    """The numbers that fix an effect, except for its amplitude."""
    return {
        "sign": float(draw.choice([-1.0, 1.0])),
        "stribeck_velocity": float(np.exp(draw.uniform(np.log(0.03), np.log(0.15)))),
        "bristle_damping_ratio": float(draw.uniform(0.05, 0.3)),
        "asymmetry_mix": float(draw.uniform(-0.6, 0.6)),
    }


def position_loop(
    draw: np.random.Generator, *, inertia: float, bandwidth: tuple[float, float], limit: float
) -> dict[str, float]:
    """A PD loop of `inertia`, kg*m^2, of a `bandwidth`, rad/s, drawn from this range; `limit`: of its torque, N*m."""
    speed = draw.uniform(*bandwidth)
    return {"kp": inertia * speed**2, "kd": 1.4 * inertia * speed, "limit": limit}


def friction(
    name: str, amplitude: float, *, truth: Mapping[str, float], shape: Mapping[str, float]
) -> dict[str, float]:
    """Parameters of the friction effect `name` ("joint:stribeck") at `amplitude`."""
    element, _, effect = name.partition(":")
    speed = truth["gear_ratio"] if element == "motor" else 1.0
    coulomb = truth.get(f"{element}_coulomb", 0.0)
    if effect == "stribeck":
        velocity = shape["stribeck_velocity"] * speed
        return {f"{element}_static_excess": amplitude * coulomb, f"{element}_stribeck_velocity": velocity}
    if effect == "presliding":
        stiffness = coulomb / (0.01 * amplitude * speed)
        damping = shape["bristle_damping_ratio"] * np.sqrt(stiffness * truth[f"{element}_inertia"])
        return {f"{element}_bristle_stiffness": stiffness, f"{element}_bristle_damping": float(damping)}
    if effect == "load_dependence":
        return {f"{element}_load_dependence": 0.05 * amplitude}
    if effect == "asymmetry":  # a level alone is a constant torque, so viscous friction always differs clearly
        signed, viscous = shape["sign"] * amplitude, truth[f"{element}_viscous"]
        return {
            f"{element}_level_asymmetry": 0.3 * shape["asymmetry_mix"] * signed,
            f"{element}_viscous_asymmetry": 0.5 * signed * viscous,
        }
    return {f"{element}_{effect}": amplitude * truth[f"{element}_{effect}"]}  # Coulomb, viscous

"""The effects of blind rigs: amplitude 0 is off, what is proportional is so, and 1 is the documented size."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.blind.description import System
from tendonlab.blind.rig import draw_rig, effect_parameters, largest_amplitude
from tendonlab.blind.systems import RIGID_JOINT, SYSTEMS, TWO_INERTIA

TRUTH = {
    "gear_ratio": 8.0, "motor_coulomb": 0.03, "motor_viscous": 2e-4, "motor_inertia": 1e-4, "joint_coulomb": 0.2,
    "joint_viscous": 0.05, "joint_inertia": 0.01,
}  # fmt: skip
SHAPE = {"sign": -1.0, "stribeck_velocity": 0.05, "bristle_damping_ratio": 0.2, "asymmetry_mix": 0.5}


def of(effect: str, amplitude: float, *, system: System = TWO_INERTIA, truth: dict[str, float] = TRUTH) -> Any:
    rig: Any = SimpleNamespace(system=system, effect=effect, truth=truth, shape=SHAPE)
    return effect_parameters(rig, amplitude)


EXPECTED = {
    "joint:coulomb": {"joint_coulomb": 0.2},
    "motor:viscous": {"motor_viscous": 2e-4},
    "joint:stribeck": {"joint_static_excess": 0.2, "joint_stribeck_velocity": 0.05},
    "motor:stribeck": {"motor_static_excess": 0.03, "motor_stribeck_velocity": 0.4},  # turns eight times as fast
    "joint:load_dependence": {"joint_load_dependence": 0.05},
    "joint:asymmetry": {"joint_level_asymmetry": -0.15, "joint_viscous_asymmetry": -0.025},
    "cable:backlash": {"cable_backlash": 0.01},
    "load:offset": {"load_offset": -0.1},
    "actuation:offset": {"actuation_offset": -0.01},
    "actuation:gain_error": {"actuation_gain_error": -0.08},
    "actuation:delay": {"actuation_delay": 0.002},
    "sensor.joint_angle:bias": {"sensor.joint_angle_bias": -0.01},
    "sensor.cable_torque:bias": {"sensor.cable_torque_bias": -0.05},
}


@pytest.mark.parametrize("effect", EXPECTED)
def test_an_effect_of_amplitude_one_has_its_documented_size(effect: str) -> None:
    assert of(effect, 1.0) == pytest.approx(EXPECTED[effect])
    shapes = {"joint_stribeck_velocity", "motor_stribeck_velocity"}
    tripled = {name: value * (1.0 if name in shapes else 3.0) for name, value in EXPECTED[effect].items()}
    assert of(effect, 3.0) == pytest.approx(tripled)


@pytest.mark.parametrize(("element", "speed"), [("joint", 1.0), ("motor", 8.0)])
def test_bristles_break_away_after_a_hundredth_of_a_radian_of_the_joint(element: str, speed: float) -> None:
    """The damping is the stated share of √(k·J)."""
    found = of(f"{element}:presliding", 2.0)
    stiffness = found[f"{element}_bristle_stiffness"]
    assert TRUTH[f"{element}_coulomb"] / stiffness == pytest.approx(0.02 * speed)
    damping = 0.2 * np.sqrt(stiffness * TRUTH[f"{element}_inertia"])
    assert found[f"{element}_bristle_damping"] == pytest.approx(damping)


def test_every_effect_has_a_largest_amplitude() -> None:
    for system in SYSTEMS.values():
        for effect in system.effects:
            assert largest_amplitude(SimpleNamespace(effect=effect, system=system)) > 1.0  # type: ignore[arg-type]


def test_effects_of_a_sign_are_drawn_with_both() -> None:
    draws = [np.random.default_rng(seed) for seed in range(12)]
    rigs = [draw_rig(draw, effect="load:offset", kind="effect", num_samples=20) for draw in draws]
    assert {rig.shape["sign"] for rig in rigs} == {-1.0, 1.0}


JOINT = {"joint_inertia": 0.05, "gravity_torque": 1.8, "joint_viscous": 0.08, "joint_coulomb": 0.15}


@pytest.mark.parametrize(
    ("effect", "expected"),
    [
        ("joint:stribeck", {"joint_static_excess": 0.15, "joint_stribeck_velocity": 0.05}),
        ("load:offset", {"load_offset": -0.09}),
        ("actuation:offset", {"actuation_offset": -0.09}),
        ("actuation:deadband", {"actuation_deadband": 0.045}),
        ("actuation:delay", {"actuation_delay": 0.003}),
        ("sensor.joint_velocity:bias", {"sensor.joint_velocity_bias": -0.02}),
    ],
)
def test_effects_of_a_rigid_joint_have_their_documented_size(effect: str, expected: dict[str, float]) -> None:
    assert of(effect, 1.0, system=RIGID_JOINT, truth=JOINT) == pytest.approx(expected)

"""The friction level of the blind twins at points where its terms have known values."""

import numpy as np
import pytest

from tendonlab.blind.friction import Friction
from tendonlab.blind.systems import TWO_INERTIA


@pytest.mark.parametrize(("form", "left"), [(0, np.exp(-1.0)), (1, 0.5)])
def test_the_static_excess_adds_to_the_level_and_falls_with_speed(form: int, left: float) -> None:
    """All of the excess at rest, the share `left` at the Stribeck velocity, none at high speed."""
    speeds = np.array([0.0, 0.05, -0.05, 1e3])
    stated = {"joint_coulomb": 0.2, "joint_static_excess": 0.1, "joint_stribeck_velocity": 0.05}
    lanes = {name: np.full(speeds.size, value) for name, value in stated.items()}
    friction = Friction(
        lanes, slots=TWO_INERTIA.slots, scale=np.ones((2, speeds.size)), form=np.full(speeds.size, form)
    )
    velocity = np.stack([np.zeros_like(speeds), speeds])
    motor, joint = friction.level(velocity, load=np.zeros_like(velocity), direction=np.sign(velocity))
    np.testing.assert_allclose(joint, 0.2 + 0.1 * np.array([1.0, left, left, 0.0]), atol=1e-9)
    assert np.all(motor == 0.0)


def friction(form: int = 0, num: int = 4, **stated: float) -> Friction:
    """Lanes of one form with these parameters."""
    lanes = {name: np.full(num, value) for name, value in stated.items()}
    return Friction(lanes, slots=TWO_INERTIA.slots, scale=np.ones((2, num)), form=np.full(num, form))


def joint(*values: float) -> np.ndarray:
    """A quantity of both slots, at the joint alone."""
    return np.array([np.zeros(len(values)), values])


def test_a_level_scales_from_run_to_run_and_is_never_negative() -> None:
    lanes = {"joint_coulomb": np.full(2, 0.2), "joint_level_asymmetry": np.array([0.5, -3.0])}
    found = Friction(
        lanes, slots=TWO_INERTIA.slots, scale=np.array([[1.0, 1.0], [1.1, 1.0]]), form=np.zeros(2, dtype=int)
    )
    level = found.level(joint(1.0, 1.0), load=joint(0.0, 0.0), direction=joint(1.0, 1.0))
    assert level[1] == pytest.approx([0.2 * 1.5 * 1.1, 0.0])


@pytest.mark.parametrize(("form", "growth"), [(0, 1.0), (1, 1.15)])
def test_an_asymmetric_level_differs_by_direction_and_in_the_other_form_grows_with_speed(
    form: int, growth: float
) -> None:
    """By 30 % at high speed, by half of that at the usual speed of 1 rad/s."""
    of = friction(form, 2, joint_coulomb=0.2, joint_level_asymmetry=0.1)
    _, level = of.level(joint(1.0, -1.0), load=joint(0.0, 0.0), direction=joint(1.0, -1.0))
    assert level == pytest.approx(0.2 * (1.0 + 0.1 * growth * np.array([1.0, -1.0])))


@pytest.mark.parametrize(("form", "sizes"), [(0, [0.5, 1.0, 2.0]), (1, [0.5**0.9, 1.0, 2.0**0.9])])
def test_a_level_grows_with_the_size_of_the_load(form: int, sizes: list[float]) -> None:
    of = friction(form, 3, joint_coulomb=0.2, joint_load_dependence=0.05)
    _, level = of.level(joint(1.0, 1.0, 1.0), load=joint(0.5, -1.0, 2.0), direction=joint(1.0, 1.0, 1.0))
    assert level == pytest.approx(0.2 + 0.05 * np.array(sizes))


@pytest.mark.parametrize(("form", "sizes"), [(0, [0.5, 1.0, 2.0]), (1, [0.5**0.9, 1.0, 2.0**0.9])])
def test_the_contact_grows_with_the_torque_of_the_cable(form: int, sizes: list[float]) -> None:
    of = friction(form, 3, contact_load_dependence=0.05)
    assert of.contact_level(np.array([0.5, -1.0, 2.0])) == pytest.approx(0.05 * np.array(sizes))


@pytest.mark.parametrize(("form", "growth"), [(0, [1.0, 1.0, 1.0]), (1, [1.2, 1.15, 1.3])])
def test_viscous_asymmetry_drags_one_way(form: int, growth: list[float]) -> None:
    """In the other form more so at low speed: by 30 % at rest, by half of that at 1 rad/s."""
    of = friction(form, 3, joint_viscous=0.4, joint_viscous_asymmetry=0.1)
    speeds = np.array([0.5, -1.0, 1e-9])
    _, drag = of.smooth(joint(*speeds))
    assert drag == pytest.approx(0.4 * speeds + 0.1 * np.abs(speeds) * np.array(growth))


def test_the_other_forms_of_coulomb_and_viscous_friction_fade_and_bend() -> None:
    """Coulomb friction loses 8 % at high speed, half of it at 1 rad/s; viscous friction follows a power of 0.93."""
    of = friction(0, 3, joint_coulomb=0.2, joint_viscous=0.4)
    assert of.is_plain
    chosen = np.array([True, True, False])
    of.choose_other_form(1, chosen, effect="coulomb")
    of.choose_other_form(1, chosen, effect="viscous")
    assert not of.is_plain
    speeds = joint(1.0, 1e9, 1.0)
    _, level = of.level(speeds, load=joint(0.0, 0.0, 0.0), direction=np.sign(speeds))
    assert level == pytest.approx([0.2 * 0.96, 0.2 * 0.92, 0.2])
    _, drag = of.smooth(joint(2.0, -0.5, 2.0))
    assert drag == pytest.approx([0.4 * 2.0**0.93, -0.4 * 0.5**0.93, 0.8], rel=1e-6)


@pytest.mark.parametrize("name", ["static_excess", "load_dependence", "bristle_stiffness", "level_asymmetry"])
def test_a_rig_with_any_further_term_is_not_plain(name: str) -> None:
    assert not friction(joint_coulomb=0.2, **{f"joint_{name}": 0.1}).is_plain
    assert not friction(motor_coulomb=0.2, **{f"motor_{name}": 0.1}).is_plain
    assert not friction(contact_load_dependence=0.1).is_plain


def pushed(form: int, *, speed: float, steps: int, level: float = 0.3) -> np.ndarray:
    """Force of a bristle of 100 N·m/rad under a constant speed, 0.1 ms per step."""
    of = friction(form, 1, joint_bristle_stiffness=100.0, joint_bristle_damping=0.0)
    state, force = of.bristle(), []
    for _ in range(steps):
        both = of.bristle_force(state, joint(speed), level=joint(level), step=1e-4)
        force.append(both[1, 0])
    return np.array(force)


@pytest.mark.parametrize("form", [0, 1, 2])
def test_bristles_begin_elastic_and_end_at_the_level(form: int) -> None:
    """Within a hundredth of what breaks them away the force is stiffness times deflection; in the end it is the level,
    which Dahl's law nears slowly; the other way round it is the same with the other sign."""
    force = pushed(form, speed=0.01, steps=40_000)
    assert force[2] == pytest.approx(100.0 * 3e-6, rel=0.01)
    assert force[-1] == pytest.approx(0.3, rel=0.03)
    assert np.all(np.diff(force) >= -1e-12)
    assert pushed(form, speed=-0.01, steps=100) == pytest.approx(-force[:100])


def test_lugre_deflects_exponentially() -> None:
    """z = (level / stiffness) (1 - exp(-stiffness |x| / level)); Dahl with exponent 1.6 in its own closed form."""
    x = 0.01 * 1e-4 * np.arange(1, 40_001)
    assert pushed(0, speed=0.01, steps=40_000) == pytest.approx(0.3 * (1.0 - np.exp(-100.0 * x / 0.3)), rel=2e-3)
    left = (1.0 + 0.6 * 100.0 * x / 0.3) ** (-1.0 / 0.6)
    assert pushed(1, speed=0.01, steps=40_000) == pytest.approx(0.3 * (1.0 - left), rel=2e-3)


def test_three_slip_elements_yield_one_after_the_other() -> None:
    """Shares of the level over shares of the stiffness: they yield at 0.25/0.55, 0.35/0.3 and 0.4/0.15 of level over
    stiffness."""
    x = 0.01 * 1e-4 * np.arange(1, 20_001)
    shares = zip((0.55, 0.3, 0.15), (0.25, 0.35, 0.4), strict=True)
    expected = sum(np.minimum(stiffness * 100.0 * x, share * 0.3) for stiffness, share in shares)
    assert pushed(2, speed=0.01, steps=20_000) == pytest.approx(expected, abs=1e-9)


def test_bristle_damping_acts_while_the_deflection_changes() -> None:
    of = friction(0, 1, joint_bristle_stiffness=100.0, joint_bristle_damping=2.0)
    force = of.bristle_force(of.bristle(), joint(0.01), level=joint(1e9), step=1e-4)
    assert force[1, 0] == pytest.approx(100.0 * 1e-6 + 2.0 * 0.01)
    assert force[0, 0] == 0.0  # the motor has no bristles

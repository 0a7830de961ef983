"""S1's parts by themselves: bad input, plans, steady averages, bearings, the arm, the force display."""

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.errors import DatasetError
from tendonlab.mechanics.tendons import BranchLosses, Reducer, TendonTransmission
from tendonlab.papers import s1


def test_what_is_no_transmission_is_refused() -> None:
    one = np.ones(2)
    for radius, said in (
        (np.array([[1.0, 0.5], [0.2, 1.0]]), "lower triangular"),
        (np.array([[1.0, 0.0], [0.2, 0.0]]), "no 0 on the diagonal"),
        (np.ones((3, 3)), r"shape \(2, 2\)"),
    ):
        with pytest.raises(tl.ParameterError, match=said):
            TendonTransmission(radius=radius, motor_radius=one)
    losses = {"constant": np.zeros((2, 2)), "viscous": np.zeros((2, 2))}
    with pytest.raises(tl.ParameterError, match=r"tension loss = .*: expected values in \[0, 1.0\)"):
        BranchLosses(tension=np.array([[1.0, 0.0], [0.0, 0.0]]), **losses)
    with pytest.raises(tl.ParameterError, match="reducers: 1 given, expected 2"):
        TendonTransmission(radius=np.eye(2), motor_radius=one, reducers=[None])
    device = TendonTransmission(radius=np.eye(2), motor_radius=one)
    with pytest.raises(tl.ParameterError, match=r"torque of shape \(3,\): expected"):
        device.statics.inverse(np.zeros(3), np.zeros(2))
    with pytest.raises(tl.ParameterError, match=r"model = .*: expected ideal, eq11, eq12 or full"):
        device.statics.inverse(np.zeros(2), np.zeros(2), model="eq13")
    with pytest.raises(tl.ParameterError, match="torque = nan: expected finite numbers"):
        device.statics.inverse([np.nan, 0.0], np.zeros(2))


def test_seven_joints_work_as_four_do() -> None:
    rng = np.random.default_rng(3)
    radius = np.tril(rng.uniform(-0.02, 0.02, (7, 7)), -1) + np.diag(rng.uniform(0.03, 0.06, 7))
    shares = {"constant": 1.0, "tension": 0.03, "viscous": 4.0}
    losses = BranchLosses(**{name: most * rng.uniform(size=(7, 7)) for name, most in shares.items()})
    reducers = [Reducer(efficiency=0.8, ratio=3.0), *[None] * 5, Reducer(efficiency=0.7, driven_back=0.5)]
    motor_reducers = [None, Reducer(efficiency=0.95), *[None] * 5]
    device = TendonTransmission(
        radius=radius, motor_radius=np.full(7, 0.01), losses=losses, reducers=reducers, motor_reducers=motor_reducers
    )
    torque, velocity = rng.normal(size=(20, 5, 7)), rng.normal(size=(20, 5, 7))
    motors = device.statics.inverse(torque, velocity)
    assert motors.tension.shape == (20, 5, 7, 8)
    back = device.statics.direct(motors.torque, velocity)
    np.testing.assert_allclose(back.torque, torque, rtol=1e-10, atol=1e-12)
    joint = device.kinematics.motor_to_joint(device.kinematics.joint_to_motor(velocity))
    np.testing.assert_allclose(joint, velocity, rtol=1e-12, atol=1e-12)


def test_a_single_motor_moves_the_joints_behind_it() -> None:
    """S1 eq. 14, by its own recursion."""
    device = s1.example_device()
    plan = s1.plan_identification(device, 2, strategy="S1", speeds=(3.0, -3.0))
    radius, moved = device.radius, np.zeros(4)
    moved[1] = device.motor_radius[1] / radius[1, 1] * 3.0
    for i in (2, 3):
        moved[i] = -sum(radius[i, k] / radius[i, i] * moved[k] for k in range(1, i))
    np.testing.assert_allclose(plan.joint_velocity[0], moved, rtol=1e-12)
    np.testing.assert_array_equal(plan.motor_velocity[0], [0.0, 3.0, 0.0, 0.0])
    other = s1.plan_identification(device, 2, strategy="S2", speeds=(3.0, -3.0))
    np.testing.assert_allclose(other.motor_velocity[0, 2], radius[2, 1] * other.joint_velocity[0, 1] / 0.01, rtol=1e-12)
    with pytest.raises(tl.ParameterError, match="expected each of them in both directions"):
        s1.plan_identification(device, 2, strategy="S2", speeds=(3.0, 2.0))
    with pytest.raises(tl.ParameterError, match="joint = 5: expected 1 to 4"):
        s1.plan_identification(device, 5, strategy="S2", speeds=(3.0, -3.0))


def test_steady_averages_keep_friction_and_lose_gravity() -> None:
    """Joint 1 to and fro over the same range under gravity, at three speeds; the fit then finds what was put in."""
    device = s1.example_device(reducers=False)
    rate, pieces = 500.0, []
    for speed in (2.0, 4.0, 6.0):
        reach = 6.0  # rad of the motor
        t = np.arange(0.0, reach / speed, 1 / rate)
        pieces += [
            np.column_stack([np.full_like(t, s * speed), (0 if s > 0 else reach) + s * speed * t]) for s in (1, -1)
        ]
    velocity, angle = np.concatenate(pieces).T
    joints, moving = np.zeros((len(angle), 4)), np.zeros((len(angle), 4))
    joints[:, 0], moving[:, 0] = angle * 0.012 / 0.14, velocity * 0.012 / 0.14
    load = np.zeros_like(joints)
    load[:, 0] = s1.gravity(joints)[:, 0]
    torque = device.statics.inverse(load, moving, model="eq12").torque[:, 0]
    log = pd.DataFrame(
        {"motor_velocity": velocity, "motor_torque": torque, "joint_angle": joints[:, 0]},
        index=np.arange(len(angle)) / rate,
    )
    found = s1.steady_average(log)
    fit = s1.fit_motor_friction(found["speed"].to_numpy(), found["torque"].to_numpy())
    assert fit.constant == pytest.approx(0.024, rel=2e-3)  # what interpolation between samples leaves
    assert fit.viscous == pytest.approx(0.000864, rel=2e-2)
    with pytest.raises(tl.DatasetError, match="joint_angle: missing"):
        s1.steady_average(log.drop(columns="joint_angle"))


def test_shares_of_power_add_up() -> None:
    shares = s1.shares_by_bearings([4, 2, 2])
    found = s1.decompose(0.05, 0.002, [0.012] * 3, shares_static=shares, shares_viscous=shares)
    assert found.constant @ np.full(3, 0.012) == pytest.approx(0.05, rel=1e-12)
    with pytest.raises(tl.ParameterError, match="expected 3 shares of power that add up to 1"):
        s1.decompose(0.05, 0.002, [0.012] * 3, shares_static=[0.5, 0.5, 0.5], shares_viscous=shares)


def test_a_bearing_holds_at_rest_and_drags_when_it_turns() -> None:
    bearing = s1.BallBearing(f0=2.0, viscosity=220.0, mean_diameter=33.5, alpha_b=2e-5, beta_b=1e-5)
    assert bearing.torque(0.0, 100.0, external_torque=1e-3) == 1e-3
    assert bearing.torque(0.0, 100.0, external_torque=-1.0) == pytest.approx(-2e-3)
    turning = bearing.torque([5.0, -5.0], 100.0)
    assert turning[0] == -turning[1] == pytest.approx(1e-3 + bearing.speed_torque(5.0))
    at = bearing.transition_speed
    jump = bearing.speed_torque(at) / bearing.speed_torque(at * (1 - 1e-12))
    assert jump == pytest.approx(2000 ** (2 / 3) / 160, rel=1e-9)
    smooth = s1.BallBearing(f0=2.0, viscosity=220.0, mean_diameter=33.5, continuous=True)
    assert smooth.speed_torque(at) == pytest.approx(smooth.speed_torque(at * (1 - 1e-12)), rel=1e-9)


def test_the_jacobian_is_the_derivative_of_the_position() -> None:
    arm, rng = s1.Arm(), np.random.default_rng(0)
    q, step = rng.uniform(-1.0, 1.0, (30, 4)), 1e-6
    columns = [(arm.position(q + step * e) - arm.position(q - step * e)) / (2 * step) for e in np.eye(4)]
    np.testing.assert_allclose(arm.jacobian(q), np.stack(columns, axis=-1), atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(arm.position([0.3, -0.5, 0.2, 0.0])), 0.3 * np.sqrt(2), rtol=1e-12)


def test_the_proxy_stays_on_the_surface() -> None:
    loop = s1.ForceDisplay(device=s1.example_device(), compensator=s1.FeedForward(transmission=s1.example_device()))
    wall = loop.wall
    above, inside = np.array([0.3, 0.0, -0.2]), np.array([0.3, 0.0, -0.275])
    np.testing.assert_array_equal(wall.proxy(above), above)
    np.testing.assert_allclose(wall.proxy(inside), [0.3, 0.0, -0.27])
    assert not np.any(loop.display_force(above, np.ones(3)))
    pressed = loop.display_force(inside, np.zeros(3))
    assert pressed[2] == pytest.approx(7.5 * (1 + 0.15 * np.sin(2 * np.pi * 0.3 / 0.02)), rel=1e-9)  # spring, texture
    rubbed = loop.display_force(inside, np.array([0.2, 0.0, 0.0]))
    assert rubbed[0] == pytest.approx(-0.3 * 7.5, rel=1e-6)


def test_feed_forward_lets_the_hand_feel_what_is_displayed() -> None:
    device = s1.example_device()
    errors = []
    for constant, viscous in ((0.0, 0.0), (0.8, 1.0)):
        known = s1.FeedForward(transmission=device, scale_constant=constant, scale_viscous=viscous)
        found = s1.ForceDisplay(device=device, compensator=known).run(duration=1.6)
        felt = found.loc[0.7:, ["felt_x", "felt_y", "felt_z"]].to_numpy()
        shown = found.loc[0.7:, ["displayed_x", "displayed_y", "displayed_z"]].to_numpy()
        errors.append(np.sqrt(np.mean(np.sum((felt - shown) ** 2, axis=1))))
        assert found["depth"].max() < 0.02
    assert errors[1] < 0.6 * errors[0]


@pytest.mark.parametrize(
    ("speed", "torque"),
    [
        ([1.0, -2.0, 3.0], [0.1, -0.2]),  # one torque is missing
        ([1.0, 2.0], [0.1, 0.2]),
        ([1.0, -1.0, 1.0, -1.0], [0.1, -0.1, 0.1, -0.1]),
        ([1.0, 0.0, 2.0], [0.1, 0.0, 0.2]),
    ],
    ids=["a torque short", "two speeds", "one magnitude", "at rest"],
)
def test_speeds_that_tell_no_friction_are_refused(speed: list[float], torque: list[float]) -> None:
    with pytest.raises(DatasetError, match="expected three or more, not 0, of different magnitude"):
        s1.fit_motor_friction(speed, torque)


def test_three_speeds_with_an_odd_torque_state_the_covariance_of_least_squares() -> None:
    """Torques 1 + 2 v ± d at v = 1, 2, 3: residuals d/6 times (1, -2, 1), one degree of freedom left."""
    fit = s1.fit_motor_friction([1.0, 2.0, 3.0], [3.0 + 0.06, 5.0 - 0.12, 7.0 + 0.06])
    assert (fit.constant, fit.viscous) == pytest.approx((1.0, 2.0))
    variance = 0.06**2 * 6.0
    assert fit.sd == pytest.approx(np.sqrt(variance * np.array([14.0, 3.0]) / 6.0))  # of the normal matrix 3, 6, 14

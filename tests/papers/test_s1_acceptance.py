"""Acceptance of S1: power, compensation, identification, reducers, block diagrams, and the diagnosis of its own gap."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tendonlab as tl
from diagnoses import diagnose
from tendonlab.errors import ParameterError
from tendonlab.mechanics.tendons import Propagation, TendonTransmission
from tendonlab.papers import s1
from tendonlab.papers.s1.experiments import NOISY_SPEEDS
from tendonlab.papers.s1.twin import inverse_statics

RNG = np.random.default_rng(1)
STATES = 1000
TORQUE, VELOCITY = RNG.normal(0.0, 5.0, (STATES, 4)), RNG.normal(0.0, 1.0, (STATES, 4))


def reducer_loss(device: TendonTransmission, found: Propagation, velocity: np.ndarray) -> np.ndarray:
    """Power that goes in at the driven pulleys and does not come out."""
    joints = np.arange(4)
    into = found.tension[:, joints, joints + 1] * np.diag(device.radius)
    return np.sum((into - found.own) * velocity, axis=-1)


def test_a1_without_losses_it_is_the_dual_of_the_kinematics() -> None:
    device = s1.example_device(reducers=False)
    found = device.statics.inverse(TORQUE, VELOCITY, model="ideal").torque
    wanted = np.linalg.solve(device.radius.T, TORQUE.T).T * device.motor_radius
    np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-12)
    motor = device.kinematics.joint_to_motor(VELOCITY)
    np.testing.assert_allclose(np.sum(found * motor, axis=1), np.sum(TORQUE * VELOCITY, axis=1), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("model", ["ideal", "eq11", "eq12", "full"])
@pytest.mark.parametrize("reducers", [False, True])
def test_a1_power_is_balanced(model: str, reducers: bool) -> None:
    device = s1.example_device(reducers=reducers)
    found = device.statics.inverse(TORQUE, VELOCITY, model=model)
    motor = device.kinematics.joint_to_motor(VELOCITY)
    given, taken = np.sum(found.torque * motor, axis=1), np.sum(TORQUE * VELOCITY, axis=1)
    lost = found.branch_power + reducer_loss(device, found, VELOCITY)
    assert np.max(np.abs(given - taken - lost) / (np.abs(given) + np.abs(taken) + 1)) < 1e-12
    assert np.all(found.loss * found.branch_velocity >= 0)
    assert np.all(reducer_loss(device, found, VELOCITY) > -1e-12)


@pytest.mark.parametrize("model", ["ideal", "eq11", "eq12", "full"])
@pytest.mark.parametrize("sign_velocity", [0.0, 0.002])
def test_direct_is_the_exact_inverse(model: str, sign_velocity: float) -> None:
    device = s1.example_device()
    options = {"model": model, "sign_velocity": sign_velocity}
    motors = device.statics.inverse(TORQUE, VELOCITY, **options)
    joints = device.statics.direct(motors.torque, VELOCITY, **options)
    np.testing.assert_allclose(joints.torque, TORQUE, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(joints.tension, motors.tension, rtol=1e-11, atol=1e-10)


def test_the_twin_agrees_though_it_shares_no_line() -> None:
    device = s1.example_device()
    found = device.statics.inverse(TORQUE, VELOCITY).torque
    np.testing.assert_allclose(inverse_statics(device, TORQUE, VELOCITY), found, rtol=1e-12, atol=1e-13)


def test_a2_compensation_more_than_halves_what_the_user_gives() -> None:
    found = s1.compensated(0.75)
    np.testing.assert_allclose(found.table["reduction"], [0.665, 0.592, 0.714, 0.681], atol=0.005)  # half a point
    np.testing.assert_allclose(
        found.table.loc[1, ["without", "compensated"]].astype(float), [0.4085, 0.1367], atol=5e-5
    )
    assert found.table["reduction"][1] > 0.5


def test_a3_strategy_s2_is_exact_and_s1_is_not() -> None:
    found = s1.strategies()
    s2 = found.loc["S2"]
    np.testing.assert_allclose(s2["constant"], s2["true constant"], rtol=1e-9)
    np.testing.assert_allclose(s2["viscous"], s2["true viscous"], rtol=1e-9)
    over = (found.loc["S1"]["constant"] - found.loc["S1"]["true constant"]).to_numpy()
    assert found.loc["S1"]["constant"][1] == pytest.approx(0.0375, abs=5e-5)
    assert np.all(np.diff(over) < 0)
    assert over[-1] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("passes", "sd_constant", "sd_viscous"), [(1, 0.021, 0.16), (20, 0.005, 0.036)])
def test_a3_noise_of_three_percent(passes: int, sd_constant: float, sd_viscous: float) -> None:
    """Ten identifications, each within 3 sd of the truth; and the spread is what least squares lets expect."""
    device, rng = s1.example_device(reducers=False), np.random.default_rng(7)
    constant, viscous = s1.true_motor_friction(device, 1)
    runs = [s1.noisy_identification(device, rng, passes=passes) for _ in range(1000)]
    for run in runs[:10]:
        assert abs(run.constant / constant - 1) < 3 * sd_constant
        assert abs(run.viscous / viscous - 1) < 3 * sd_viscous
    speed = np.array(NOISY_SPEEDS)
    gain = np.linalg.pinv(np.column_stack([np.sign(speed), speed])) * 0.03 * np.abs(constant + viscous * np.abs(speed))
    expected = np.sqrt(np.sum(gain**2, axis=1) / passes) / [constant, viscous]
    spread = np.std([(run.constant, run.viscous) for run in runs], axis=0) / [constant, viscous]
    np.testing.assert_allclose(spread, expected, rtol=3 / np.sqrt(2 * len(runs)))
    np.testing.assert_allclose(expected, [sd_constant, sd_viscous], rtol=0.1)  # of a simulation, stated to 2 digits


def test_a4_losses_of_tension_bias_both_strategies() -> None:
    """With every loss at work even S2 finds too much: friction itself is tension that is lost on."""
    found = s1.strategies(model="full")
    bias = found["constant"] / found["true constant"] - 1
    assert np.all(bias.loc["S2"] > 0.02)
    assert np.all(bias.loc["S1"] >= bias.loc["S2"] - 1e-12)


def test_a5_reducer() -> None:
    from tendonlab.mechanics.tendons import Reducer, back_driven_efficiency

    assert back_driven_efficiency(0.5) == 0.0
    up_and_down = s1.reducer_loop()
    more = up_and_down["motor_torque"] - up_and_down["lossless"]
    driving = np.cos(up_and_down.index.to_numpy()) > 0
    assert np.all(more[driving] > 0)
    assert np.all(more[~driving] < 0)
    with pytest.raises(tl.ParameterError, match=r"efficiency = 0.4: expected a value in \(0.5, 1\]; at 0.5 and below"):
        Reducer(efficiency=0.4)
    locked = Reducer(efficiency=0.4, allow_self_locking=True)
    assert locked.input_torque(1.0, -1.0) < 0  # the load alone does not move it: the motor has to help
    with pytest.raises(tl.NumericalError, match="no effort balances"):
        locked.output_torque(1.0, -1.0)


def test_a5_what_a_reducer_does_at_rest() -> None:
    device = s1.example_device()
    held = np.array([1.0, 0.0, 0.0, 0.0])
    torque = {
        rule: replace(device, at_rest=rule).statics.inverse(held, np.zeros(4)).torque[0]
        for rule in ("drive", "mean", "lossless")
    }
    ideal = 1.0 / 0.14 * 0.012
    assert torque["drive"] == pytest.approx(ideal / 0.9, rel=1e-12)
    assert torque["mean"] == pytest.approx(torque["lossless"], rel=1e-12)  # (10) loses alike both ways
    assert torque["lossless"] == pytest.approx(ideal, rel=1e-12)


def test_a6_over_compensation_drives_the_user_though_the_reduction_looks_better() -> None:
    less, more = s1.compensated(0.75), s1.compensated(1.2)
    assert less.active_share == 0.0
    assert less.power.min() == pytest.approx(0.131, abs=5e-4)
    assert more.active_share == pytest.approx(0.98, abs=0.005)
    assert more.power.min() == pytest.approx(-0.227, abs=5e-4)
    assert more.table["compensated"][1] == pytest.approx(0.0496, abs=5e-5)
    assert more.table["reduction"][1] > less.table["reduction"][1]


def test_what_each_effect_costs_at_motor_1() -> None:
    wanted = {
        "constant": [24.4, 24.4, 24.4], "viscous": [5.6, 5.6, 5.6],
        "tension": [0.8, 4.0, 19.9], "reducer": [4.5, 22.4, 111.7],
    }  # fmt: skip
    found = 1e3 * s1.effect_sizes()
    for name, sizes in wanted.items():
        np.testing.assert_allclose(found.loc[name], sizes, atol=0.1)


def test_the_signature_of_the_gap() -> None:
    """Constant and viscous losses (12) explain most of what the ideal transmission misses, whatever the load; what (11)
    adds to them grows with it."""
    device, at = s1.example_device(reducers=False), s1.free_motion(duration=6.0)
    left = {}
    for load in (np.zeros(4), np.full(4, 10.0)):  # N·m
        twin = inverse_statics(device, np.broadcast_to(load, at.joint_velocity.shape), at.joint_velocity)
        for model in ("ideal", "eq12", "full"):
            missed = twin - device.statics.inverse(load, at.joint_velocity, model=model).torque
            left[model, load[0]] = np.sqrt(np.mean(np.square(missed)))
    assert left["eq12", 0.0] < 0.5 * left["ideal", 0.0]
    assert left["eq12", 10.0] < 0.5 * left["ideal", 10.0]
    assert left["eq12", 10.0] > 3 * left["eq12", 0.0]
    assert left["full", 0.0] < 1e-12
    assert left["full", 10.0] < 1e-12


def test_figures_3_and_4_give_what_the_library_gives() -> None:
    three = s1.first_joints(s1.example_device(), 3)
    motor, torque, velocity = RNG.normal(size=(50, 3)), RNG.normal(size=(50, 3)), RNG.normal(size=3)
    given = s1.kinematics_diagram(three).evaluate({f"q_m{i + 1}": motor[:, i] for i in range(3)})
    solved = np.linalg.solve(three.radius, (motor * three.motor_radius).T).T
    np.testing.assert_allclose(np.stack([given[f"joint_{i + 1}"] for i in range(3)], axis=1), solved, rtol=1e-12)
    diagram = s1.statics_diagram(three, velocity)
    given = diagram.evaluate({f"C_{i + 1}": torque[:, i] for i in range(3)})
    found = three.statics.inverse(torque, velocity).torque
    np.testing.assert_allclose(np.stack([given[f"C_m{i + 1}"] for i in range(3)], axis=1), found, rtol=1e-12)


def test_everything_in_the_table_of_differences_is_within() -> None:
    found = s1.differences()
    assert found["within"].all(), found[~found["within"]]
    assert len(found) == 26
    assert found["status"].str.startswith("paper").sum() == 4


def test_the_papers_own_gap_is_diagnosed(tmp_path: Path) -> None:
    """Withheld on the twin: the loss in proportion to tension, which only more than one level of load can show."""
    rig = tl.load(s1.write_dataset(tmp_path))
    why = diagnose(rig)
    assert why.verdict == "effect"
    assert why.selected == ("cable:load_dependence",)
    assert why.shrinkage["from_refitted"]["value"] > 0.5
    found = next(e for e in why.effects if e.name == "cable:load_dependence")
    value = found.parameters["load_dependence"]["value"]
    assert 0.01 < value < 0.02  # the twin's lie between 0.01 and 0.02, by link


def test_withheld_reducers_are_found(tmp_path: Path) -> None:
    """The simulator's reducers lose nothing; those of the twin have an efficiency of 0.9."""
    why = diagnose(tl.load(s1.write_dataset(tmp_path, withheld="reducer")))
    assert why.verdict == "effect"
    assert why.selected == ("gear:efficiency",)
    assert why.shrinkage["from_refitted"]["value"] > 0.8


def test_wrong_radii_are_parameters_and_no_effect(tmp_path: Path) -> None:
    """Two driven pulleys count as 2 % larger than they are."""
    rig = tl.load(s1.write_dataset(tmp_path, withheld="radius"))
    why = diagnose(rig)
    assert why.verdict == "parameters_only"
    assert why.selected == ()
    for name in ("radius_2_2", "radius_3_3"):
        found = why.details["parameters"][name]
        assert found["value"] == pytest.approx(s1.example_device().parameters()[name], rel=4e-3)


def test_an_unknown_thing_to_withhold_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match="withheld = 'gravity'"):
        s1.write_dataset(tmp_path, withheld="gravity")

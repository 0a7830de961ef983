"""The routing as a system of the library: the same statics, and every effect on each branch or reducer."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.cli.text import identification_text
from tendonlab.mechanics.tendons import TendonTransmission
from tendonlab.papers.s1 import example_device, first_joints, free_motion, gravity

MOTION = free_motion(duration=4.0, sample_time=0.01)


def log(device: TendonTransmission) -> pd.DataFrame:
    n = device.num_joints
    motor = device.kinematics.joint_to_motor(MOTION.joint_velocity[:, :n])
    load = gravity(MOTION.joint_angle)[:, :n]
    columns = {f"motor_velocity_{i + 1}": motor[:, i] for i in range(n)}
    columns |= {f"external_torque_{i + 1}": load[:, i] for i in range(n)}
    return pd.DataFrame(columns, index=pd.Index(MOTION.time, name="t"))


def system(device: TendonTransmission, effects: dict[str, dict[str, float]] | None = None) -> tl.System:
    return tl.System(kind="tendon_routing", parameters=device.parameters()).with_effects(effects or {})


def motors(of: tl.System, device: TendonTransmission) -> np.ndarray:
    return of.simulate(log(device)).outputs.to_numpy()


def wanted(device: TendonTransmission) -> np.ndarray:
    n = device.num_joints
    return device.statics.inverse(gravity(MOTION.joint_angle)[:, :n], MOTION.joint_velocity[:, :n]).torque


def test_it_gives_the_motor_torques_of_the_transmission() -> None:
    device = example_device()
    np.testing.assert_allclose(motors(system(device), device), wanted(device), rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("num_joints", [1, 2, 3])
def test_with_fewer_joints_the_others_stand_for_nothing(num_joints: int) -> None:
    device = first_joints(example_device(), num_joints)
    found = motors(system(device), device)
    np.testing.assert_allclose(found[:, :num_joints], wanted(device), rtol=1e-12, atol=1e-14)
    assert not np.any(found[:, num_joints:])


def test_an_effect_of_the_cable_acts_on_every_branch_alike() -> None:
    device = example_device()
    losses = device.losses
    constant, tension = losses.constant + np.tri(4) * 0.3, losses.tension + np.tri(4) * 0.02
    more = TendonTransmission(
        radius=device.radius,
        motor_radius=device.motor_radius,
        losses=type(losses)(constant=constant, tension=tension, viscous=losses.viscous),
        reducers=device.reducers,
    )
    added = {"cable:coulomb": {"coulomb": 0.3}, "cable:load_dependence": {"load_dependence": 0.02}}
    np.testing.assert_allclose(motors(system(device, added), device), wanted(more), rtol=1e-12, atol=1e-14)


def test_an_effect_of_the_gear_acts_where_there_is_one() -> None:
    """Reducers of 90 % that lose a tenth of the output more are reducers of 1/(1/0.9 + 0.1); joint 3 has none."""
    from tendonlab.mechanics.tendons import Reducer

    device, efficiency = example_device(), 1 / (1 / 0.9 + 0.1)
    worse = [None if r is None else Reducer(efficiency=efficiency, ratio=r.ratio) for r in device.reducers]
    other = TendonTransmission(
        radius=device.radius, motor_radius=device.motor_radius, losses=device.losses, reducers=worse
    )
    added = system(device, {"gear:efficiency": {"efficiency_loss": 0.1, "back_driven_loss": 1.0}})
    np.testing.assert_allclose(motors(added, device), wanted(other), rtol=1e-12, atol=1e-14)


def test_a_load_that_is_wrong_by_a_factor() -> None:
    device = example_device()
    heavier = device.statics.inverse(1.1 * gravity(MOTION.joint_angle), MOTION.joint_velocity).torque
    found = motors(system(device, {"load:scale_error": {"scale_error": 0.1}}), device)
    np.testing.assert_allclose(found, heavier, rtol=1e-12, atol=1e-14)


def test_a_stiff_bristle_is_dry_friction_and_a_soft_one_comes_late() -> None:
    device = first_joints(example_device(reducers=False), 1)
    steady = wanted(device)[:, 0]
    moved = log(device)
    away = np.abs(moved["motor_velocity_1"].to_numpy()) > 1.0
    away[:5] = False  # the bristle starts unbent
    dry = {"cable:coulomb": {"coulomb": 0.0}}  # what the branches have by themselves is enough
    stiff, soft = (
        motors(system(device, {**dry, "cable:presliding": {"bristle_stiffness": k, "bristle_damping": 0.0}}), device)[
            :, 0
        ]
        for k in (1e6, 1e2)
    )
    np.testing.assert_allclose(stiff[away], steady[away], rtol=1e-6)
    assert np.max(np.abs(soft - steady)) > 0.01


PLAIN = {f"radius_{i}_{i}": 0.05 for i in range(1, 5)} | {f"motor_radius_{i}": 0.01 for i in range(1, 5)}
PLAIN |= {f"reducer_{what}_{i}": 1.0 for what in ("ratio", "efficiency") for i in range(1, 5)}
SPEED, TORQUE = ("v", "rad/s"), ("c", "N*m")


def write(folder: Path, signals: dict[str, tuple[str, str]], **named: float) -> Path:
    """A rig with cables that cross no other joint; `named` adds to its parameters. `signals`: what each one carries and
    its unit. Outputs have columns of their own."""
    time = np.linspace(0.0, 4.0, 81)
    speed = np.cos(2 * time)
    frame = pd.DataFrame({"t": time, "v": speed, "c": 0.1 * np.sin(time) + 0.02 * np.sign(speed)})
    lines = ['format = "tendonlab-dataset/1"', 'name = "two"', "[system]", 'kind = "tendon_routing"']
    lines += ["[system.parameters]", *(f"{name} = {{ value = {value} }}" for name, value in {**PLAIN, **named}.items())]
    columns = {name: name if name.startswith("motor_torque") else c for name, (c, _) in signals.items()}
    frame = frame.assign(**{name: frame[signals[name][0]] for name in columns.values() if name in signals})
    lines += ["[signals]"]
    lines += [f'{name} = {{ column = "{columns[name]}", unit = "{u}" }}' for name, (_, u) in signals.items()]
    for k in range(4):
        frame.to_csv(folder / f"{k}.csv", index=False)
        lines += ["[[experiments]]", f'name = "{k}"', f'file = "{k}.csv"']
    (folder / "dataset.toml").write_text("\n".join(lines), encoding="utf-8")
    return folder


def test_what_a_dataset_does_not_name_is_not_there(tmp_path: Path) -> None:
    """One of the cables with a loss: pulleys and reducers are all else that has to be named."""
    rig = tl.load(write(tmp_path, {"motor_velocity_1": SPEED, "motor_torque_1": TORQUE}, constant_loss_1_0=2.0))
    assert rig.parameters["viscous_loss_4_3"].value == 0.0
    assert rig.parameters["radius_2_1"].sd == 0.0
    found = rig.system().simulate(rig["0"]).outputs
    np.testing.assert_allclose(found["motor_torque_1"], 0.02 * np.sign(rig["0"].data["motor_velocity_1"]), rtol=1e-12)


def silences(rig: tl.Dataset) -> list[str]:
    return [warning for warning in rig.warnings if "not logged" in warning]


ONE = {"motor_velocity_1": SPEED, "external_torque_1": TORQUE, "motor_torque_1": TORQUE}
TWO = {"motor_velocity_2": SPEED, "external_torque_2": TORQUE, "motor_torque_2": TORQUE}


def test_an_output_that_no_logged_input_moves_is_refused(tmp_path: Path) -> None:
    told = (
        "dataset.toml, key signals.motor_torque_2: depends only on inputs that were not logged: "
        "motor_velocity_2, external_torque_2; log them, or add columns of zeros"
    )
    with pytest.raises(tl.DatasetError, match=told):
        tl.load(write(tmp_path, {**ONE, "motor_torque_2": TORQUE}))


@pytest.mark.parametrize("missing", ["motor_velocity_2", "external_torque_2"])
def test_an_input_that_counts_as_zero_is_told_where_an_output_depends_on_it(tmp_path: Path, missing: str) -> None:
    rig = tl.load(write(tmp_path, {**ONE, **{name: of for name, of in TWO.items() if name != missing}}))
    assert silences(rig) == [
        f"dataset.toml, key signals: inputs that were not logged are taken as 0: {missing}; "
        "outputs that depend on them: motor_torque_2; log them, or add columns of zeros"
    ]


def test_a_cable_that_crosses_the_joint_counts_and_one_that_does_not_does_not(tmp_path: Path) -> None:
    (warning,) = silences(tl.load(write(tmp_path, ONE, radius_2_1=0.03)))
    assert "motor_torque_1" in warning
    assert "motor_velocity_2, external_torque_2;" in warning


def test_nothing_is_told_where_all_that_counts_was_logged(tmp_path: Path) -> None:
    assert silences(tl.load(write(tmp_path, {**ONE, **TWO}))) == []


def test_a_fit_says_so_and_holds_what_belongs_to_joints_that_are_not_there(tmp_path: Path) -> None:
    alone = {"motor_velocity_1": SPEED, "motor_torque_1": TORQUE}
    found = tl.identify(tl.load(write(tmp_path, alone, constant_loss_1_0=2.0)), progress=False)
    assert any("external_torque_1" in warning for warning in found.warnings)
    assert "not logged are taken as 0" in " ".join(identification_text(found).split())
    there = {"radius_1_1", "motor_radius_1", "constant_loss_1_0"}
    assert set(found.parameters.index) - set(found.not_informed) <= there
    assert {"motor_radius_2", "radius_2_2", "radius_4_4"} <= set(found.not_informed)
    held = found.parameters.loc[list(found.not_informed)]
    np.testing.assert_allclose(held["value"], held["nominal"])
    prior = {f.name: f.sd * f.slope(f.mean) for f in found.problem.free}
    np.testing.assert_allclose(held["sd"], [prior[name] for name in held.index])
    assert (held["sd"] > 0).all()


def test_a_driven_pulley_without_radius_is_refused() -> None:
    of = system(example_device()).with_parameters({"radius_2_2": 0.0})
    with pytest.raises(tl.ParameterError, match="radius_2_2 = 0: expected a driven pulley"):
        of.simulate(log(example_device()))


def test_a_loss_that_outgrows_its_tension_is_refused() -> None:
    of = system(example_device(), {"cable:load_dependence": {"load_dependence": 1.0}})
    with pytest.raises(tl.NumericalError, match="no effort balances"):
        of.simulate(log(example_device()))


def test_its_ports_show_what_each_branch_sees() -> None:
    device = example_device()
    shown = system(device).simulate(log(device), ports=True).ports
    assert shown is not None
    found = device.statics.inverse(gravity(MOTION.joint_angle), MOTION.joint_velocity)
    for i in range(4):
        for j in range(i + 1):
            seen = shown[f"cable_{i + 1}_{j}"]
            np.testing.assert_allclose(seen["load"], found.tension[:, i, j], rtol=1e-12)
            np.testing.assert_allclose(seen["force"], found.loss[:, i, j], rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(seen["velocity"], found.branch_velocity[:, i, j], rtol=1e-12, atol=1e-15)

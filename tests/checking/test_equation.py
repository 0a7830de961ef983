"""The equation of motion along logs that are known exactly: what is left, its columns, its lags and its factors."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from checking.pendulum import CONSTANT, late_run, record
from tendonlab.checking.equation import MOST_FAILURES, Equation, _without_failures
from tendonlab.checking.lags import _scanned
from tendonlab.checking.logs import Logs, read_logs
from tendonlab.checking.scales import wrong_factors
from tendonlab.checking.terms import rms, slopes_of_lags, terms
from tendonlab.data import load

INERTIA, GRAVITY, COULOMB, VISCOUS = 0.019, 1.15, 0.06, 0.04  # as the simulator states them
TIME = np.arange(0.0, 6.0, 0.01)


@pytest.fixture(scope="module")
def equation(tmp_path_factory: pytest.TempPathFactory) -> Equation:
    rig = record().write(tmp_path_factory.mktemp("rig"))
    return Equation(rig, rig.system())


def exact(torque: np.ndarray | None = None) -> Logs:
    """A sine and its derivatives; without a `torque` the command that this motion needs without friction, in A."""
    q, v, a = 0.8 * np.sin(2 * TIME), 1.6 * np.cos(2 * TIME), -3.2 * np.sin(2 * TIME)
    needed = (INERTIA * a + GRAVITY * np.sin(q)) / CONSTANT if torque is None else torque
    driving = np.array([needed, np.gradient(needed, TIME), np.zeros_like(TIME)])
    run = np.zeros(len(TIME), dtype=int)
    return Logs({"joint_angle": np.array([q, v, a])}, {"motor_torque": driving}, {}, run, TIME, 0.01, run == 0)


def test_what_is_left_is_inertia_gravity_and_friction_less_the_torque(equation: Equation) -> None:
    logs = exact(np.cos(3 * TIME))
    q, v, a = logs.moving["joint_angle"]
    expected = INERTIA * a + GRAVITY * np.sin(q) + COULOMB * np.sign(v) + VISCOUS * v - CONSTANT * np.cos(3 * TIME)
    (left,) = equation.evaluate(equation.along(logs), len(TIME))
    moving = np.abs(v) > 0.1
    np.testing.assert_allclose(left[moving], expected[moving], atol=1e-3)  # the sign is smoothed near rest


def test_without_inputs_the_motion_alone_is_left(equation: Equation) -> None:
    logs = exact()
    stretches = [s.without_inputs(equation.system, logs.driving) for s in equation.along(logs)]
    (silent,) = equation.evaluate(stretches, len(TIME))
    (left,) = equation.evaluate(equation.along(logs), len(TIME))
    np.testing.assert_allclose(silent - left, CONSTANT * logs.driving["motor_torque"][0], atol=1e-9)


def test_a_nudge_changes_its_parameter_alone(equation: Equation) -> None:
    logs = exact()
    names = [p.name for p in equation.system.info.parameters]
    stretches = equation.along(logs)
    before, heavier = equation.nudged(stretches, len(TIME), {names.index("inertia"): 0.01})
    np.testing.assert_allclose((heavier - before)[0], 0.01 * logs.moving["joint_angle"][2], atol=1e-9)


def test_columns_are_what_their_unknowns_change(equation: Equation) -> None:
    """A relative change of a parameter; the size is the rms of the torque."""
    logs = exact()
    q, v, a = logs.moving["joint_angle"]
    found = terms(equation, logs)
    size = CONSTANT * rms(logs.driving["motor_torque"][0])
    assert found.size == pytest.approx([size], rel=1e-6)
    columns = {u.name: c[0] for u, c in zip(found.unknowns, found.columns, strict=True)}
    np.testing.assert_allclose(columns["inertia"], INERTIA * a, atol=1e-6)
    np.testing.assert_allclose(columns["gravity_torque"], GRAVITY * np.sin(q), atol=1e-6)
    np.testing.assert_allclose(columns["viscous"], VISCOUS * v, atol=1e-6)
    travel = 0.1 * np.std(q)
    np.testing.assert_allclose(columns["zero of joint_angle"], GRAVITY * np.cos(q) * travel, atol=1e-3)
    np.testing.assert_allclose(columns["offset"], size)
    np.testing.assert_allclose(columns["viscous friction"], v * size / rms(v))
    np.testing.assert_allclose(columns["dry friction"], np.sign(v) * size, rtol=1e-6)
    sds = {u.name: u.sd for u in found.unknowns}
    assert sds["inertia"] == pytest.approx(0.002 / INERTIA)
    assert (sds["viscous"], sds["coulomb"]) == (0.6, 0.6)  # the default of friction
    assert "torque_constant" not in sds  # stated with sd = 0
    positive = {u.name for u in found.unknowns if u.positive}
    assert positive == {"dry friction", "viscous friction"}
    assert {u.name for u in found.unknowns if u.logarithm} >= {"inertia", "coulomb", "viscous"}


def test_a_fit_finds_the_parameters_that_made_the_logs(equation: Equation) -> None:
    logs = exact()
    q, v, a = logs.moving["joint_angle"]
    torque = (1.1 * INERTIA * a + 0.9 * GRAVITY * np.sin(q) + 0.5 * VISCOUS * v + COULOMB * np.sign(v)) / CONSTANT
    found = terms(equation, exact(torque)).fit(np.full(1, 0.2))
    values = {u.name: x for u, x in zip(terms(equation, exact(torque)).unknowns, found.x, strict=True)}
    assert np.exp(values["gravity_torque"]) == pytest.approx(0.9, rel=0.02)
    assert np.exp(values["viscous"]) == pytest.approx(0.5, rel=0.3)
    assert found.level[0] < 0.03


def test_slopes_of_a_lag_are_those_of_the_residual(equation: Equation) -> None:
    """d/ds of inertia·a(t+s) + gravity·sin q(t+s) + viscous·v(t+s), in the middle of the record."""
    logs = exact()
    q, v, a = logs.moving["joint_angle"]
    jerk = -6.4 * np.cos(2 * TIME)
    kept = np.arange(50, 550)
    at = terms(equation, logs.at(kept))
    (slope,) = slopes_of_lags(equation, logs, at.residual, kept)
    expected = INERTIA * jerk + GRAVITY * np.cos(q) * v + VISCOUS * a
    steady = np.abs(v[kept]) > 0.1
    np.testing.assert_allclose(slope[0, steady], expected[kept][steady], atol=0.02)
    turning = np.abs(v[kept]) < 1e-3 * 3.2  # within a nudge of a reversal
    assert np.all(slope[0, turning] == 0.0)


@pytest.mark.parametrize("late", [0.1, -0.06])
def test_a_scan_finds_the_lag_of_one_experiment(late: float, tmp_path: Path) -> None:
    rig = late_run(record(), "quick", late).write(tmp_path)
    logs = read_logs(rig, rig.system().info)
    assert logs is not None
    names = [e.name for e in rig.experiments]
    seconds, nats = _scanned(Equation(rig, rig.system()), logs)
    found = dict(zip(names, seconds, strict=True))
    assert found.pop("quick") == pytest.approx(late, abs=0.3 * abs(late))
    assert set(found.values()) == {0.0}
    assert np.flatnonzero(nats > 100.0).tolist() == [names.index("quick")]
    assert np.count_nonzero(nats) == 1


def test_factors_of_right_logs_are_none_and_of_wrong_ones_come_best_first(equation: Equation, tmp_path: Path) -> None:
    logs = read_logs(equation.dataset, equation.system.info)
    assert logs is not None
    assert wrong_factors(equation, logs) == []
    found = wrong_factors(equation, logs.scaled(["motor_torque"], 1 / 60.0))
    assert found[0].signals == ("motor_torque",)
    assert found[0].value == pytest.approx(60.0, rel=0.1)
    assert [f.gain for f in found] == sorted((f.gain for f in found), reverse=True)
    assert all(f.gain > 0.97 * found[0].gain - 3.0 for f in found)


def test_conditions_that_differ_are_evaluated_apart(tmp_path: Path) -> None:
    """Twice the gravity in one experiment: the same motion leaves the difference in its samples alone."""
    logs = record()
    rig = logs.write(tmp_path)
    first, *rest = rig.experiments
    heavy = replace(first, conditions={"gravity_torque": 2 * GRAVITY})
    changed = replace(rig, experiments=(heavy, *rest))
    both = exact()
    run = np.concatenate([np.zeros(len(TIME), dtype=int), np.ones(len(TIME), dtype=int)])
    twice = replace(both.at(np.concatenate([np.arange(len(TIME))] * 2)), run=run)
    of = Equation(changed, changed.system())
    (left,) = of.evaluate(of.along(twice), len(run))
    q = both.moving["joint_angle"][0]
    np.testing.assert_allclose(left[: len(TIME)] - left[len(TIME) :], GRAVITY * np.sin(q), atol=1e-9)
    index = [p.name for p in of.system.info.parameters].index("gravity_torque")
    _, (nudged,) = of.nudged(of.along(twice), len(run), {index: 0.1})
    np.testing.assert_allclose(nudged - left, np.where(run == 0, 0.0, 0.1 * np.tile(np.sin(q), 2)), atol=1e-9)


def test_a_gain_that_one_experiment_states_scales_the_others_alone(tmp_path: Path) -> None:
    rig = record().write(tmp_path)
    first, *rest = rig.experiments
    stated = replace(first, conditions={"torque_constant": CONSTANT})
    constant = replace(rig.parameters["torque_constant"], sd=0.1 * CONSTANT)
    changed = replace(rig, experiments=(stated, *rest), parameters={**rig.parameters, "torque_constant": constant})
    both, index = exact(np.cos(3 * TIME)), np.concatenate([np.arange(len(TIME))] * 2)
    twice = replace(both.at(index), run=np.repeat([0, 1], len(TIME)))
    of = Equation(changed, changed.system())
    found = terms(of, twice)
    (column,) = found.columns[[u.name for u in found.unknowns].index("torque_constant")]
    assert not column[: len(TIME)].any()
    silent = found.residual[0] + CONSTANT * twice.driving["motor_torque"][0]  # what scales inversely
    np.testing.assert_allclose(column[len(TIME) :], silent[len(TIME) :], atol=1e-6)


def test_without_inputs_the_size_of_an_equation_is_what_it_leaves(equation: Equation) -> None:
    """And 1 where nothing is left either: a joint at rest where it hangs."""
    logs = exact(np.zeros(len(TIME)))
    found = terms(equation, logs)
    assert found.size == pytest.approx([rms(found.residual[0])])
    assert rms(found.residual[0]) > 0.1
    still = replace(logs, moving={"joint_angle": np.zeros((3, len(TIME)))})
    assert terms(equation, still).size == pytest.approx([1.0])


def test_a_gain_scales_all_but_what_drives(tmp_path: Path) -> None:
    """A servo of another resistance R: the equation, divided by what the inputs contribute per volt, in volts."""
    time = np.arange(0.0, 4.0, 0.01)
    target = np.sin(3.0 * time)
    angle = 0.9 * np.sin(3.0 * time - 0.2)
    values = {
        "inertia": 0.005, "armature": 0.003, "gravity_torque": 0.4, "torque_constant": 0.5, "resistance": 4.0,
        "proportional_gain": 20.0, "voltage_limit": 60.0, "coulomb": 0.02, "viscous": 0.01,
    }  # fmt: skip
    lines = ["format = 'tendonlab-dataset/1'", "name = 'servo'", "[system]", "kind = 'servo_pendulum'"]
    lines += ["[system.parameters]", *(f"{name} = {{ value = {value} }}" for name, value in values.items())]
    lines += ["[signals]", "target_angle = {}", "joint_angle = {}"]
    lines += ["[[experiments]]", "name = 'a'", "file = 'a.csv'", "split = 'train'"]
    (tmp_path / "dataset.toml").write_text("\n".join(lines), encoding="utf-8")
    rows = np.column_stack([time, target, angle])
    np.savetxt(tmp_path / "a.csv", rows, delimiter=",", header="t,target_angle,joint_angle", comments="")
    rig = load(tmp_path)
    logs = read_logs(rig, rig.system().info)
    assert logs is not None
    of = Equation(rig, rig.system())
    found = terms(of, logs)
    names = [u.name for u in found.unknowns]
    motor = rig.system().with_parameters({"resistance": 5.0})
    other = terms(Equation(rig, motor), logs).residual
    moved = found.residual + (5.0 / 4.0 - 1.0) * found.columns[names.index("resistance")]
    np.testing.assert_allclose(moved, 5.0 / 4.0 * other, atol=1e-3 * np.std(moved))


def test_a_few_samples_without_a_value_take_that_of_the_sample_before() -> None:
    found = np.arange(600.0).reshape(2, 3, 100)
    few = found.copy()
    few[0, 1, 0] = few[1, 2, 50] = np.nan
    kept = _without_failures(few)
    np.testing.assert_array_equal(np.delete(kept, (0, 50), axis=2), np.delete(found, (0, 50), axis=2))
    np.testing.assert_array_equal(kept[..., [0, 50]], found[..., [1, 49]])
    many = found.copy()
    many[..., : int(MOST_FAILURES * 100) + 1] = np.inf
    np.testing.assert_array_equal(_without_failures(many), many)

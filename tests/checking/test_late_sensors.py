"""A late sensor beside a stiff cable: what the cable seems to stretch is large, and no factor of a channel says why."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.checking.equation import Equation
from tendonlab.checking.logs import read_logs
from tendonlab.checking.scales import FINE, Factor, _suits_late
from tendonlab.checking.terms import terms

TRUTH = {
    "motor_inertia": 8.1e-5,
    "joint_inertia": 0.048,
    "gear_ratio": 12.0,
    "cable_stiffness": 83.0,
    "cable_damping": 0.08,
    "gravity_torque": 0.71,
    "motor_viscous": 2.5e-4,
    "motor_coulomb": 4.9e-3,
    "joint_viscous": 0.032,
    "joint_coulomb": 0.064,
}
EFFECTS = ("motor:viscous", "motor:coulomb", "joint:viscous", "joint:coulomb")
NOISE = {"motor_angle": 2e-4, "joint_angle": 1e-4, "cable_torque": 4e-3}
TIME = np.arange(0.0, 6.0, 0.005)


def logs(folder: Path, *, late: float = 0.0, factor: float = 1.0, delay: float = 0.0) -> tl.Dataset:
    """Four runs under random sines; the joint sensor is `late` seconds, the torque acts after a `delay`, s, and is
    logged times `factor`. All parameters but the gear ratio are believed to 12 %, and wrong by 8 %."""
    rng = np.random.default_rng(0)
    believed = {n: v if n == "gear_ratio" else v * np.exp(0.08 * rng.standard_normal()) for n, v in TRUTH.items()}
    stated = [f"{n} = {{ value = {v}, sd = {0 if n == 'gear_ratio' else 0.12 * v} }}" for n, v in believed.items()]
    text = ['format = "tendonlab-dataset/1"', 'name = "stiff"', '[system]\nkind = "two_inertia"', "[system.parameters]"]
    text += [*stated, *(f"[signals.{name}]" for name in ("motor_torque", *NOISE))]
    system = tl.System("two_inertia", parameters=TRUTH, effects=EFFECTS)
    for run in ("a", "b", "c", "d"):
        phases = rng.uniform(0.0, 2.0 * np.pi, 5)
        sines = np.sin(2.0 * np.pi * np.outer(TIME, [0.3, 0.7, 1.1, 1.9, 2.6]) + phases)
        torque = 0.02 + 0.018 * sines.sum(axis=1)
        acting = np.interp(TIME - delay, TIME, torque)
        motion = system.simulate(pd.DataFrame({"motor_torque": acting}, index=TIME))
        read = {name: motion[name].to_numpy() for name in NOISE}
        read["joint_angle"] = np.interp(TIME - late, TIME, read["joint_angle"])
        read = {name: y + NOISE[name] * rng.standard_normal(len(TIME)) for name, y in read.items()}
        table = pd.DataFrame({"t": TIME, "motor_torque": factor * torque, **read})
        table.to_csv(folder / f"{run}.csv", index=False)
        split = "test" if run == "d" else "train"
        text.append(f'[[experiments]]\nname = "{run}"\nfile = "{run}.csv"\nsplit = "{split}"')
    (folder / "dataset.toml").write_text("\n".join(text), encoding="utf-8")
    return tl.load(folder)


@pytest.mark.parametrize("late", [0.0, 0.004, 0.006])
def test_a_late_sensor_is_no_wrong_scale(late: float, tmp_path: Path) -> None:
    assert [f for f in tl.check(logs(tmp_path, late=late)).findings if f.blocks] == []


@pytest.mark.parametrize("late", [0.03, 0.08, 0.1])
def test_one_sensor_that_is_late_in_one_run_is_found_beside_the_others(late: float, tmp_path: Path) -> None:
    """A stiff cable makes the torque sensor follow the late angle for a while; in the end the angle alone is late."""
    data = logs(tmp_path)
    data.experiments[1].data["joint_angle"] = np.interp(TIME - late, TIME, data.experiments[1].data["joint_angle"])
    [found] = [f for f in tl.check(data).findings if f.blocks]
    assert (found.problem, found.signal, found.experiment) == ("clock", "joint_angle", "b")
    assert found.seconds == pytest.approx(late, abs=2e-3)


@pytest.mark.parametrize("delay", [0.009, 0.02])
def test_a_late_torque_is_no_wrong_sign(delay: float, tmp_path: Path) -> None:
    assert [f for f in tl.check(logs(tmp_path, delay=delay)).findings if f.blocks] == []


@pytest.mark.parametrize("factor", [1000.0, 2.0, 0.01, -1.0])
def test_a_wrong_torque_is_found_beside_a_late_sensor(factor: float, tmp_path: Path) -> None:
    [found] = [f for f in tl.check(logs(tmp_path, late=0.004, factor=factor)).findings if f.blocks]
    assert (found.problem, found.signal) == ("sign" if factor < 0 else "scale", "motor_torque")
    assert found.factor == pytest.approx(factor, rel=0.1)


@pytest.mark.parametrize(("delay", "factor", "is_late"), [(0.02, 1.0, True), (0.0, -1.0, False), (0.0, 5.0, False)])
def test_lags_are_weighed_against_a_factor(delay: float, factor: float, is_late: bool, tmp_path: Path) -> None:
    """Where the torque is late, a lag suits better than a turned sign; where it is logged wrongly, none does."""
    data = logs(tmp_path, delay=delay, factor=factor)
    equation, found = Equation(data, data.system()), read_logs(data, data.system().info)
    assert found is not None
    told = -1.0 if is_late else factor
    share = np.full(len(equation.predicted), 0.2)
    fit = terms(equation, found.thinned(FINE).scaled(["motor_torque"], told)).fit(share)
    assert _suits_late(equation, found, Factor(("motor_torque",), told, fit), share) == is_late

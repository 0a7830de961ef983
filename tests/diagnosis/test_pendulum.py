"""A pendulum that scipy integrates: swings with the motor off, and a torque that is smooth between its samples."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

import tendonlab as tl
from tendonlab.fitting.case import make_case

INERTIA, GRAVITY, VISCOUS, COULOMB, STEP = 0.021, 0.9, 0.004, 0.01, 0.01
STARTS = ((1.0, 0.0), (-0.7, 0.0), (0.5, 1.0), (1.3, -1.0))
STATED = {"inertia": 1.15 * INERTIA, "gravity_torque": 0.93 * GRAVITY, "viscous": 0.7 * VISCOUS}


def swing(
    folder: Path,
    torque: Callable[[float, int], float],
    *,
    coulomb: float = 0.0,
    by_gravity: float = 0.0,
    of_torque: str = "",
) -> tl.Dataset:
    """Four runs of 6 s, logged at 100 Hz with noise of 0.1 mrad; the last one is held out."""
    random, time = np.random.default_rng(1), np.arange(0.0, 6.0, STEP)
    text = 'format = "tendonlab-dataset/1"\nname = "pendulum"\ntime = { column = "t", unit = "s" }\n'
    text += '[system]\nkind = "rigid_joint"\nnominal_effects = ["joint:viscous"]\n[system.parameters]\n'
    text += "".join(
        f"{k} = {{ value = {v}, sd = {(0.5 if k == 'viscous' else 0.15) * v} }}\n" for k, v in STATED.items()
    )
    text += f'[signals]\nmotor_torque = {{ column = "u", unit = "N*m"{of_torque} }}\n'
    text += 'joint_angle = { column = "q", unit = "rad" }\n'
    for k, start in enumerate(STARTS):

        def rate(t: float, y: np.ndarray, k: int = k) -> tuple[float, float]:
            gravity = GRAVITY * np.sin(y[0])
            friction = VISCOUS * y[1] + (coulomb + by_gravity * abs(gravity)) * np.tanh(y[1] / 0.002)
            return y[1], (torque(t, k) - gravity - friction) / INERTIA

        angle = solve_ivp(rate, (0.0, 6.0), start, t_eval=time, rtol=1e-8, atol=1e-9, method="LSODA").y[0]
        logged = angle + 1e-4 * random.standard_normal(len(time))
        given = [torque(t, k) for t in time]
        pd.DataFrame({"t": time, "u": given, "q": logged}).to_csv(folder / f"run-{k}.csv", index=False)
        split = "test" if k == len(STARTS) - 1 else "train"
        text += f'[[experiments]]\nname = "run-{k}"\nfile = "run-{k}.csv"\nsplit = "{split}"\n'
    (folder / "dataset.toml").write_text(text)
    return tl.load(folder)


def off(_t: float, _k: int) -> float:
    return 0.0


def smooth(t: float, k: int) -> float:
    return float(0.3 * np.sin(2 * np.pi * (0.3 + 0.2 * k) * t))


@pytest.mark.cpu(30)
@pytest.mark.parametrize(("coulomb", "selected"), [(0.0, ()), (COULOMB, ("joint:coulomb",))])
@pytest.mark.parametrize("command", ["zeros", "noise"])
def test_free_swings_are_diagnosed_at_the_scale_that_is_stated(tmp_path, command, coulomb, selected) -> None:
    rig = swing(tmp_path, off, coulomb=coulomb)
    if command == "noise":
        random = np.random.default_rng(2)
        for log in tmp_path.glob("run-*.csv"):
            (read := pd.read_csv(log)).assign(u=2e-3 * random.standard_normal(len(read))).to_csv(log, index=False)
        rig = tl.load(tmp_path)
    why = tl.diagnose(rig, progress=False)
    assert why.selected == selected
    assert why.verdict == ("effect" if selected else "parameters_only")
    assert any("motor is off" in warning for warning in why.warnings)
    if selected:  # gravity, with the same relative sd but listed later, follows the inertia that is held
        found = why.effects[0].parameters["coulomb"]["value"]
        assert found == pytest.approx(1.15 * COULOMB, rel=0.03)


@pytest.mark.parametrize("is_driven", [False, True])
def test_where_a_free_swing_rests_is_told_once(tmp_path: Path, is_driven: bool) -> None:
    torque = (lambda t, k: 0.3 if t < 0.5 else 0.0) if is_driven else off
    (ready, *_) = make_case(swing(tmp_path, torque, coulomb=0.06)).prepared
    time = np.asarray(ready.core.time)
    assert np.isfinite(ready.measured[0, (time > 0.1) & (time < 0.8)]).all()
    assert np.isfinite(ready.measured[0, time > 4.0]).all() == is_driven


def test_a_held_out_run_that_is_driven_keeps_its_torque_and_its_end(tmp_path: Path) -> None:
    case = make_case(swing(tmp_path, lambda t, k: 0.4 if k == 3 else 0.0, coulomb=0.06))
    assert case.swings_freely
    assert (case.experiments[3].data["motor_torque"] == 0.4).all()
    assert np.isfinite(case.prepared[3].measured[0, -1])
    assert np.isnan(case.prepared[0].measured[0, -1])


def test_a_run_at_rest_among_swings_stays(tmp_path: Path) -> None:
    swing(tmp_path, off, coulomb=0.06)
    still = pd.read_csv(tmp_path / "run-1.csv")
    still.assign(q=1e-4 * np.random.default_rng(4).standard_normal(len(still))).to_csv(
        tmp_path / "run-1.csv", index=False
    )
    case = make_case(tl.load(tmp_path))
    assert case.motor_is_off
    assert np.isfinite(case.prepared[1].measured[0]).sum() > 500


def test_a_known_condition_tells_the_scale(tmp_path: Path) -> None:
    swing(tmp_path, off, coulomb=0.06)
    text = (tmp_path / "dataset.toml").read_text()
    weighed = text.replace('split = "train"\n', 'split = "train"\nconditions = { gravity_torque = 0.9 }\n')
    (tmp_path / "dataset.toml").write_text(weighed)
    case = make_case(tl.load(tmp_path))
    assert case.motor_is_off
    assert not case.swings_freely


@pytest.mark.cpu(30)
def test_one_driven_run_tells_the_scale(tmp_path: Path) -> None:
    kicked = swing(tmp_path, lambda t, k: 0.5 if k == 0 and 2.0 <= t < 4.0 else 0.0, coulomb=COULOMB)
    why = tl.diagnose(kicked, progress=False)
    assert why.selected == ("joint:coulomb",)
    assert why.effects[0].parameters["coulomb"]["value"] == pytest.approx(COULOMB, rel=0.03)
    assert not any("motor is off" in warning for warning in why.warnings)


@pytest.mark.cpu(30)
def test_a_torque_without_a_word_on_holding_is_taken_as_the_logs_have_it(tmp_path: Path) -> None:
    why = tl.diagnose(swing(tmp_path, smooth), progress=False)
    assert why.verdict == "parameters_only"
    assert why.warnings[0].startswith("motor_torque is taken as straight between its samples")


@pytest.mark.cpu(30)
def test_a_torque_that_is_stated_as_held_stays_so_and_is_doubted(tmp_path: Path) -> None:
    why = tl.diagnose(swing(tmp_path, smooth, of_torque=", hold = true"), progress=False)
    assert why.verdict != "parameters_only"
    assert why.warnings[0].startswith("motor_torque is stated as held between its samples")


@pytest.mark.parametrize("coulomb", [0.0, COULOMB])
def test_free_motion_tells_no_lag(tmp_path: Path, coulomb: float) -> None:
    found = tl.check(swing(tmp_path, off, coulomb=coulomb))
    assert not found.findings
    assert "the motor is off" in found.notes[0]


def test_the_late_run_keeps_its_name_where_others_are_left_out(tmp_path: Path) -> None:
    swing(tmp_path, lambda t, k: smooth(t, k) if k != 1 else 0.0, coulomb=COULOMB)
    late = pd.read_csv(tmp_path / "run-2.csv")
    late.assign(u=late.u.shift(-20, fill_value=0.0)).to_csv(tmp_path / "run-2.csv", index=False)
    (finding,) = [f for f in tl.check(tl.load(tmp_path)).findings if f.problem == "clock"]
    assert finding.experiment == "run-2"
    assert finding.seconds == pytest.approx(20 * STEP, abs=0.005)


def test_zeros_in_place_of_a_torque_that_moves_the_rig_block(tmp_path: Path) -> None:
    swing(tmp_path, lambda t, k: float(2.0 * np.sin(2 * np.pi * 0.4 * (k + 1) * t)))
    for log in tmp_path.glob("run-*.csv"):
        pd.read_csv(log).assign(u=0.0).to_csv(log, index=False)
    (problem,) = [f for f in tl.check(tl.load(tmp_path)).findings if f.blocks]
    assert (problem.problem, problem.signal) == ("uninformative", "motor_torque")


def test_free_swings_beside_one_constant_torque_load(tmp_path: Path) -> None:
    assert len(swing(tmp_path, lambda t, k: 0.4 if k == 2 else 0.0).experiments) == 4


def test_one_constant_torque_throughout_identifies_nothing(tmp_path: Path) -> None:
    with pytest.raises(tl.DatasetError, match="constant"):
        swing(tmp_path, lambda t, k: 0.4)


@pytest.mark.cpu(30)
def test_friction_in_proportion_to_gravity_is_named(tmp_path) -> None:
    """Friction at the load: all inertia sits before it."""
    why = tl.diagnose(swing(tmp_path, smooth, by_gravity=0.08), progress=False)
    assert (why.verdict, why.selected) == ("effect", ("joint:load_dependence",))
    (found,) = [each for each in why.effects if each.name == "joint:load_dependence"]
    assert found.parameters["load_dependence"]["value"] == pytest.approx(0.08, rel=0.05)
    assert found.parameters["motor_inertia_share"]["value"] > 0.9

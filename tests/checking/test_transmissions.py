"""The check on rigs without an equation of motion, on rigs of which one output is not understood, and on rigs of which
a part moves as prescribed."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.blind.description import Run
from tendonlab.blind.faults import Fault
from tendonlab.blind.rig import Rig, draw_rig
from tendonlab.blind.strength import Strength
from tendonlab.blind.systems import SYSTEMS
from tendonlab.blind.write import record, write_dataset
from tendonlab.checking.equation import Equation
from tendonlab.checking.logs import read_logs
from tendonlab.checking.scales import ROUGH, ROUGH_SHARE, _refined, _searched
from tendonlab.checking.suspects import RATIO, Suspect, suspects
from tendonlab.checking.tensions import pushing_cables

STILL = Strength(
    amplitude=0.0, gap_noise=0.0, nominal_gap_noise=0.0, floor=np.zeros(1), limited=False, met=True, separation={}
)


@cache
def logs(system: str) -> tuple[Rig, Run]:
    draw = np.random.default_rng(3)
    rig = draw_rig(draw, effect="", kind="parameters_only", system=SYSTEMS[system], excitation="rich")
    return rig, record([rig], [STILL])[0]


def written(folder: Path, system: str, fault: Fault | None = None) -> tl.Dataset:
    """The rig of that system."""
    rig, run = logs(system)
    write_dataset(replace(rig), run, folder / "rig", name="rig", description="", fault=fault)
    return tl.load(folder / "rig")


def found(folder: Path, system: str, fault: Fault | None) -> list[tuple[str, str, float]]:
    """Problem, place and size of what blocks."""
    findings = tl.check(written(folder, system, fault)).findings
    return [(f.problem, f.place, f.factor or f.seconds or 0.0) for f in findings if f.blocks]


@pytest.mark.cpu(20)  # the rigs are drawn here
@pytest.mark.parametrize("system", ["bowden_pair", "ccsrm", "cable_joint"])
def test_right_logs_pass(tmp_path: Path, system: str) -> None:
    assert found(tmp_path, system, None) == []


def test_a_turned_velocity_of_a_bowden_pair_is_found(tmp_path: Path) -> None:
    fault = Fault(problem="sign", signals=("input_velocity",), factor=-1.0)
    assert found(tmp_path, "bowden_pair", fault) == [("sign", "input_velocity", -1.0)]


@pytest.mark.parametrize("amplitude", [1.0, 5.0, 10.0])
def test_strong_friction_that_the_simulator_lacks_turns_no_velocity(tmp_path: Path, amplitude: float) -> None:
    draw, system = np.random.default_rng(3), SYSTEMS["bowden_pair"]
    rig = draw_rig(draw, effect="sheath:coulomb", kind="effect", system=system, excitation="rich")
    run = record([rig], [replace(STILL, amplitude=amplitude)])[0]
    write_dataset(rig, run, tmp_path / "rig", name="rig", description="")
    assert [f for f in tl.check(tl.load(tmp_path / "rig")).findings if f.blocks] == []


@pytest.mark.parametrize("turned", [False, True])
def test_dry_friction_lowers_what_a_sheath_passes_on(tmp_path: Path, turned: bool) -> None:
    """Beside a simulator that contains none at all. On an instrument's cables the right sign was blamed."""
    time, random = np.arange(0.0, 8.0, 0.01), np.random.default_rng(0)
    text = 'format = "tendonlab-dataset/1"\nname = "sheath"\n[system]\nkind = "bowden_pair"\nnominal_effects = []\n'
    text += "[system.parameters]\ninput_radius = { value = 1.0, sd = 0.0 }\noutput_radius = { value = 0.9, sd = 0.1 }\n"
    for name, value in {"sheath_length": 0.5, "cable_stiffness": 1e5, "threshold_velocity": 0.0}.items():
        text += f"{name} = {{ value = {value}, sd = 0.0 }}\n"
    text += "threshold_slope = { value = 1e9, sd = 0.0 }\ngate_share = { value = 0.0, sd = 0.0 }\n"
    text += "[signals]\n" + "".join(f"{name} = {{}}\n" for name in ("input_torque", "input_velocity", "output_torque"))
    for k in range(4):
        velocity = np.sin(2.0 * np.pi * (0.2 + 0.1 * k) * time)
        torque = 0.04 + 0.004 * np.sin(2.0 * np.pi * 0.15 * time)
        passed = 0.88 * torque - 0.05 * np.sign(velocity) + 1e-4 * random.standard_normal(len(time))
        columns = np.column_stack([time, torque, -velocity if turned else velocity, passed])
        head = "t,input_torque,input_velocity,output_torque"
        np.savetxt(tmp_path / f"{k}.csv", columns, delimiter=",", header=head, comments="")
        text += f'[[experiments]]\nname = "{k}"\nfile = "{k}.csv"\n'
    (tmp_path / "dataset.toml").write_text(text)
    blocking = [(f.problem, f.signal) for f in tl.check(tl.load(tmp_path)).findings if f.blocks]
    assert blocking == ([("sign", "input_velocity")] if turned else [])


@pytest.mark.parametrize("signal", ["tension_21", "tension_22"])
def test_a_cable_that_pushes_was_logged_with_the_wrong_sign(tmp_path: Path, signal: str) -> None:
    """Also one that friction holds, whose equation explains too little to judge by."""
    [(kind, place, size)] = found(tmp_path, "ccsrm", Fault(problem="sign", signals=(signal,), factor=-1.0))
    assert (kind, place, size) == ("sign", signal, -1.0)


def test_a_force_sensor_that_was_zeroed_under_pretension_has_no_wrong_sign(tmp_path: Path) -> None:
    rig = written(tmp_path, "ccsrm")
    for experiment in rig.experiments:
        experiment.data["tension_22"] -= experiment.data["tension_22"].mean()
    assert list(pushing_cables(rig, rig.system())) == []


@pytest.mark.parametrize("factor", [2.0, 0.5, -1.0, 1000.0, 0.001])
def test_a_wrong_torque_of_a_bowden_pair_is_found(tmp_path: Path, factor: float) -> None:
    problem = "sign" if factor < 0 else "scale"
    [(kind, place, size)] = found(
        tmp_path, "bowden_pair", Fault(problem=problem, signals=("output_torque",), factor=factor)
    )
    assert kind == problem
    assert "output_torque" in place or "input_torque" in place
    assert size in (pytest.approx(factor, rel=0.1), pytest.approx(1 / factor, rel=0.1))


def test_a_late_run_of_a_bowden_pair_is_found(tmp_path: Path) -> None:
    [(kind, place, seconds)] = found(tmp_path, "bowden_pair", Fault(problem="clock", experiment="run-04", seconds=0.1))
    assert (kind, "run-04" in place) == ("clock", True)
    assert seconds == pytest.approx(0.1, abs=0.02)


def test_a_wrong_sign_is_found_beside_a_tension_that_the_check_cannot_predict(tmp_path: Path) -> None:
    """The bristles of the contacts remember, and hold one of the tensions: its equation explains little."""
    [(kind, place, _)] = found(tmp_path, "ccsrm", Fault(problem="sign", signals=("joint_angle",), factor=-1.0))
    assert kind == "sign"
    assert "joint_angle" in place


def test_a_turned_tension_is_its_sign_though_a_smaller_factor_mends_another_equation_too(tmp_path: Path) -> None:
    fault = Fault(problem="sign", signals=("tension_22",), factor=-1.0)
    [(kind, place, factor)] = found(tmp_path, "ccsrm", fault)
    assert (kind, "tension_22" in place, factor) == ("sign", True, pytest.approx(-1.0))


@pytest.mark.cpu(20)
@pytest.mark.parametrize(
    ("signal", "factor"),
    [
        ("cable_force_1", -1.0),
        ("cable_force_2", 1000.0),
        ("joint_angle", -1.0),
        ("joint_angle", 180 / np.pi),
        ("actuator_velocity", 2.0),
        ("time", 1000.0),
    ],
)
def test_a_wrong_channel_of_a_joint_behind_driven_nuts_is_found(tmp_path: Path, signal: str, factor: float) -> None:
    """The nuts travel the integral of their velocity; the cables stretch by what the joint does not follow."""
    problem = "sign" if factor < 0 else "scale"
    [(kind, place, size)] = found(tmp_path, "cable_joint", Fault(problem=problem, signals=(signal,), factor=factor))
    assert kind == problem
    assert signal in place
    assert size == pytest.approx(factor, rel=0.05)


@pytest.mark.parametrize("factor", [1 / 9.81, 1 / 4.448])
def test_a_unit_that_all_tensions_share_is_found(tmp_path: Path, factor: float) -> None:
    """Friction adds to tensions what the equation does not know, which a smaller factor suits a little better."""
    names = ("tension_21", "tension_22")
    rig = written(tmp_path, "ccsrm")
    for experiment in rig.experiments:
        experiment.data[list(names)] *= factor
    blocking = [(f.problem, f.signal, f.factor) for f in tl.check(rig).findings if f.blocks]
    assert blocking == [("scale", name, pytest.approx(factor)) for name in names]


@pytest.mark.cpu(10)
@pytest.mark.parametrize(
    ("system", "names"), [("ccsrm", ("tension_21", "tension_22")), ("cable_joint", ("cable_force_1", "cable_force_2"))]
)
def test_columns_in_each_other_s_place_are_found(tmp_path: Path, system: str, names: tuple[str, str]) -> None:
    rig = written(tmp_path, system)
    for experiment in rig.experiments:
        experiment.data[list(names)] = experiment.data[list(reversed(names))].to_numpy()
    [finding] = [f for f in tl.check(rig).findings if f.blocks]
    assert (finding.problem, {finding.signal, *finding.alternatives}) == ("sign", set(names))
    assert "look exchanged" in finding.detail


@pytest.mark.cpu(10)
@pytest.mark.parametrize(
    ("signal", "factor"), [("joint_angle", 180 / np.pi), ("joint_angle", -1.0), ("driver_angle", -1.0)]
)
def test_a_wrong_channel_of_one_run_is_found_where_that_run_alone_tells_little(
    tmp_path: Path, signal: str, factor: float
) -> None:
    """Friction holds one of the tensions: what all runs share tells more than one run."""
    rig = written(tmp_path, "ccsrm")
    rig.experiments[1].data[signal] *= factor
    [finding] = [f for f in tl.check(rig).findings if f.blocks]
    assert (finding.experiment, finding.factor) == (rig.experiments[1].name, pytest.approx(factor))
    assert signal in (finding.signal, *finding.alternatives)


@pytest.mark.parametrize(("system", "blocks"), [("ccsrm", True), ("bowden_pair", False)])
def test_samples_seconds_apart_are_milliseconds_where_anything_tells(tmp_path: Path, system: str, blocks: bool) -> None:
    """Friction with memory strains the beliefs of the right clock; nothing in a Bowden pair has a mass."""
    rig = written(tmp_path, system)
    slow = tuple(replace(e, data=e.data.set_axis(1e3 * e.data.index)) for e in rig.experiments)
    slow = replace(rig, experiments=slow)
    told = [f for f in tl.check(slow).findings if f.signal == "time"]
    assert [(f.problem, f.blocks) for f in told] == [("scale" if blocks else "sampling", blocks)]
    assert "check the unit of the time column" in told[0].detail


def test_a_velocity_that_only_turns_friction_has_no_size(tmp_path: Path) -> None:
    """At a thousandth of its size the gate would stay shut: that is no sign that the velocity is wrong."""
    dataset = written(tmp_path, "bowden_pair")
    equation = Equation(dataset, dataset.system())
    tried = [suspect for suspect in suspects(equation, np.ones(1)) if suspect.signals == ("input_velocity",)]
    assert tried == [Suspect(("input_velocity",), (-1.0,))]
    read = read_logs(dataset, dataset.system().info)
    assert read is not None
    turned = _searched(equation, read.thinned(ROUGH), tried[0], np.full(1, ROUGH_SHARE))
    assert turned.value == -1.0
    assert _refined(equation, read.thinned(ROUGH), turned, np.full(1, ROUGH_SHARE), RATIO, 0.05).value == -1.0

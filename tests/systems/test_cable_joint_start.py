"""How a joint on two cables begins: the nuts hold it and its load, and its bushings recall which way it moved last."""

import pickle
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from tendonlab import _core
from tendonlab.errors import ParameterError
from tendonlab.papers import s2
from tendonlab.simulation.prepare import Prepared, Replay, prepare
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.system import System

TIME = np.arange(0.0, 1.5, 0.01)
REST = 0.4  # s
NUTS = np.where(TIME < REST, 0.0, 0.02 * np.sin(4.0 * np.pi * (TIME - REST)))  # m/s
CONSTANTS = s2.constants()


def rig(**offset: float) -> System:
    plain = s2.system(CONSTANTS)
    return plain.with_effects({"load:offset": offset}) if offset else plain


def experiment(nuts: np.ndarray = NUTS, **measured: np.ndarray) -> Experiment:
    frame = pd.DataFrame({"actuator_velocity": nuts, **measured}, index=pd.Index(TIME, name="t"))
    return Experiment(name="run", data=frame)


def ready(system: System, nuts: np.ndarray = NUTS, **measured: np.ndarray) -> Prepared:
    return prepare(experiment(nuts, **measured), system, Replay("free"))


def simulated(system: System, start: float, sense: float = 1.0, nuts: np.ndarray = NUTS) -> dict[str, np.ndarray]:
    """The outputs of a run that begins at rest at the angle `start` after a motion in this sense."""
    given = ready(system, nuts)
    core = given.core.started([start], [0.0], given.core.reading).last_moved(sense)
    run = _core.simulate(system.kind, system.values(), system.active(), core, [], given.settings(1e-9))
    return dict(zip((s.name for s in system.info.outputs), run["outputs"], strict=True))


def bare(system: System) -> System:
    """The same without the friction of its bushings."""
    kept = {name: value for name, value in system.parameters.items() if not name.startswith("bushing")}
    return replace(system, parameters=kept, effects=[e for e in system.effects if not e.startswith("bushing")])


@pytest.mark.parametrize("offset", [-0.9, 0.0, 0.7])
def test_a_joint_rests_where_it_is_found_whatever_pulls_at_it(offset: float) -> None:
    """The cables carry its weight and the constant torque: r cos(theta) (F_1 - F_2) + weight + offset = 0."""
    system, angle = bare(rig(offset=offset)), -0.2
    run = simulated(system, angle, nuts=0.0 * TIME)
    assert run["joint_angle"] == pytest.approx(np.full(len(TIME), angle), abs=1e-10)
    p = system.parameters
    near = p["link_1_mass"] * p["link_1_center"] + p["link_2_mass"] * p["link_1_length"]
    far = 2.0 * p["link_2_mass"] * p["link_2_center"]
    first, second = (np.cos(k * angle + p["mounting_angle"]) for k in (1, 2))
    weight = -p["gravity"] * (near * first + far * second)
    pull = p["anchor_distance"] * np.cos(angle) * (run["cable_force_1"] - run["cable_force_2"])
    assert pull == pytest.approx(np.full(len(TIME), -(weight + offset)), rel=1e-7)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_bushings_at_rest_keep_the_sense_of_the_last_motion(sense: float) -> None:
    """Both senses differ while the joint rests, and not once it has moved."""
    moved, other = simulated(rig(), 0.0, sense), simulated(rig(), 0.0, -sense)
    rests = TIME < REST - 0.02
    assert np.all(np.abs(moved["cable_force_1"] - other["cable_force_1"])[rests] > 1.0)
    assert moved["cable_force_1"][-5:] == pytest.approx(other["cable_force_1"][-5:], rel=1e-6)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_forces_tell_which_way_the_joint_moved_last(sense: float) -> None:
    """Also to a simulator whose pretension and whose load are wrong, from noisy logs."""
    truth = rig(offset=0.8)
    run = simulated(truth, 0.01, sense)
    noise = np.random.default_rng(3).normal(size=(2, len(TIME)))
    forces = {f"cable_force_{k + 1}": run[f"cable_force_{k + 1}"] + noise[k] for k in (0, 1)}
    wrong = rig().with_parameters({"pretension": 1.1 * rig().parameters["pretension"]})
    assert ready(wrong, joint_angle=run["joint_angle"], **forces).core.sense == sense


def test_without_forces_or_without_a_rest_nothing_tells() -> None:
    backwards = simulated(rig(), 0.0, -1.0)["cable_force_1"]
    assert ready(rig(), cable_force_1=backwards).core.sense == -1.0
    assert ready(rig()).core.sense == 1.0
    assert ready(rig(), NUTS + 1e-3, cable_force_1=backwards).core.sense == 1.0
    assert ready(rig(), 0.0 * NUTS, cable_force_1=backwards).core.sense == 1.0


def test_the_sense_is_kept_by_pickling_and_must_be_one() -> None:
    core = ready(rig()).core
    assert pickle.loads(pickle.dumps(core.last_moved(-1.0))).sense == -1.0
    assert core.last_moved(-1.0).until(5).sense == -1.0
    with pytest.raises(ParameterError, match=r"sense = 0.5: expected 1 or -1"):
        core.last_moved(0.5)

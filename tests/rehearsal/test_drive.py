"""Simulated rigs without a stated controller: what they log is what moved them."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.fitting.case import make_case
from tendonlab.rehearsal.build import simulated_rig
from tendonlab.rehearsal.rig import TOLERANCE, SimulatedRig
from tendonlab.simulation.command import command_of
from tendonlab.simulation.records import Controller, Experiment, NominalParameter, SignalSpec

JOINT = {"inertia": 0.012, "gravity_torque": 0.9, "torque_constant": 0.35, "coulomb": 0.05, "viscous": 0.02}
MOTOR_AND_JOINT = {
    "motor_inertia": 9e-5, "joint_inertia": 0.017, "gear_ratio": 10.0, "gravity_torque": 1.0, "motor_coulomb": 3e-3,
    "motor_viscous": 2e-4, "joint_coulomb": 0.05, "joint_viscous": 0.03, "cable_stiffness": 43.0, "cable_damping": 0.05,
}  # fmt: skip
RIGS = {
    "rigid_joint": (JOINT, ("joint:coulomb", "joint:viscous"), ("joint_angle",), 1.5),
    "two_inertia": (
        MOTOR_AND_JOINT,
        ("motor:coulomb", "motor:viscous", "joint:coulomb", "joint:viscous"),
        ("motor_angle", "joint_angle"),
        0.06,
    ),
}
Stamps = Callable[[int], np.ndarray]
STAMPS: dict[str, Stamps] = {
    "even": lambda num: 0.005 * np.arange(num),
    "rounded": lambda num: np.round(0.0050003 * np.arange(num), 6),
    "late": lambda num: 5.321 + 0.005 * np.arange(num),
    "uneven": lambda num: 0.005 * np.arange(num) + 1e-3 * np.sin(np.arange(num) ** 2),
}
NOISE = 1e-4  # rad


def logged_rig(kind: str, stamps: Stamps, *, held: bool = True) -> tl.Dataset:
    """A rig that logs with noise, driven by a known torque."""
    parameters, effects, outputs, size = RIGS[kind]
    time, random = stamps(600), np.random.default_rng(5)
    since = time - time[0]
    torque = size * (0.5 * np.sin(3 * since) + 0.3 * np.sin(8 * since + 1))
    holds = dict.fromkeys(("motor_torque", *outputs), False) | {"motor_torque": held}
    initial = dict.fromkeys(("joint_angle", "joint_velocity", "motor_angle", "motor_velocity"), 0.0)
    frame = pd.DataFrame({"motor_torque": torque}, index=pd.Index(time, name="t"))
    run = Experiment(name="a", data=frame, holds=holds, initial=initial)
    system = tl.System(kind=kind, parameters=parameters, effects=effects)
    moved = system.simulate(run).outputs
    noisy = {name: moved[name] + NOISE * random.normal(size=len(time)) for name in outputs}
    signals = {"motor_torque": SignalSpec("motor_torque", "u", "N*m", "input", held, si_unit="N*m")}
    signals |= {name: SignalSpec(name, name, "rad", "output", False, NOISE, si_unit="rad") for name in outputs}
    return tl.Dataset(
        name="made", description="", kind=kind, axis="rotary", nominal_effects=effects, controller=None,
        parameters={n: NominalParameter(value, 0.05 * abs(value)) for n, value in parameters.items()}, signals=signals,
        experiments=(replace(run, data=run.data.assign(**noisy)),), path=Path(),
    )  # fmt: skip


def relative_error(rigs: SimulatedRig) -> float:
    """By how much the same parameters miss the noise-free log, over the motion: the largest among the outputs."""
    (log,) = rigs.clean({}).experiments
    again = rigs.rig.system().simulate(log, tolerance=TOLERANCE).outputs
    return max(float((again[name] - log.data[name]).std() / log.data[name].std()) for name in rigs.rig.outputs)


@pytest.mark.parametrize("kind", RIGS)
@pytest.mark.parametrize("stamps", STAMPS.values(), ids=STAMPS)
@pytest.mark.parametrize("held", [True, False], ids=["held", "interpolated"])
def test_the_logged_command_replays_the_logged_motion(kind: str, stamps: Stamps, held: bool) -> None:
    rigs = simulated_rig(logged_rig(kind, stamps, held=held))
    assert rigs.drive.tracks
    assert relative_error(rigs) < 1e-6


def test_the_simulated_rig_stays_near_the_logged_motion() -> None:
    """Also where its parameters are others than those that made the logs."""
    rigs = simulated_rig(logged_rig("rigid_joint", STAMPS["even"]))
    logged = rigs.runs[0].data["joint_angle"]
    system = rigs.system.with_parameters({"inertia": 0.014, "coulomb": 0.07})
    simulated = rigs.noisy(np.random.default_rng(0), system).experiments[0].data["joint_angle"]
    assert float((simulated - logged).std()) < 0.1 * float(logged.std())


def upright_rig(stamps: Stamps) -> tl.Dataset:
    """An inverted pendulum, which a loop that nobody states keeps upright."""
    rig = logged_rig("rigid_joint", stamps)
    (run,) = rig.experiments
    loop = Controller("pd", kp=20.0, kd=1.5, measured="joint_angle", reference="r")
    upright = replace(rig, parameters={**rig.parameters, "gravity_torque": NominalParameter(-0.9, 0.05)})
    moved = replace(run, data=run.data.assign(r=0.2 * np.sin(4 * (run.time - run.time[0]))))
    angle = replace(upright.system(), controller=loop).simulate(moved)["joint_angle"].to_numpy()
    noisy = angle + NOISE * np.random.default_rng(6).normal(size=len(angle))
    data = run.data.assign(joint_angle=noisy, motor_torque=command_of(loop, moved, angle))
    return replace(upright, experiments=(replace(run, data=data),))


@pytest.mark.parametrize("stamps", STAMPS.values(), ids=STAMPS)
def test_a_rig_that_would_fall_is_held_by_its_loop(stamps: Stamps) -> None:
    """The log keeps the motion in the loop. Its command explains the motion as a diagnosis replays it, which pulls its
    simulator to the log."""
    rigs = simulated_rig(upright_rig(stamps))
    log, logged = rigs.clean({}).experiments[0].data["joint_angle"], rigs.runs[0].data["joint_angle"]
    assert float((log - logged).std()) < 0.1 * float(logged.std())
    case = make_case(rigs.clean({}), tolerance=TOLERANCE)
    missed = case.run(0, rigs.rig.system())["outputs"][0] - log.to_numpy()
    assert float(np.sqrt(np.mean(missed**2))) < 0.5 * NOISE

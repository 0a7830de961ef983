"""The rig of S2 for the library: its simulator, and logs of a twin as a dataset (reconstructed: the paper's are not
published)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from tendonlab.data import Dataset, load
from tendonlab.papers.s2.trapezoids import Reference, reference
from tendonlab.papers.s2.twin import Sense, measured, simulate
from tendonlab.papers.s2.values import Constants
from tendonlab.simulation.catalog import system_info
from tendonlab.simulation.system import System

AROUND_JUMPS = 0.1  # s
EVERY = 20  # steps of 1 ms a sample of a twin's log
NOMINAL_SD = {"cable_stiffness": 200.0 / 1.96, "cable_damping": 700.0 / 1.96, "pretension": 2.0}  # Table II; assumed
NOISE_SD = {"joint_angle": 1.4e-5, "joint_velocity": 2e-3, "cable_force_1": 1.5, "cable_force_2": 1.5}
UNITS = {"joint_angle": "rad", "joint_velocity": "rad/s", "cable_force_1": "N", "cable_force_2": "N"}
RUNS: Mapping[str, tuple[tuple[float, ...], float, str]] = {  # set points, rad; speed, rad/s; split
    "up": ((0.0, 0.6, 0.3), 0.06, "train"),
    "down": ((0.0, -0.6, -0.2), 0.06, "train"),
    "slow": ((0.0, 0.35, 0.0), 0.04, "train"),
    "both": ((0.0, 0.4, -0.3), 0.06, "train"),
    "mixed": ((0.0, -0.35, 0.4), 0.05, "test"),
    "long": ((0.0, 0.55, -0.1), 0.06, "test"),
}
AGAIN = {"up": RUNS["up"], "up again": RUNS["up"]}


def parameters(of: Constants) -> dict[str, float]:
    """The parameters of `cable_joint` from the paper's constants, SI."""
    found = {
        "motor_inertia": of.J_m, "gear_ratio": 1.0 / of.N_g, "screw_pitch": of.p, "anchor_distance": of.r,
        "link_1_mass": of.m_1, "link_1_inertia": of.J_1, "link_1_length": of.l_1, "link_1_center": of.d_11,
        "link_2_mass": of.m_2, "link_2_inertia": of.J_2, "link_2_center": of.d_21, "mounting_angle": of.phi,
        "gravity": of.g, "motor_inductance": of.L_m, "motor_resistance": of.R_m, "torque_constant": of.k_m,
        "motor_viscous": of.c_m, "gear_friction": of.alpha, "gear_friction_slope": of.beta,
        "cable_stiffness": of.K, "cable_damping": of.c, "pretension": of.T,
    }  # fmt: skip
    for i, branches in enumerate(of.bushings, start=1):
        found |= {f"bushing_{i}_{name}": float(value) for name, value in branches.items()}
    return found


def system(of: Constants) -> System:
    """The simulator of the paper: motor, gear friction, cables, bushings by eq. 11; no ripple, no hold."""
    return System(
        kind="cable_joint", parameters=parameters(of), effects=system_info("cable_joint").default_nominal_effects
    )


def nut_input(of: Constants, of_reference: Reference, *, every: int = 1) -> pd.DataFrame:
    """Command of velocity-controlled nuts: `actuator_velocity` = r cos(theta) theta' of the reference,
    m/s, by time "t", s; `every`: keep one sample of this many."""
    asked = of.r * np.cos(of_reference.angle) * of_reference.velocity
    index = pd.Index(of_reference.time[::every], name="t")
    return pd.DataFrame({"actuator_velocity": asked[::every]}, index=index)


def log_of_twin(
    of: Constants,
    of_reference: Reference,
    *,
    ripple: float = 0.0,
    hold: bool = False,
    toe_tension: float = 0.0,
    path_error: float = 0.0,
    seed: int = 0,
) -> pd.DataFrame:
    """One record of the twin at 50 Hz: `actuator_velocity` as the drive did it, half a step of 1 ms after it was asked
    for (30 urad of the joint), and what the sensors read.

    Forces are left out (NaN) within 0.1 s of the start and end of every move: a jump that falls between two samples
    says nothing of its size (S2 sec. IV-B.3 leaves out 1 s)."""
    sense: Sense = "hold" if hold else "instantaneous"
    run = simulate(of, of_reference, ripple=ripple, sense=sense, toe_tension=toe_tension, path_error=path_error)
    asked = nut_input(of, of_reference)
    velocity = 0.5 * (asked + asked.shift(1, fill_value=0.0))  # the twin holds it from step to step
    log = velocity.iloc[::EVERY].join(measured(run.iloc[::EVERY], seed=seed))
    for instant in np.ravel(of_reference.moves):
        near = np.abs(log.index.to_numpy() - instant) < AROUND_JUMPS
        log.loc[near, ["cable_force_1", "cable_force_2"]] = np.nan
    return log


def write_dataset(
    folder: str | Path,
    of: Constants,
    *,
    ripple: float = 0.0,
    hold: bool = False,
    toe_tension: float = 0.0,
    path_error: float = 0.0,
    repeated: bool = False,
    seed: int = 0,
) -> Dataset:
    """Write logs of a twin with the withheld effects `ripple`, `hold`, `toe_tension`, N, and `path_error`, m, into
    `folder` as a dataset whose simulator has none of them, and load it. `repeated`: one run is recorded twice, which
    separates noise from model error."""
    into = Path(folder)
    into.mkdir(parents=True, exist_ok=True)
    lines = ['format = "tendonlab-dataset/1"', 'name = "s2-twin"']
    lines += ['description = "twin of the S2 rig, reconstructed: synthetic logs, no measurement"', "[system]"]
    lines += ['kind = "cable_joint"', "[system.parameters]"]
    for name, value in parameters(of).items():
        lines.append(f"{name} = {{ value = {value!r}, sd = {NOMINAL_SD.get(name, 0.0)!r} }}")
    lines += ["[signals.actuator_velocity]", 'column = "actuator_velocity"', 'unit = "m/s"', "hold = false"]
    for name, unit in UNITS.items():
        lines += [f"[signals.{name}]", f'column = "{name}"', f'unit = "{unit}"', f"noise_sd = {NOISE_SD[name]!r}"]
    runs = {**RUNS, **(AGAIN if repeated else {})}
    for k, (name, (points, speed, part)) in enumerate(runs.items()):
        record = log_of_twin(
            of,
            reference(points, speed=speed),
            ripple=ripple,
            hold=hold,
            toe_tension=toe_tension,
            path_error=path_error,
            seed=1000 * seed + k,
        )
        record.to_csv(into / f"{name}.csv")
        lines += ["[[experiments]]", f'name = "{name}"', f'file = "{name}.csv"', f'split = "{part}"']
        lines += ["initial = { joint_velocity = 0.0 }"]
        lines += ['repeat = "up"'] if repeated and name in AGAIN else []
    (into / "dataset.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return load(into)

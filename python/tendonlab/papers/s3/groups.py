"""The data set of S3 Table I: one load-cell reading and four trajectories per group; and as a library dataset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd

from tendonlab.data import Dataset, Experiment, NominalParameter, SignalSpec
from tendonlab.papers.s3.chain import TORQUE_NOISE_SD, Chain, with_noise
from tendonlab.papers.s3.model import Prediction, mean_squared_error, predict_log
from tendonlab.papers.s3.rig import DEGREE, FrictionParameters, Rig, assumed_rig, cable_pretension
from tendonlab.papers.s3.shapes import BumpShape, paper_shape
from tendonlab.papers.s3.trajectories import Trajectory, table_1
from tendonlab.procedures import pretension_from_load_cells
from tendonlab.procedures.sheath_shape import Shape


@dataclass(frozen=True, kw_only=True, eq=False)
class Record:
    """One run: `log` by time "t", s, with `tau_in` and `tau_out`, N·m, and `v`, deg/s; what it was run on: `shape` of
    the sheaths, readings of the load cells at input and output, kg, and the `trajectory` commanded."""

    name: str
    shape: Shape | BumpShape
    load_in: float
    load_out: float
    trajectory: Trajectory
    log: pd.DataFrame = field(repr=False)
    group: int = 0

    @property
    def pretension(self) -> float:
        """Pretension of each cable as the load cells read it, N. Source: S3 eq. 3, 12."""
        return float(pretension_from_load_cells(self.load_in, self.load_out))

    def predict(self, p: FrictionParameters, *, y0: float = 0.0, rig: Rig | None = None) -> Prediction:
        """Prediction of the paper's model for the logged input and velocity."""
        return predict_log(self.log, shape=self.shape, T_s=self.pretension, p=p, y0=y0, rig=rig)

    def mse(self, p: FrictionParameters) -> float:
        """Mean squared error of that prediction, (N·m)²."""
        return mean_squared_error(self.log["tau_out"].to_numpy(), self.predict(p).tau_out)


def run_chain(
    number: int,
    reading: float,
    trajectory: Trajectory,
    *,
    duration: float = 20.0,
    seed: int | None = 0,
    slack: bool = False,
    pretension_scale: float = 1.0,
    skew: float = 0.0,
    sample_rate: float = 200.0,
) -> Record:
    """A record of the twin on shape theta_`number` with both load cells at `reading`, kg; see Chain. With a `skew` the
    sheath has that wrap angle, but bends more towards the load, and the record still states the shape theta_i."""
    log = _exact_log(number, reading, trajectory, duration, sample_rate, slack, pretension_scale, skew)
    log = log.copy() if seed is None else with_noise(log, seed=seed)
    name = f"theta_{number}, {reading:g} kg, {trajectory.amplitude:g} N*m, {trajectory.kind} {trajectory.period:g} s"
    return Record(
        name=name,
        shape=paper_shape(number),
        load_in=reading,
        load_out=reading,
        trajectory=trajectory,
        log=log,
        group=number,
    )


@cache
def _exact_log(
    number: int,
    reading: float,
    trajectory: Trajectory,
    duration: float,
    sample_rate: float,
    slack: bool,
    pretension_scale: float,
    skew: float,
) -> pd.DataFrame:
    """One integration for all: repeats of a run differ only by the noise of its sensors."""
    stated = paper_shape(number)
    chain = Chain(
        shape=Shape.skewed(stated.wrap_angle, length=stated.length, skew=skew) if skew else stated,
        pretension=cable_pretension(reading),
        slack=slack,
        tension_drop=skew != 0.0,
        pretension_scale=pretension_scale,
    )
    return chain.simulate(trajectory, duration=duration, sample_rate=sample_rate, seed=None)


def generate_dataset(
    readings: Sequence[tuple[int, float]],
    *,
    amplitude: float = 15.0,
    superposed_period: float = 10.0,
    duration: float | None = None,
    seed: int = 0,
) -> tuple[Record, ...]:
    """The twin's data set: for each (shape number, load-cell reading, kg) the four trajectories of S3 Table I.

    Each runs for two of its periods unless `duration`, s, is given."""
    trajectories = table_1(amplitude=amplitude, superposed_period=superposed_period)
    return tuple(
        run_chain(number, reading, trajectory, duration=duration or 2.0 * trajectory.period, seed=seed + 4 * g + k)
        for g, (number, reading) in enumerate(readings)
        for k, trajectory in enumerate(trajectories)
    )


def law_record(
    record: Record, p: FrictionParameters, *, noise_sd: float = TORQUE_NOISE_SD, seed: int | np.random.Generator = 0
) -> Record:
    """The same input and velocity with an output that obeys S3 eq. 21 exactly, except for noise of `noise_sd`, N·m."""
    exact = record.predict(p).tau_out
    noisy = exact + np.random.default_rng(seed).normal(0.0, noise_sd, len(exact))
    return Record(**{**vars(record), "log": record.log.assign(tau_out=noisy)})


def to_dataset(
    train: Sequence[Record],
    test: Sequence[Record],
    p: FrictionParameters,
    *,
    name: str = "s3-twin",
    uncertain: float = 0.03,
    friction_known: bool = False,
    viscous: bool = False,
    rig: Rig | None = None,
) -> Dataset:
    """Records as a library dataset of kind `bowden_pair` whose simulator holds `p`: geometry and the steepness of the
    gate are known; friction coefficient and threshold have the sd `uncertain` over value that an earlier fit left, or
    the friction coefficient counts as known too. With `viscous` it has a viscous friction of which nothing is known.

    Pretension, wrap angle and unevenness of the shape are conditions of each experiment."""
    rig = assumed_rig() if rig is None else rig
    si = p.system_parameters()
    known = {
        "input_radius": rig.r_in,
        "output_radius": rig.r_out,
        "sheath_length": rig.L,
        "cable_stiffness": rig.EA,
        "pretension": train[0].pretension,
        "wrap_angle": train[0].shape.wrap_angle,
        "curvature_skew": train[0].shape.skew,
        **{key: si[key] for key in ("static_friction_coefficient", "stribeck_velocity", "threshold_slope")},
    }
    free = {key: si[key] for key in ("friction_coefficient", "threshold_velocity")}
    parameters = {key: NominalParameter(value=value, sd=0.0) for key, value in known.items()}
    for key, value in free.items():
        share = 0.0 if friction_known and key == "friction_coefficient" else uncertain
        parameters[key] = NominalParameter(value=value, sd=share * value, lower=0.0)
    if viscous:
        parameters["sheath_viscous"] = NominalParameter(value=0.0, lower=0.0)
    split = [(record, "train") for record in train] + [(record, "test") for record in test]
    return Dataset(
        name=name,
        description="Reconstructed twin of S3: a chain of friction nodes under the paper's trajectories.",
        kind="bowden_pair",
        axis="rotary",
        nominal_effects=("sheath:capstan", "sheath:viscous") if viscous else ("sheath:capstan",),
        parameters=parameters,
        controller=None,
        signals=_signals(),
        experiments=tuple(_experiment(record, part, k) for k, (record, part) in enumerate(split)),
        path=Path(),
    )


def _signals() -> dict[str, SignalSpec]:
    units = {"input_torque": "N*m", "input_velocity": "rad/s", "output_torque": "N*m"}
    return {
        name: SignalSpec(
            name=name, column=name, unit=unit, si_unit=unit, hold=False,
            role="output" if name == "output_torque" else "input",
        )
        for name, unit in units.items()
    }  # fmt: skip


def _experiment(record: Record, split: str, index: int) -> Experiment:
    log = record.log
    data = pd.DataFrame(
        {"input_torque": log["tau_in"], "input_velocity": DEGREE * log["v"], "output_torque": log["tau_out"]}
    )
    return Experiment(
        name=f"{index + 1}: {record.name}",
        data=data,
        split=split,
        repeat=record.name,
        conditions={
            "pretension": record.pretension,
            "wrap_angle": record.shape.wrap_angle,
            "curvature_skew": record.shape.skew,
        },
    )

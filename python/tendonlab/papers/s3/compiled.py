"""Records as the compiled system simulates them, with exact derivatives by the paper's five numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import pandas as pd

from tendonlab import _core
from tendonlab.data import Experiment
from tendonlab.papers.s3.groups import Record
from tendonlab.papers.s3.rig import DEGREE, FrictionParameters, Rig, assumed_rig, paper_parameters
from tendonlab.simulation.prepare import Replay, prepare
from tendonlab.simulation.system import System

NAMES = tuple(f.name for f in fields(FrictionParameters) if f.name != "velocity_unit")
SYSTEM_NAMES = dict(zip(NAMES, paper_parameters().system_parameters(), strict=True))


@dataclass(frozen=True, eq=False)
class CompiledRecord:
    """A record as the compiled system simulates it, with derivatives by its parameters."""

    values: list[float]
    active: list[bool]
    experiment: _core.Experiment
    measured: np.ndarray
    index: dict[str, int]

    @classmethod
    def of(cls, record: Record) -> CompiledRecord:
        """A record, prepared for repeated simulation."""
        system = bowden_pair(paper_parameters(), record=record)
        data = pd.DataFrame({"input_torque": record.log["tau_in"], "input_velocity": DEGREE * record.log["v"]})
        as_read = dict.fromkeys(data.columns, True)  # S3 eq. 20 sees each sample of the velocity with its noise
        ready = prepare(Experiment(name=record.name, data=data, holds=as_read), system, Replay("free"))
        order = [parameter.name for parameter in system.info.parameters]
        index = {name: order.index(own) for name, own in SYSTEM_NAMES.items()}
        return cls(system.values(), system.active(), ready.core, record.log["tau_out"].to_numpy(dtype=float), index)

    def run(self, p: FrictionParameters, by: Sequence[str] = ()) -> tuple[np.ndarray, np.ndarray]:
        """Predicted less measured output, N·m, (n,), and its derivatives by the numbers `by` in the unit of `p`."""
        values = self.values.copy()
        for name, value in zip(NAMES, p.system_parameters().values(), strict=True):
            values[self.index[name]] = value
        seeds = [("parameter", self.index[name]) for name in by]
        run = _core.simulate("bowden_pair", values, self.active, self.experiment, seeds, _core.Settings())
        error = run["outputs"][0] - self.measured
        if not by:
            return error, np.empty((len(error), 0))
        own, si = p, p.in_unit("rad/s")
        per_unit = [getattr(si, name) / getattr(own, name) for name in by]
        return error, run["gradient"][:, 0, :].T * per_unit


def bowden_pair(p: FrictionParameters, *, record: Record, rig: Rig | None = None) -> System:
    """The library's simulator with the paper's numbers, as `record` was run."""
    rig = assumed_rig() if rig is None else rig
    own = {
        "input_radius": rig.r_in, "output_radius": rig.r_out, "sheath_length": rig.L, "cable_stiffness": rig.EA,
        "pretension": record.pretension, "wrap_angle": record.shape.wrap_angle,
        "curvature_skew": record.shape.skew,
    }  # fmt: skip
    return System(kind="bowden_pair", effects=("sheath:capstan",), parameters={**p.system_parameters(), **own})

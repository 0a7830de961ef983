"""A planned motion of a rig in a position loop: its reference, and the log that a model makes of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline

from tendonlab import _core
from tendonlab.data.units import convert
from tendonlab.diagnosis.answer.motions import Motion, eased, instants
from tendonlab.diagnosis.answer.plan import Played
from tendonlab.fitting.case import Case
from tendonlab.simulation.prepare import Replay
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.signals import linear, smooth
from tendonlab.simulation.system import System


@dataclass(frozen=True)
class Loop:
    """The position loop that makes a rig follow a path."""

    proportional: float
    derivative: float
    output: str

    @classmethod
    def of(cls, case: Case, replay: Replay) -> Loop | None:
        """The loop of a replay; None where nothing holds a position."""
        controller = case.system.controller
        if replay.kind == "free" or replay.kp is None or replay.kd is None or replay.output is None:
            return None
        cascade = controller is not None and replay.kind == "controller" and controller.kind == "cascade"
        return Loop(replay.kd * replay.kp if cascade else replay.kp, replay.kd, replay.output)


@dataclass(frozen=True)
class Looped:
    """A motion that the `loop` of the rig follows."""

    motion: Motion
    loop: Loop

    @property
    def words(self) -> str:
        """The motion in a report."""
        return self.motion.words

    def added(self, system: System) -> dict[str, float]:
        """What its load adds to the parameters of `system`."""
        return self.motion.payload_of(system)

    def stated(self, case: Case) -> dict[str, dict[str, float]]:
        """Its load."""
        added = self.added(case.system)
        return {"add": added} if added else {}

    def reference(self, case: Case) -> pd.DataFrame:
        """What the rig is to follow, as its logs have it: `t` in s, and the column of the controller's reference, else
        of the output, in its unit."""
        controller = case.system.controller
        spec = case.dataset.signals[self.loop.output if controller is None else controller.reference]
        path = convert(eased(self.motion.path), unit=spec.si_unit, to=spec.unit)
        return pd.DataFrame({"t": instants(), spec.column: path})

    def played(self, case: Case, of: System, *, ports: bool = False) -> Played:
        """The motion as a rig that `of` is would make and log it."""
        like, loop = case.experiments[case.train[0]], self.loop
        time = np.arange(0.0, instants()[-1], float(np.median(np.diff(like.time))))
        run = self.run(case, of, time, ports=ports)
        made = run["outputs"]
        path = CubicSpline(instants(), eased(self.motion.path))
        seen = CubicSpline(time, made[case.outputs.index(loop.output)])
        effort = loop.proportional * (path(time) - seen(time)) + loop.derivative * (path(time, 1) - seen(time, 1))
        controller, info = case.system.controller, case.system.info
        limit = controller.limit if controller else np.inf
        signals = dict(zip(case.outputs, made, strict=True)) | {info.inputs[0].name: np.clip(effort, -limit, limit)}
        signals |= {} if controller is None else {controller.reference: path(time)}
        data = pd.DataFrame({n: signals.get(n, 0.0 * time) for n in like.data.columns}, index=pd.Index(time, name="t"))
        added, held = self.added(case.system), {info.inputs[0].name: False}
        log = Experiment(name="next", data=data, conditions=like.conditions, add=added, holds=held)
        return Played(log, run)

    def run(self, case: Case, of: System, time: np.ndarray, *, ports: bool = False) -> dict[str, Any]:
        """A model driven along the motion by the loop, from rest, read at `time`."""
        loads = self.added(of).items()
        system = of.with_parameters({name: of.parameters[name] + load for name, load in loads}) if loads else of
        c = case.outputs.index(self.loop.output)
        axis = system.info.outputs[c].axis or 0
        shape, _, _ = _core.rigid_motion(system.kind, system.values(), system.active())
        path = eased(self.motion.path)
        core = _core.Experiment(
            kind=system.kind,
            time=time.tolist(),
            inputs=[linear(time, 0 * time), *[_core.Signal() for _ in system.info.inputs[1:]]],
            loop=_core.Loop(
                kind="controller",
                axis=axis,
                output=c,
                proportional=self.loop.proportional,
                derivative=self.loop.derivative,
                reference_weight=1.0,
                limit=system.controller.limit if system.controller else np.inf,
                sample_time=0.0,
                reference=smooth(instants(), path),
                disturbance=_core.Signal(),
            ),
            # beyond its degrees of freedom, a system knows its own state
            position=[path[0] * s / shape[axis] for s in shape[: system.info.dof]],
            velocity=[0.0] * system.info.dof,
        )
        flags = system.active(keep_zero=True)
        return dict(_core.simulate(system.kind, system.values(), flags, core, [], case.settings(ports=ports)))

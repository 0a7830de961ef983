"""What to measure next: the motion in which the leading explanations differ most (docs/method.md)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline

from tendonlab import _core
from tendonlab.data.units import convert
from tendonlab.diagnosis.answer.motions import Motion, eased, instants, motions
from tendonlab.diagnosis.search.delays import twin_delays
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted, Marginal, solved
from tendonlab.fitting.noise import Floor
from tendonlab.fitting.problem import pose
from tendonlab.simulation.prepare import Replay, prepare
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.signals import linear, smooth

SEPARATES = 3.0  # nats below which an experiment separates nothing


@dataclass(frozen=True)
class Loop:
    """The position loop that makes a rig follow a path."""

    proportional: float
    derivative: float
    output: str


def advise(case: Case, driven: Replay, floor: Floor, first: Fitted, second: Fitted) -> list[dict[str, Any]]:
    """Motions ranked by the nats that they are expected to bring between two explanations, best first, each with its
    `reference`; `driven`: the loop in which the rig follows them. Empty where the rig cannot be driven in the simulator
    or nothing separates them."""
    loop, names = _loop(case, driven), sorted(set(first.added) ^ set(second.added))
    if loop is None or twin_delays(case) == set(names):
        return []
    found = []
    for motion in motions(case, loop.output):
        try:
            gain = _separation(case, floor, first, second, motion, loop)
        except NumericalError:
            continue
        if gain > SEPARATES:
            row = {"description": motion.words, "separates": names, "expected_gain": round(gain, 1)}
            added = {"add": motion.payload_of(case.system)} if motion.payload else {}
            found.append(row | added | {"reference": _reference(case, motion, loop)})
    return sorted(found, key=lambda f: -float(str(f["expected_gain"])))[:3]


def _reference(case: Case, motion: Motion, loop: Loop) -> pd.DataFrame:
    """What the rig is to follow, as its logs have it: `t` in s, and the column of the controller's reference, else of
    the output, in its unit."""
    controller = case.system.controller
    spec = case.dataset.signals[loop.output if controller is None else controller.reference]
    return pd.DataFrame({"t": instants(), spec.column: convert(eased(motion.path), unit=spec.si_unit, to=spec.unit)})


def _loop(case: Case, replay: Replay) -> Loop | None:
    controller = case.system.controller
    if replay.kind == "free" or replay.kp is None or replay.kd is None or replay.output is None:
        return None
    cascade = controller is not None and replay.kind == "controller" and controller.kind == "cascade"
    return Loop(replay.kd * replay.kp if cascade else replay.kp, replay.kd, replay.output)


def _separation(case: Case, floor: Floor, first: Fitted, second: Fitted, motion: Motion, loop: Loop) -> float:
    """What the motion is expected to bring whichever of the two is true: the lesser of both gains."""
    return min(_gain(case, floor, a, b, motion, loop) for a, b in ((first, second), (second, first)))


def _gain(case: Case, floor: Floor, true: Fitted, other: Fitted, motion: Motion, loop: Loop) -> float:
    """Nats that the diagnosis is expected to count against the `other` where `true` made the log: half of
    min over parameters of |r + J theta|², r what the other leaves more, with its posterior as their prior."""
    experiment = _logged(case, true, motion, loop)
    rig = replace(case, experiments=(experiment,), prepared=(prepare(experiment, case.system, case.replay),))
    under = replace(floor, sd=other.levels.tolist())
    (left,), (own,) = (pose(rig, under, of.system, added=of.added).linearise().runs for of in (other, true))
    marginal = Marginal.of(left, other.shares)
    r, moving = marginal.residual(left.residual - own.residual), ~np.array(other.at_bound, dtype=bool)
    j, prior = marginal.jacobian[:, moving], other.precision[np.ix_(moving, moving)]
    with np.errstate(over="ignore", invalid="ignore"):  # a loop that runs away along this motion tells nothing
        gain = 0.5 * float(r @ r - (j.T @ r) @ solved(j.T @ j + prior, j.T @ r))
    return max(0.0, gain) if np.isfinite(gain) else 0.0


def _logged(case: Case, of: Fitted, motion: Motion, loop: Loop) -> Experiment:
    """The motion as a rig that `of` is would log it, without noise, sampled as the first training experiment."""
    like = case.experiments[case.train[0]]
    time = np.arange(0.0, instants()[-1], float(np.median(np.diff(like.time))))
    made = _run(case, of, motion, loop, time)["outputs"]
    path = CubicSpline(instants(), eased(motion.path))
    seen = CubicSpline(time, made[case.outputs.index(loop.output)])
    effort = loop.proportional * (path(time) - seen(time)) + loop.derivative * (path(time, 1) - seen(time, 1))
    controller, info = case.system.controller, case.system.info
    limit = controller.limit if controller else np.inf
    signals = dict(zip(case.outputs, made, strict=True)) | {info.inputs[0].name: np.clip(effort, -limit, limit)}
    signals |= {} if controller is None else {controller.reference: path(time)}
    data = pd.DataFrame({n: signals.get(n, 0.0 * time) for n in like.data.columns}, index=pd.Index(time, name="t"))
    added, held = motion.payload_of(case.system), {info.inputs[0].name: False}
    return Experiment(name="next", data=data, conditions=like.conditions, add=added, holds=held)


def _run(case: Case, of: Fitted, motion: Motion, loop: Loop, time: np.ndarray) -> dict[str, Any]:
    """A model driven along a motion by the loop, from rest, read at `time`."""
    system = of.system
    if motion.payload:
        loads = motion.payload_of(system).items()
        system = system.with_parameters({name: system.parameters[name] + load for name, load in loads})
    c = case.outputs.index(loop.output)
    axis = system.info.outputs[c].axis or 0
    shape, _, _ = _core.rigid_motion(system.kind, system.values(), system.active())
    path = eased(motion.path)
    core = _core.Experiment(
        kind=system.kind,
        time=time.tolist(),
        inputs=[linear(time, 0 * time), *[_core.Signal() for _ in system.info.inputs[1:]]],
        loop=_core.Loop(
            kind="controller",
            axis=axis,
            output=c,
            proportional=loop.proportional,
            derivative=loop.derivative,
            reference_weight=1.0,
            limit=system.controller.limit if system.controller else np.inf,
            sample_time=0.0,
            reference=smooth(instants(), path),
            disturbance=_core.Signal(),
        ),
        position=[path[0] * s / shape[axis] for s in shape[: system.info.dof]],  # beyond, a system knows its own state
        velocity=[0.0] * system.info.dof,
    )
    return dict(_core.simulate(system.kind, system.values(), system.active(keep_zero=True), core, [], case.settings()))

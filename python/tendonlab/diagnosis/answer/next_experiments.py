"""What to measure next: the motion in which the leading explanations differ most (docs/method.md)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from tendonlab import _core
from tendonlab.data.units import convert
from tendonlab.diagnosis.answer.motions import Motion, eased, instants, motions
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import Floor
from tendonlab.simulation.signals import linear, smooth

SEPARATES = 10.0  # nats below which an experiment separates nothing


@dataclass(frozen=True)
class Loop:
    """The position loop that makes a rig follow a path."""

    proportional: float
    derivative: float
    output: str


def advise(case: Case, floor: Floor, first: Fitted, second: Fitted) -> list[dict[str, Any]]:
    """Motions ranked by the nats that they are expected to bring between two explanations, best first, each with its
    `reference`; empty where the rig cannot be driven in the simulator or nothing separates them."""
    loop = _loop(case)
    if loop is None:
        return []
    found = []
    names = sorted(set(first.added) ^ set(second.added))
    for motion in motions(case, loop.output):
        try:
            gain = _separation(case, floor, first, second, motion, loop)
        except NumericalError:
            continue
        if gain > SEPARATES:
            row = {"description": motion.words, "separates": names, "expected_gain": round(gain, 1)}
            found.append(row | {"reference": _reference(case, motion, loop)})
    return sorted(found, key=lambda f: -float(str(f["expected_gain"])))[:3]


def _reference(case: Case, motion: Motion, loop: Loop) -> pd.DataFrame:
    """What the rig is to follow, as its logs have it: `t` in s, and the column of the controller's reference, else of
    the output, in its unit."""
    controller = case.system.controller
    spec = case.dataset.signals[loop.output if controller is None else controller.reference]
    return pd.DataFrame({"t": instants(), spec.column: convert(eased(motion.path), unit=spec.si_unit, to=spec.unit)})


def _loop(case: Case) -> Loop | None:
    replay, controller = case.replay, case.system.controller
    if replay.kind == "free" or replay.kp is None or replay.kd is None or replay.output is None:
        return None
    cascade = controller is not None and replay.kind == "controller" and controller.kind == "cascade"
    return Loop(replay.kd * replay.kp if cascade else replay.kp, replay.kd, replay.output)


def _separation(case: Case, floor: Floor, first: Fitted, second: Fitted, motion: Motion, loop: Loop) -> float:
    """Half of min over parameters of |y_A - y_B - J theta|², over the noise floor, with the posterior of A as their
    prior."""
    seeds = [("parameter", f.index) for f in first.free]
    a = _run(case, first, motion, loop, seeds)
    b = _run(case, second, motion, loop, [])
    shares = np.array(floor.shares)[case.measured] if floor.shares else np.ones(len(case.measured))
    weight = (floor.rms[case.measured] / np.sqrt(shares))[:, None]
    d = ((a["outputs"] - b["outputs"])[case.measured] / weight).ravel()
    slopes = np.array([f.slope(x) for f, x in zip(first.free, first.x, strict=True)])
    j = (a["gradient"][:, case.measured] / weight).reshape(len(seeds), -1).T * slopes
    left = float(d @ d - (j.T @ d) @ np.linalg.solve(j.T @ j + first.precision, j.T @ d))
    return 0.5 * max(0.0, left)


def _run(case: Case, of: Fitted, motion: Motion, loop: Loop, seeds: list[tuple[str, int]]) -> dict[str, Any]:
    """A model driven along a motion by the loop, from rest."""
    system = of.system
    if motion.payload:
        system = system.with_parameters(motion.payload_on(system))
    c = case.outputs.index(loop.output)
    axis = system.info.outputs[c].axis or 0
    shape, _, _ = _core.rigid_motion(system.kind, system.values(), system.active())
    time, path = instants(), eased(motion.path)
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
            reference=smooth(time, path),
            disturbance=_core.Signal(),
        ),
        position=[path[0] * s / shape[axis] for s in shape],
        velocity=[0.0] * len(shape),
    )
    flags, settings = system.active(keep_zero=True), case.settings()
    return dict(_core.simulate(system.kind, system.values(), flags, core, seeds, settings))

"""What to measure next: the motion in which the leading explanations differ most (DIAGNOSIS section 4)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from tendonlab import _core
from tendonlab.diagnose.case import Case
from tendonlab.diagnose.fits import Fitted
from tendonlab.errors import NumericalError
from tendonlab.signals import linear, smooth

SEPARATES = 10.0  # nats below which an experiment separates nothing
DURATION, RATE = 6.0, 250.0


@dataclass(frozen=True)
class Motion:
    """A motion of the looped axis about its middle: its words, and position over time for a travel and a speed."""

    words: str
    path: Callable[[np.ndarray, float], np.ndarray]
    payload: float = 0.0


def advise(case: Case, first: Fitted, second: Fitted) -> list[dict[str, Any]]:
    """Motions ranked by the nats that they are expected to bring between two explanations, best first; empty where the
    rig cannot be driven in the simulator or nothing separates them."""
    loop = _loop_gains(case)
    if loop is None:
        return []
    found = []
    names = sorted(set(first.added) ^ set(second.added))
    for motion in _motions(case, loop[2]):
        try:
            gain = _separation(case, first, second, motion, loop)
        except NumericalError:
            continue
        if gain > SEPARATES:
            found.append({"description": motion.words, "separates": names, "expected_gain": round(gain, 1)})
    return sorted(found, key=lambda f: -float(str(f["expected_gain"])))[:3]


def _loop_gains(case: Case) -> tuple[float, float, str] | None:
    replay, controller = case.replay, case.system.controller
    if replay.kind == "free" or replay.kp is None or replay.kd is None or replay.output is None:
        return None
    cascade = controller is not None and replay.kind == "controller" and controller.kind == "cascade"
    return (replay.kd * replay.kp if cascade else replay.kp), replay.kd, replay.output


def _motions(case: Case, output: str) -> list[Motion]:
    c = case.outputs.index(output)
    records = [e.measured[c] for e in case.prepared]
    middle = float(np.nanmedian(np.concatenate(records)))
    travel = max(float(np.nanmax(r) - np.nanmin(r)) for r in records) / 2
    its_unit = "m" if case.system.axis == "linear" else "rad"

    def triangle(t: np.ndarray, cycles: float) -> np.ndarray:
        return np.asarray(2 / np.pi * np.arcsin(np.sin(2 * np.pi * cycles * t / DURATION)))

    def described(share: float, cycles: float) -> str:
        speed = 4 * share * travel * cycles / DURATION
        return f"over ±{share * travel:.2g} {its_unit} at {speed:.2g} {its_unit}/s"

    made = [
        Motion(f"slow reversals {described(0.1, 2)} of {output}", lambda t, a: middle + 0.1 * a * triangle(t, 2)),
        Motion(f"reversals {described(0.5, 3)} of {output}", lambda t, a: middle + 0.5 * a * triangle(t, 3)),
        Motion(f"full-travel triangles {described(1.0, 4)} of {output}", lambda t, a: middle + a * triangle(t, 4)),
        Motion(
            f"a sine sweep of {output} from 0.2 to 3 Hz over ±{0.3 * travel:.2g} {its_unit}",
            lambda t, a: middle + 0.3 * a * np.sin(2 * np.pi * (0.2 * t + 1.4 * t**2 / DURATION)),
        ),
        Motion(
            f"micro motion of {output}, ±{0.01 * travel:.2g} {its_unit} about several positions, with standstill between",
            lambda t, a: middle + a * (0.6 * np.round(triangle(t, 1) * 2) / 2 + 0.01 * np.sin(2 * np.pi * 2 * t)),
        ),
    ]  # fmt: skip
    if "gravity_torque" in case.system.parameters and case.system.parameters["gravity_torque"] != 0:
        heavier = 0.5 * abs(case.system.parameters["gravity_torque"])
        words = f"full-travel triangles {described(1.0, 3)} of {output} with a payload of {heavier:.2g} N·m of gravity torque"
        made.append(Motion(words, lambda t, a: middle + a * triangle(t, 3), heavier))
    return [Motion(m.words, (lambda t, _, f=m.path: f(t, travel)), m.payload) for m in made]  # type: ignore[misc]


def _separation(case: Case, first: Fitted, second: Fitted, motion: Motion, loop: tuple[float, float, str]) -> float:
    """Half of min over parameters of |y_A - y_B - J theta|², in sensor noise, with the posterior of A as their prior."""
    time = np.arange(0.0, DURATION, 1 / RATE)
    ease = np.clip(time / 0.5, 0, 1) ** 2 * (3 - 2 * np.clip(time / 0.5, 0, 1))
    path = motion.path(time, 0.0)
    path = path[0] + ease * (path - path[0])
    seeds = [("parameter", f.index) for f in first.free]
    a = _run(case, first, motion, time, path, loop, seeds)
    b = _run(case, second, motion, time, path, loop, [])
    weight = case.noise[case.measured][:, None]
    d = ((a["outputs"] - b["outputs"])[case.measured] / weight).ravel()
    slopes = np.array([f.slope(x) for f, x in zip(first.free, first.x, strict=True)])
    j = (a["gradient"][:, case.measured] / weight).reshape(len(seeds), -1).T * slopes
    left = float(d @ d - (j.T @ d) @ np.linalg.solve(j.T @ j + first.precision, j.T @ d))
    return 0.5 * max(0.0, left)


def _run(
    case: Case, of: Fitted, motion: Motion, time: np.ndarray, path: np.ndarray, loop: tuple[float, float, str], seeds: list[tuple[str, int]]
) -> dict[str, Any]:
    system = of.system
    if motion.payload:
        system = system.with_parameters({"gravity_torque": system.parameters["gravity_torque"] + motion.payload})
    c = case.outputs.index(loop[2])
    axis = system.info.outputs[c].axis or 0
    shape, _, _ = _core.rigid_motion(system.kind, system.values(), system.active())
    core = _core.Experiment(
        kind=system.kind, time=time.tolist(), inputs=[linear(time, 0 * time), *[_core.Signal() for _ in system.info.inputs[1:]]],
        loop=_core.Loop(kind="controller", axis=axis, output=c, proportional=loop[0], derivative=loop[1], reference_weight=1.0,
                        limit=case.system.controller.limit if case.system.controller else np.inf, sample_time=0.0,
                        reference=smooth(time, path), disturbance=_core.Signal()),
        position=[path[0] * s / shape[axis] for s in shape], velocity=[0.0] * len(shape),
    )  # fmt: skip
    return dict(_core.simulate(system.kind, system.values(), system.active(keep_zero=True), core, seeds, case.settings))

"""What a further experiment is expected to bring, on stated numbers; and how a model is driven along its motion."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from integrate.rig import joint
from tendonlab import _core
from tendonlab.diagnosis.answer import motions, next_experiments
from tendonlab.diagnosis.answer.looped import Loop, Looped
from tendonlab.diagnosis.answer.motions import DURATION, EASE, RATE, Motion
from tendonlab.diagnosis.answer.next_experiments import SEPARATES, _gain, _separation, advise
from tendonlab.errors import NumericalError
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter
from tendonlab.papers import s2
from tendonlab.simulation.prepare import prepare

LOOP = Loop(400.0, 40.0, "joint_angle")
LOOP_OF_CABLES = Loop(20.0, 1.0, "joint_angle")


def case(kind: str = "injection", controller: Any = None, **changes: Any) -> Any:
    replay = SimpleNamespace(**{"kind": kind, "kp": 3.0, "kd": 0.5, "output": "joint_angle", **changes})
    spec = SimpleNamespace(column="angle (deg)", unit="deg", si_unit="rad")
    dataset = SimpleNamespace(signals={"joint_angle": spec})
    system = SimpleNamespace(controller=controller)
    return SimpleNamespace(replay=replay, system=system, measured=[0, 2], dataset=dataset)


def driven(of: Any) -> Loop | None:
    return Loop.of(of, of.replay)


def test_a_rig_is_driven_by_the_loop_of_its_replay() -> None:
    """A cascade multiplies its gains; without gains, or without a loop, a rig is not driven."""
    cascade, pd = SimpleNamespace(kind="cascade"), SimpleNamespace(kind="pd")
    assert driven(case()) == Loop(3.0, 0.5, "joint_angle")
    assert driven(case("controller", pd)) == Loop(3.0, 0.5, "joint_angle")
    assert driven(case("controller", cascade)) == Loop(1.5, 0.5, "joint_angle")
    assert driven(case("injection", cascade)) == Loop(3.0, 0.5, "joint_angle")
    for missing in ({"kind": "free"}, {"kp": None}, {"kd": None}, {"output": None}):
        kind = missing.pop("kind", "injection") or ""
        assert driven(case(kind, **missing)) is None


def test_motions_are_ranked_by_what_they_bring_and_the_best_three_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    gains = {"a": 12.345, "b": 2.9, "c": 40.0, "d": 11.0, "e": 900.0, "fails": 0.0}

    def separation(*given: Any) -> float:
        plan = given[4]
        if plan.words == "fails":
            raise NumericalError("no")
        return gains[plan.words]

    path = 1.0 + np.arange(0.0, DURATION, 1 / RATE)
    heavy = {"gravity_torque": 2.0}
    made = [SimpleNamespace(words=n, path=path, payload_of=lambda _, n=n: heavy if n == "e" else {}) for n in gains]
    monkeypatch.setattr(next_experiments, "motions", lambda *_: made)
    monkeypatch.setattr(next_experiments, "_separation", separation)
    floor: Any = None
    first, second = (SimpleNamespace(added=added) for added in (("x", "both"), ("both", "y")))
    found = advise(case(), case().replay, floor, first, second)  # type: ignore[arg-type]
    assert [(row["description"], row["expected_gain"]) for row in found] == [("e", 900.0), ("c", 40.0), ("a", 12.3)]
    assert found[0]["separates"] == ["x", "y"]
    assert [row.get("add") for row in found] == [{"gravity_torque": 2.0}, None, None]
    reference = found[0]["reference"]
    assert list(reference.columns) == ["t", "angle (deg)"]
    assert reference["angle (deg)"].iloc[0] == pytest.approx(np.degrees(1.0))  # as the logs measure it
    assert reference["angle (deg)"].iloc[-1] == pytest.approx(np.degrees(path[-1]))
    assert np.diff(reference["angle (deg)"])[0] < 1e-3 * np.degrees(1 / RATE)  # from rest
    no_derivative = case(kd=None).replay
    assert advise(case(), no_derivative, floor, first, second) == []  # type: ignore[arg-type]
    monkeypatch.setattr(next_experiments, "twin_delays", lambda _: {"x", "y"})
    assert advise(case(), case().replay, floor, first, second) == []  # type: ignore[arg-type]
    nothing: Any = SimpleNamespace(added=("both",))
    assert advise(case(), case().replay, floor, first, nothing) != []  # type: ignore[arg-type]


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> Motion:
    """Half a second of motion: few rows."""
    monkeypatch.setattr(motions, "DURATION", 0.5)
    return Motion("short", 2.0 + 3.0 * np.sin(9.0 * motions.instants()))


def damped(fitter: Fitter, factor: float) -> Fitted:
    """The bundled rig's simulator with other friction of the joint, as a fit."""
    system = fitter.case.system
    changed = {"joint_viscous": factor * system.parameters["joint_viscous"], "joint_coulomb": 0.5 * factor}
    return fitter.fit(system.with_parameters(changed), solve=False)


def followed(case: Any, motion: Motion) -> Looped:
    """The motion in the loop of the replay."""
    loop = driven(case)
    assert loop is not None
    return Looped(motion, loop)


def test_a_motion_separates_by_what_no_parameter_can_imitate(fitter: Fitter, nominal: Fitted, short: Motion) -> None:
    """Half the least squares of what the other model leaves more, its posterior as prior, its own unknowns integrated
    out: by dense matrices."""
    case, other = fitter.case, damped(fitter, 3.0)
    plan = followed(case, short)
    found = _gain(case, fitter.floor, nominal, other, plan.played(case, nominal.system).log)

    experiment = plan.played(case, nominal.system).log
    rig = replace(case, experiments=(experiment,), prepared=(prepare(experiment, case.system, case.replay),))
    (there,), (own,) = (replace(fitter, case=rig).fit(of.system, solve=False).runs for of in (other, nominal))
    root = np.linalg.cholesky(np.eye(len(there.residual)) + there.by_own @ there.by_own.T)
    rows = np.linalg.solve(root, np.column_stack([there.residual - own.residual, there.jacobian]))
    design = np.vstack([rows[:, 1:], np.linalg.cholesky(other.precision).T])
    target = np.concatenate([rows[:, 0], np.zeros(design.shape[1])])
    theta = np.linalg.lstsq(design, -target, rcond=None)[0]
    assert found == pytest.approx(0.5 * np.sum((target + design @ theta) ** 2), rel=1e-6)
    assert found > 0.1


def test_a_motion_separates_no_model_from_itself_and_promises_what_holds_for_either(
    fitter: Fitter, nominal: Fitted, short: Motion
) -> None:
    case, other = fitter.case, damped(fitter, 3.0)
    plan = followed(case, short)

    def gain(true: Fitted, rival: Fitted) -> float:
        return _gain(case, fitter.floor, true, rival, plan.played(case, true.system).log)

    assert gain(nominal, nominal) == pytest.approx(0.0, abs=1e-9)
    both = [gain(a, b) for a, b in ((nominal, other), (other, nominal))]
    assert _separation(case, fitter.floor, nominal, other, plan) == (min(both) if both[0] > SEPARATES else both[0])


def test_a_motion_is_logged_as_the_rig_logs(fitter: Fitter, nominal: Fitted, short: Motion) -> None:
    """With the columns and at the sampling rate of the logs; its command alone makes the motion again."""
    case = fitter.case
    like = case.experiments[case.train[0]]
    plan = followed(case, short)
    made = plan.played(case, nominal.system).log
    assert list(made.data.columns) == list(like.data.columns)
    assert np.median(np.diff(made.time)) == pytest.approx(np.median(np.diff(like.time)))
    replayed = replace(case.system, controller=None).simulate(made, replay="free").outputs
    output = plan.loop.output
    off = (replayed[output] - made.data[output]).abs().max()
    assert off < 0.01 * np.ptp(made.data[output])  # what the loop commands between samples is not logged


@pytest.mark.parametrize("payload", [0.0, 2.0])
def test_a_model_follows_a_motion_from_rest(payload: float) -> None:
    """Under a stiff loop, eased in over half a second; a payload makes the joint heavier."""
    time = np.arange(0.0, DURATION, 1 / RATE)
    path = 0.3 + 0.2 * np.sin(2.0 * time + 1.0)
    system = joint(("joint:viscous",), viscous=0.5, inertia=0.5)
    motion: Any = SimpleNamespace(path=path, payload=payload, payload_of=lambda _: {"inertia": payload})
    names = [s.name for s in system.info.outputs]
    rig: Any = SimpleNamespace(outputs=names, settings=lambda ports: _core.Settings(tolerance=1e-9))
    found = Looped(motion, LOOP).run(rig, system, time)["outputs"][names.index("joint_angle")]
    assert found[0] == pytest.approx(path[0])
    assert np.abs(np.diff(found[:3])).max() < 1e-4  # at rest
    speed, wanted = np.gradient(found, time), np.gradient(path, time)
    pull = 400.0 * (path - found) + 40.0 * (wanted - speed)
    balance = (0.5 + payload) * np.gradient(speed, time) + 0.5 * speed - pull
    assert balance[time > EASE + 0.02][:-5] == pytest.approx(0.0, abs=2e-3)  # of differences of 4 ms
    halfway = np.interp(0.5 * EASE, time, found) - path[0]
    assert halfway == pytest.approx(0.5 * (np.interp(0.5 * EASE, time, path) - path[0]), abs=5e-3)


def test_a_system_that_knows_a_part_of_its_state_itself_is_driven_too(tmp_path: Path) -> None:
    """A cable joint states its own angle, and its motor follows. Proposing a motion ended diagnoses."""
    system = s2.write_dataset(tmp_path, s2.constants()).system()
    time = np.arange(0.0, 1.0, 0.01)
    path = 0.2 + 0.0 * np.arange(0.0, DURATION, 1 / RATE)
    motion: Any = SimpleNamespace(path=path, payload_of=lambda _: {})
    names = [s.name for s in system.info.outputs]
    rig: Any = SimpleNamespace(outputs=names, settings=lambda ports: _core.Settings(tolerance=1e-5))
    found = Looped(motion, LOOP_OF_CABLES).run(rig, system, time)["outputs"][names.index("joint_angle")]
    assert found[0] == pytest.approx(0.2)
    assert np.all(np.isfinite(found))

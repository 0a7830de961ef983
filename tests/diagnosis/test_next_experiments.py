"""What a further experiment is expected to bring, on stated numbers; and how a model is driven along its motion."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from integrate.rig import joint
from tendonlab import _core
from tendonlab.diagnosis.answer import next_experiments
from tendonlab.diagnosis.answer.motions import DURATION, EASE, RATE
from tendonlab.diagnosis.answer.next_experiments import Loop, _loop, _run, _separation, advise
from tendonlab.errors import NumericalError

LOOP = Loop(400.0, 40.0, "joint_angle")


def case(kind: str = "injection", controller: Any = None, **changes: Any) -> Any:
    replay = SimpleNamespace(**{"kind": kind, "kp": 3.0, "kd": 0.5, "output": "joint_angle", **changes})
    spec = SimpleNamespace(column="angle (deg)", unit="deg", si_unit="rad")
    dataset = SimpleNamespace(signals={"joint_angle": spec})
    return SimpleNamespace(
        replay=replay, system=SimpleNamespace(controller=controller), measured=[0, 2], dataset=dataset
    )


def test_a_rig_is_driven_by_the_loop_of_its_replay() -> None:
    """A cascade multiplies its gains; without gains, or without a loop, a rig is not driven."""
    cascade, pd = SimpleNamespace(kind="cascade"), SimpleNamespace(kind="pd")
    assert _loop(case()) == Loop(3.0, 0.5, "joint_angle")
    assert _loop(case("controller", pd)) == Loop(3.0, 0.5, "joint_angle")
    assert _loop(case("controller", cascade)) == Loop(1.5, 0.5, "joint_angle")
    assert _loop(case("injection", cascade)) == Loop(3.0, 0.5, "joint_angle")
    for missing in ({"kind": "free"}, {"kp": None}, {"kd": None}, {"output": None}):
        kind = missing.pop("kind", "injection") or ""
        assert _loop(case(kind, **missing)) is None


def test_motions_are_ranked_by_what_they_bring_and_the_best_three_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    gains = {"a": 12.345, "b": 9.9, "c": 40.0, "d": 11.0, "e": 900.0, "fails": 0.0}

    def separation(*given: Any) -> float:
        motion = given[4]
        if motion.words == "fails":
            raise NumericalError("no")
        return gains[motion.words]

    path = 1.0 + np.arange(0.0, DURATION, 1 / RATE)
    made = [SimpleNamespace(words=name, path=path) for name in gains]
    monkeypatch.setattr(next_experiments, "motions", lambda *_: made)
    monkeypatch.setattr(next_experiments, "_separation", separation)
    floor: Any = None
    first, second = (SimpleNamespace(added=added) for added in (("x", "both"), ("both", "y")))
    found = advise(case(), floor, first, second)  # type: ignore[arg-type]
    assert [(row["description"], row["expected_gain"]) for row in found] == [("e", 900.0), ("c", 40.0), ("a", 12.3)]
    assert found[0]["separates"] == ["x", "y"]
    reference = found[0]["reference"]
    assert list(reference.columns) == ["t", "angle (deg)"]
    assert reference["angle (deg)"].iloc[0] == pytest.approx(np.degrees(1.0))  # as the logs measure it
    assert reference["angle (deg)"].iloc[-1] == pytest.approx(np.degrees(path[-1]))
    assert np.diff(reference["angle (deg)"])[0] < 1e-3 * np.degrees(1 / RATE)  # from rest
    assert advise(case("free"), floor, first, second) == []  # type: ignore[arg-type]


@pytest.mark.parametrize("shares", [(), (0.25, 1.0, 0.04)])
def test_a_motion_separates_by_what_no_parameter_can_imitate(
    shares: tuple[float, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Half the least squares of the difference, over noise, by parameters with their posterior as prior; samples that
    depend on each other count as fewer."""
    rng = np.random.default_rng(0)
    outputs = rng.normal(size=(2, 3, 40))
    gradient = rng.normal(size=(2, 3, 40))
    runs = iter([{"outputs": outputs[0], "gradient": gradient}, {"outputs": outputs[1]}])
    monkeypatch.setattr(next_experiments, "_run", lambda *_: next(runs))
    free = [SimpleNamespace(index=k, slope=lambda x, k=k: (k + 2.0) * x) for k in range(2)]
    precision = np.array([[3.0, 0.5], [0.5, 2.0]])
    first: Any = SimpleNamespace(free=free, x=[1.0, 0.5], precision=precision)
    floor: Any = SimpleNamespace(rms=np.array([0.5, np.nan, 2.0]), shares=shares)
    motion: Any = None
    found = _separation(case(), floor, first, motion, motion, LOOP)

    noise = np.array([0.5, 2.0]) / np.sqrt(np.array([0.25, 0.04]) if shares else 1.0)
    difference = ((outputs[0] - outputs[1])[[0, 2]] / noise[:, None]).ravel()
    columns = (gradient[:, [0, 2]] / noise[:, None] * np.array([2.0, 1.5])[:, None, None]).reshape(2, -1).T
    root = np.linalg.cholesky(precision).T
    design, target = np.vstack([columns, root]), np.concatenate([difference, np.zeros(2)])
    theta = np.linalg.lstsq(design, target, rcond=None)[0]
    assert found == pytest.approx(0.5 * np.sum((target - design @ theta) ** 2))


@pytest.mark.parametrize("payload", [0.0, 2.0])
def test_a_model_follows_a_motion_from_rest(payload: float) -> None:
    """Under a stiff loop, eased in over half a second; a payload makes the joint heavier."""
    time = np.arange(0.0, DURATION, 1 / RATE)
    path = 0.3 + 0.2 * np.sin(2.0 * time + 1.0)
    system = joint(("joint:viscous",), viscous=0.5, inertia=0.5)
    heavier = {"inertia": 0.5 + payload}
    motion: Any = SimpleNamespace(path=path, payload=payload, payload_on=lambda _: heavier)
    names = [s.name for s in system.info.outputs]
    of: Any = SimpleNamespace(system=system)
    rig: Any = SimpleNamespace(outputs=names, settings=lambda: _core.Settings(tolerance=1e-9))
    found = _run(rig, of, motion, LOOP, [])["outputs"][names.index("joint_angle")]
    assert found[0] == pytest.approx(path[0])
    assert np.abs(np.diff(found[:3])).max() < 1e-4  # at rest
    speed, wanted = np.gradient(found, time), np.gradient(path, time)
    pull = 400.0 * (path - found) + 40.0 * (wanted - speed)
    balance = (0.5 + payload) * np.gradient(speed, time) + 0.5 * speed - pull
    assert balance[time > EASE + 0.02][:-5] == pytest.approx(0.0, abs=2e-3)  # of differences of 4 ms
    halfway = np.interp(0.5 * EASE, time, found) - path[0]
    assert halfway == pytest.approx(0.5 * (np.interp(0.5 * EASE, time, path) - path[0]), abs=5e-3)

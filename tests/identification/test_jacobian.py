"""Derivatives of whitened residuals against central differences of simulations, through reversals and stick."""

from typing import Any

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.simulation.signals import linear

STEPS = (1e-4, 2e-4, 5e-5)


def residuals(rig: Any, tasks: list[Any], free: list[Any], x: np.ndarray, **options: Any) -> np.ndarray:
    """Whitened residuals of all tasks at the coordinates x."""
    moved = [f.started(f.value(at)) for f, at in zip(free, x, strict=True)]
    return np.concatenate(rig.linearise(tasks, moved, **options)["residuals"])


def difference(rig: Any, tasks: list[Any], free: list[Any], k: int, step: float) -> np.ndarray:
    """Central difference of the residuals by coordinate k."""
    x = np.array([f.coordinate(f.start) for f in free])
    move = step * np.eye(len(x))[k]
    return (residuals(rig, tasks, free, x + move) - residuals(rig, tasks, free, x - move)) / (2 * step)


def error(column: np.ndarray, expected: np.ndarray) -> float:
    """Rms error, relative to what was expected."""
    return float(np.linalg.norm(column - expected) / np.linalg.norm(expected))


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("joint", ("inertia", "gravity_torque", "coulomb", "viscous")),
        (
            "drive",
            ("joint_inertia", "cable_stiffness", "cable_damping", "motor_coulomb", "joint_coulomb", "joint_viscous"),
        ),
    ],
)
def test_jacobian_is_the_derivative_of_the_residuals(request: Any, name: str, parameters: tuple[str, ...]) -> None:
    rig = request.getfixturevalue(name)
    rig = type(rig)(**{**vars(rig), "ar": (0.5, 0.2), "settings": _core.Settings(tolerance=1e-12)})
    tasks, free = rig.tasks(), rig.free(*parameters)
    found = np.vstack(rig.linearise(tasks, free)["jacobian"])
    assert rig.simulate(0)["events"] >= 3  # reversals, or stick and breakaway
    # A difference is worth as much as its step: a short one shows the error of the two simulations, a long one the
    # curvature, or an event that only one of the two meets. A wrong derivative differs from all of them.
    for k, parameter in enumerate(parameters):
        tried = (error(found[:, k], difference(rig, tasks, free, k, step)) for step in STEPS)
        assert any(e < 1e-5 for e in tried), parameter


def test_jacobian_by_initial_states(drive: Any) -> None:
    rig = type(drive)(**{**vars(drive), "settings": _core.Settings(tolerance=1e-12)})
    outputs = rig.simulate(0)["outputs"]
    states, sd = [("position", 0), ("position", 1), ("velocity", 1)], [0.02, 0.01, 0.5]
    whitening = rig.whitening(outputs)
    time = np.array(rig.experiment(0).time)
    moving = _core.Experiment(
        kind=rig.kind, time=rig.experiment(0).time, inputs=[linear(time, rig.commands[0]), _core.Signal()],
        loop=_core.Loop(), position=[0.1, 0.04], velocity=[0.6, 0.3],
    )  # fmt: skip
    task = _core.Task(moving, whitening, initial=states, initial_sd=sd)
    start = np.array([0.1, 0.04, 0.3])
    found = rig.linearise([task], rig.free("joint_coulomb"))["jacobian_initial"][0]
    for k, step in enumerate(1e-3 * np.diag(sd)):  # a smaller one is drowned by the runs' own 1e-9
        up, down = (
            rig.linearise([task], rig.free("joint_coulomb"), initial=[list(start + s)])["residuals"][0]
            for s in (step, -step)
        )
        assert error(found[:, k], (up - down) / 2e-3) < 1e-5  # by the coordinate (value - mean) / sd


def test_a_condition_takes_its_parameter_out_of_the_jacobian(joint: Any) -> None:
    outputs = joint.simulate(0)["outputs"]
    fixed = {joint.index("coulomb"): 0.2}
    task = _core.Task(joint.experiment(0), joint.whitening(outputs), fixed=fixed)
    found = joint.linearise([task], joint.free("coulomb", "viscous"))
    assert not found["jacobian"][0][:, 0].any()
    expected = joint.whitening(outputs).residual(joint.simulate(0, coulomb=0.2)["outputs"])
    np.testing.assert_allclose(found["residuals"][0], expected, atol=1e-10)  # derivatives ride along: other rounding

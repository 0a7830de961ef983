"""Samples that a step writes eight at a time are those that it writes one by one."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from integrate.rig import FRICTION, NOMINAL, controller, joint, pair
from integrate.test_order import BRISTLE, LUGRE
from tendonlab import _core
from tendonlab.simulation.catalog import PORT_QUANTITIES
from tendonlab.simulation.signals import hold, smooth
from tendonlab.simulation.system import System

EVERY = 500  # rarer than steps: each sample is written alone
DENSE = np.linspace(0.0, 2.0, 40 * EVERY + 1)
KNOTS = np.linspace(0.0, 2.0, 41)
SWAY = 0.3 * np.sin(9.0 * KNOTS)
PUSH = {"motor_torque": smooth(KNOTS, 0.06 * np.sin(2 * np.pi * KNOTS) + 0.03 * np.sin(2 * np.pi * 2.3 * KNOTS + 1.0))}
STEPS = {"motor_torque": hold(KNOTS, np.sign(SWAY) * 0.08)}
STICKING = pair((*NOMINAL, "joint:load_dependence"), **FRICTION, joint_load_dependence=0.1)
LATE = pair(
    (*STICKING.effects, "actuation:delay", "sensor.motor_angle:delay"),
    **{**STICKING.parameters, "actuation_delay": 0.004, "sensor__motor_angle_delay": 0.003},
)
CABLES = System(
    kind="ccsrm",
    parameters={
        "cable_stiffness": 5e4, "pretension": 50.0, "pulley_radius": 0.012, "initial_wrap_angle": 1.69, "inertia": 1e-3,
        "friction_coefficient": 0.15, "smallest_level": 1e-3, "contact_coefficient_asymmetry": 0.07,
        "bristle_stiffness": 1e5, "bristle_damping": 100.0, "joint_viscous": 0.02,
    },
    effects=("contact:capstan", "contact:asymmetry", "contact:presliding", "joint:viscous"),
)  # fmt: skip
CASES: dict[str, tuple[System, Mapping[str, Any], Any]] = {
    "bristle": (joint(LUGRE, **BRISTLE), {"motor_torque": smooth(KNOTS, 6.0 * SWAY)}, None),
    "cables": (CABLES, {"driver_angle": smooth(KNOTS, 0.3 * SWAY)}, None),
    "stick and slip": (STICKING, PUSH, None),
    "held command": (STICKING, STEPS, None),
    "loop": (STICKING, {}, controller(smooth(KNOTS, 5.0 * SWAY), limit=0.08)),
    "sampled loop": (STICKING, {}, controller(smooth(KNOTS, 5.0 * SWAY), sample_time=0.05)),
    "injection": (STICKING, PUSH, controller(smooth(KNOTS, 5.0 * SWAY), kind="injection")),
    "late loop": (LATE, {}, controller(smooth(KNOTS, 5.0 * SWAY))),
    "late sensor": (LATE, PUSH, None),
}


def simulate(case: str, time: np.ndarray, *, num_seeds: int) -> dict[str, np.ndarray]:
    """Outputs, ports and derivatives at `time`."""
    system, inputs, loop = CASES[case]
    info = system.info
    experiment = _core.Experiment(
        kind=system.kind,
        time=time.tolist(),
        inputs=[inputs.get(signal.name, _core.Signal()) for signal in info.inputs],
        loop=loop or _core.Loop(),
        position=[0.02] * info.dof,
        velocity=[0.0] * info.dof,
    )
    own = [("parameter", k) for k, p in enumerate(info.parameters) if p.name in system.parameters]
    seeds = [("position", 0), *own][:num_seeds]
    settings = _core.Settings(tolerance=1e-3, ports=PORT_QUANTITIES)
    done = _core.simulate(system.kind, system.values(), system.active(), experiment, seeds, settings)
    return {name: done[name] for name in ("outputs", "ports", "gradient") if name != "gradient" or num_seeds}


@pytest.mark.parametrize("num_seeds", [0, 6, 12])
@pytest.mark.parametrize("case", CASES)
def test_samples_written_together_are_those_written_alone(case: str, num_seeds: int) -> None:
    together, alone = (simulate(case, time, num_seeds=num_seeds) for time in (DENSE, DENSE[::EVERY]))
    for name, expected in alone.items():
        size = np.abs(expected).max(axis=-1, keepdims=True)
        assert np.isfinite(together[name]).all()
        assert (np.abs(together[name][..., ::EVERY] - expected) <= 1e-9 * size + 1e-15).all(), name

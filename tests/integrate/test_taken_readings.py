"""An experiment whose first reading is known begins at that reading less the bias of its sensor."""

from __future__ import annotations

import pickle

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.errors import ParameterError
from tendonlab.simulation.signals import linear

TIME = np.arange(0.0, 0.5, 0.005)
BIAS = 0.07
VALUES = {"inertia": 0.02, "gravity_torque": 0.5, "torque_constant": 1.0, "coulomb": 0.05, "viscous": 0.03}
PLAIN = tl.System(kind="rigid_joint", parameters=VALUES, effects=("joint:coulomb", "joint:viscous"))
BIASED = PLAIN.with_effects({"sensor.joint_angle:bias": {"bias": BIAS}})
INDEX = [p.name for p in PLAIN.info.parameters].index("sensor.joint_angle_bias")
SETTINGS = _core.Settings(tolerance=1e-9)


def experiment(start: float, taken: list[tuple[int, int, float]]) -> _core.Experiment:
    return _core.Experiment(
        kind=PLAIN.kind,
        time=TIME.tolist(),
        inputs=[linear(TIME, 0.4 * np.sin(6.0 * TIME)), _core.Signal()],
        loop=_core.Loop(),
        position=[start],
        velocity=[0.2],
        taken=taken,
    )


def run(system: tl.System, of: _core.Experiment, *seeds: tuple[str, int]) -> dict[str, np.ndarray]:
    return dict(_core.simulate(system.kind, system.values(), system.active(), of, list(seeds), SETTINGS))


def test_the_first_sample_is_the_reading_whatever_the_bias() -> None:
    told = run(BIASED, experiment(0.3, [(0, 0, 1.0)]))["outputs"][0]
    assert told[0] == pytest.approx(0.3, abs=1e-15)
    there = run(PLAIN, experiment(0.3 - BIAS, []))["outputs"][0]
    np.testing.assert_allclose(told, there + BIAS, rtol=0, atol=1e-12)


def test_the_derivative_knows_that_a_bias_moves_the_start() -> None:
    seed = ("parameter", INDEX)
    exact = run(BIASED, experiment(0.3, [(0, 0, 0.5)]), seed)["gradient"][0]
    step = 1e-4
    ends = [
        run(PLAIN.with_effects({"sensor.joint_angle:bias": {"bias": BIAS + by}}), experiment(0.3, [(0, 0, 0.5)]))
        for by in (-step, step)
    ]
    difference = (ends[1]["outputs"] - ends[0]["outputs"]) / (2 * step)
    np.testing.assert_allclose(exact, difference, rtol=0, atol=2e-4)
    assert exact[0, 0] == pytest.approx(0.5)  # the reading: 0.3 - 0.5 bias + bias


def test_many_begin_where_one_begins() -> None:
    of = experiment(0.3, [(0, 0, 1.0)])
    out = np.empty((1, 2, len(TIME)))
    values, active = np.array([BIASED.values()]), np.array([BIASED.active()])
    position, velocity = np.array([[0.3]]), np.array([[0.2]])
    _core.simulate_many(PLAIN.kind, values, active, of, position, velocity, SETTINGS, [0, 1], out)
    np.testing.assert_allclose(out[0], run(BIASED, of)["outputs"], rtol=0, atol=1e-8)


def test_a_copy_begins_there_too() -> None:
    of = experiment(0.3, [(0, 0, 1.0)])
    for copy in (pickle.loads(pickle.dumps(of)), of.started([0.3], [0.2], of.reading)):
        np.testing.assert_array_equal(run(BIASED, copy)["outputs"], run(BIASED, of)["outputs"])


def test_what_no_sensor_tells_is_refused() -> None:
    for wrong in ((1, 0, 1.0), (0, 9, 1.0), (0, 0, np.nan)):
        with pytest.raises(ParameterError, match=r"taken = .*expected one of 1 degrees of freedom"):
            experiment(0.3, [wrong])


def test_a_measured_run_begins_at_its_first_samples() -> None:
    log = pd.DataFrame({"motor_torque": 0.0 * TIME, "joint_angle": 0.3 + 0.0 * TIME}, index=TIME)
    assert BIASED.simulate(log)["joint_angle"][0] == pytest.approx(0.3, abs=1e-12)
    assert PLAIN.simulate(log)["joint_angle"][0] == pytest.approx(0.3, abs=1e-12)

"""Many points in one call give what each gives alone to ten times the tolerance, whatever runs beside them."""

from __future__ import annotations

import numpy as np
import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.simulation.signals import linear

TIME = np.arange(0.0, 0.5, 0.005)
VALUES = {"inertia": 0.02, "gravity_torque": 0.5, "torque_constant": 1.0, "coulomb": 0.05, "viscous": 0.03}
SIM = tl.System(kind="rigid_joint", parameters=VALUES, effects=("joint:coulomb", "joint:viscous"))
COULOMB = [p.name for p in SIM.info.parameters].index("coulomb")
TOLERANCE = 1e-6
SETTINGS = _core.Settings(tolerance=TOLERANCE)


def experiment(position: float = 0.0, velocity: float = 0.0) -> _core.Experiment:
    pushed = linear(TIME, 0.4 * np.sin(6.0 * TIME))
    loop = _core.Loop()
    return _core.Experiment(
        kind=SIM.kind,
        time=TIME.tolist(),
        inputs=[pushed, _core.Signal()],
        loop=loop,
        position=[position],
        velocity=[velocity],
    )


def run_many(coulomb: list[float], start: list[tuple[float, float]], out: np.ndarray, channels: list[int]) -> list[str]:
    values = np.tile(SIM.values(), (len(coulomb), 1))
    values[:, COULOMB] = coulomb
    active = np.tile(SIM.active(), (len(coulomb), 1))
    position, velocity = np.array(start).T[:, :, None]
    return _core.simulate_many(SIM.kind, values, active, experiment(), position, velocity, SETTINGS, channels, out)


def alone(coulomb: float, start: tuple[float, float]) -> np.ndarray:
    one = SIM.with_parameters({"coulomb": coulomb})
    return np.asarray(_core.simulate(SIM.kind, one.values(), SIM.active(), experiment(*start), [], SETTINGS)["outputs"])


def assert_close(many: np.ndarray, single: np.ndarray) -> None:
    np.testing.assert_allclose(many, single, rtol=0.0, atol=10 * TOLERANCE * np.abs(single).max())


def test_each_point_is_the_simulation_alone() -> None:
    coulomb, start = [0.02, 0.05, 0.2], [(0.0, 0.0), (0.3, 0.0), (0.0, -1.0)]
    out = np.empty((3, 2, len(TIME)))
    assert run_many(coulomb, start, out, [0, 1]) == ["", "", ""]
    for k in range(3):
        assert_close(out[k], alone(coulomb[k], start[k]))


def test_neighbours_change_no_bit_of_a_point() -> None:
    """Points that end at different times share lanes with others in any order; some stick, one fails."""
    coulomb = [0.02, 0.05, 0.2, 0.5, 0.03, 0.0, 0.1, 0.07, 0.04, 0.3, 0.05]
    start = [(0.1 * k, -0.5 * (k % 3)) for k in range(10)] + [(0.0, 1e300)]
    together = np.empty((len(coulomb), 2, len(TIME)))
    run_many(coulomb, start, together, [0, 1])
    for rows in ([3], [9, 0, 4], list(range(10, -1, -1))):
        again = np.empty((len(rows), 2, len(TIME)))
        run_many([coulomb[k] for k in rows], [start[k] for k in rows], again, [0, 1])
        np.testing.assert_array_equal(again, together[rows])


def test_channels_and_precision_are_those_asked_for() -> None:
    both, single = np.empty((1, 2, len(TIME))), np.empty((1, 1, len(TIME)), dtype=np.float32)
    run_many([0.05], [(0.0, 0.0)], both, [0, 1])
    run_many([0.05], [(0.0, 0.0)], single, [1])
    np.testing.assert_array_equal(single[0, 0], both[0, 1].astype(np.float32))


def test_a_point_that_fails_says_why_and_costs_no_other() -> None:
    out = np.zeros((2, 2, len(TIME)))
    failed, fine = run_many([0.05, 0.05], [(0.0, 1e300), (0.0, 0.0)], out, [0, 1])
    assert "simulation stopped at t = 0 s" in failed
    assert fine == ""
    assert np.isnan(out[0]).all()
    assert_close(out[1], alone(0.05, (0.0, 0.0)))


@pytest.mark.parametrize(
    ("out", "channels", "told"),
    [
        (np.empty((2, 2, len(TIME))), [0, 1], r"out: expected shape \(1, 2, 100\)"),
        (np.empty((1, 2, len(TIME)), dtype=int), [0, 1], "expected an array of float64 or float32"),
        (np.empty((1, 1, len(TIME))), [2], "channel 2: rigid_joint has 2 outputs"),
        (np.empty((1, 2, len(TIME))), [1, 1], "channel 1: twice"),
    ],
)
def test_what_does_not_fit_is_refused(out: np.ndarray, channels: list[int], told: str) -> None:
    with pytest.raises(tl.ParameterError, match=told):
        run_many([0.05], [(0.0, 0.0)], out, channels)


def test_a_value_outside_its_bounds_is_refused() -> None:
    with pytest.raises(tl.ParameterError, match="coulomb = -1"):
        run_many([-1.0], [(0.0, 0.0)], np.empty((1, 2, len(TIME))), [0, 1])

"""A small sweep that the tests of this folder share; also imported by the processes that they start."""

import numpy as np
import pandas as pd

import tendonlab as tl

TIME = np.arange(0.0, 1.0, 0.005)
VALUES = {"inertia": 0.02, "gravity_torque": 0.5, "torque_constant": 1.0, "coulomb": 0.05, "viscous": 0.03}
SIM = tl.System(kind="rigid_joint", parameters=VALUES, effects=("joint:coulomb", "joint:viscous"))
TABLE = pd.DataFrame({"coulomb": [0.02, 0.0, 0.1, 0.05], "inertia": [0.01, 0.02, 0.03, 0.02]})


def pushed(time: np.ndarray = TIME, *, amplitude: float = 0.4) -> pd.DataFrame:
    return pd.DataFrame({"motor_torque": amplitude * np.sin(6.0 * time)}, index=pd.Index(time, name="t"))


def assert_is_simulation(swept: np.ndarray, alone: np.ndarray, *, tolerance: float = 1e-6) -> None:
    """The points of a sweep take their steps together: they agree with a simulation to ten times the tolerance."""
    np.testing.assert_allclose(swept, alone, rtol=0.0, atol=10 * tolerance * np.abs(alone).max())


def extremes(chunk: np.ndarray) -> np.ndarray:
    """Two numbers per point, of the first output."""
    return np.stack([chunk[:, 0].min(axis=-1), chunk[:, 0].max(axis=-1)], axis=1)


def many(num_points: int) -> pd.DataFrame:
    return pd.DataFrame({"coulomb": np.linspace(0.0, 0.1, num_points), "viscous": np.linspace(0.02, 0.04, num_points)})


def blas_threads(chunk: np.ndarray) -> np.ndarray:
    """The most threads that linear algebra may use in a task."""
    from threadpoolctl import threadpool_info

    most = max((pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"), default=1)
    return np.full(len(chunk), float(most))

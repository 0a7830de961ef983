"""What S0's functions refuse: the argument, its value and what was expected stand in the message."""

from collections.abc import Callable

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.papers.s0 import bearings, bench, drive, evidence, maps

RIG = bench.configuration("C25P104GX-D")
INERTIAS = (1e-4, 1e-5, 1e-4, 1e-3)


def torque(**changed: object) -> object:
    given = {"speed": 1.0, "acceleration": 0.0, "ratio": 4.0, "inertias": INERTIAS, "viscous": (1e-4, 1e-4)}
    return drive.motor_torque(**{**given, **changed})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: drive.viscous_factor(0.0), r"ratio = 0\.0: expected a value in \(0, inf\)"),
        (lambda: drive.viscous_factor(np.nan), r"ratio = nan: expected"),
        (lambda: torque(speed=np.nan), r"speed\[0\] = nan: expected a finite number"),
        (lambda: torque(acceleration=np.array([0.0, np.inf])), r"acceleration\[1\] = inf: expected"),
        (lambda: torque(friction=np.nan), r"friction\[0\] = nan: expected"),
        (lambda: torque(load_torque=np.nan), r"load_torque\[0\] = nan: expected"),
        (lambda: torque(inertias=(np.nan, *INERTIAS[1:])), r"inertias\[0\] = nan: expected"),
        (lambda: torque(ratio=0.0), r"ratio = 0\.0: expected"),
        (lambda: bearings.cable_pull(RIG, 10.0, centres=0.0), r"centres = 0\.0: expected a value in \(0, inf\) m"),
        (lambda: maps.twin_map(RIG, num_runs=0), "num_runs = 0: expected a whole number of at least 1"),
        (lambda: evidence.bearing_coefficient("C25"), "transmission = 'C25': "),
        (lambda: evidence.largest_preload("C25P104GP"), "transmission = 'C25P104GP': "),
        (lambda: maps.features(np.arange(3.0), np.array([0.0, np.nan, 1.0])), r"torque\[1\] = nan: expected"),
        (lambda: maps.features(np.array([]), np.array([])), "speed has 0 samples: expected at least 1"),
        (lambda: maps.features(np.arange(3.0), np.arange(4.0)), "torque has 4 samples: expected 3, as many as speed"),
    ],
)
def test_what_makes_no_sense_is_refused(call: Callable[[], object], told: str) -> None:
    with pytest.raises(ParameterError, match=told):
        call()

"""What S2's functions refuse: the argument, its value and what was expected stand in the message."""

from collections.abc import Callable

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.papers import s2

RIG = s2.constants()
TURNS = np.linspace(0.0, 3.0, 50)
BOTH = np.repeat([1.0, -1.0], 50)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: s2.gear_points(RIG, fastest=np.nan), r"fastest = nan: expected a value in \(0, inf\) rad/s"),
        (lambda: s2.gear_points(RIG, num_points=0), "num_points = 0: expected a whole number of at least 1"),
        (lambda: s2.order_spectrum(np.where(TURNS > 1.0, np.nan, TURNS), TURNS), r"turns\[17\] = nan: expected"),
        (lambda: s2.order_spectrum(TURNS, np.full(50, np.inf)), r"values\[0\] = inf: expected"),
        (lambda: s2.order_spectrum(TURNS, TURNS[1:]), "values has 49 samples: expected 50, as many as turns"),
        (lambda: s2.order_spectrum(TURNS, TURNS, highest=0.5), r"highest = 0\.5: expected a value in \[1, inf\)"),
        (lambda: s2.reference(acceleration=0.0), r"acceleration = 0\.0: expected a value in \(0, inf\) rad/s\^2"),
        (lambda: s2.reference(speed=-0.1), r"speed = -0\.1: expected a value in \(0, inf\) rad/s"),
        (lambda: s2.reference(dwell=-1.0), r"dwell = -1\.0: expected a value in \[0, inf\) s"),
        (lambda: s2.reference(step=0.0), r"step = 0\.0: expected"),
        (lambda: s2.reference((0.0, np.nan)), r"points\[1\] = nan: expected"),
        (lambda: s2.free_swing(RIG, duration=0.0), r"duration = 0\.0: expected a value in \(0, inf\) s"),
        (lambda: s2.fit_bushing(BOTH, BOTH, BOTH, tension=0.0), r"tension = 0\.0: expected a value in \(0, inf\) N"),
        (
            lambda: s2.fit_bushing(np.full(100, 0.3), BOTH, BOTH, tension=200.0),
            r"theta = 0\.3 in all samples of sense \+1: expected angles that differ",
        ),
        (lambda: s2.bushing_loop(RIG, cable=3), "cable = 3: expected 1 or 2"),
        (lambda: s2.bushing_loop(RIG, cable=0), "cable = 0: expected 1 or 2"),
        (lambda: s2.identified("value"), "column = 'value': "),
    ],
)
def test_what_makes_no_sense_is_refused(call: Callable[[], object], told: str) -> None:
    with pytest.raises(ParameterError, match=told):
        call()

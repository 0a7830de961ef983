"""Maps of S0's bench by runs in full, against the friction that the twin has."""

import numpy as np

from tendonlab.papers import s0
from tendonlab.papers.s0 import twin


def test_a_map_of_full_runs_scatters_about_the_twin() -> None:
    """Through cells, creep, wavelets and the steady part: within the sd of the mean, in both directions."""
    of = s0.configuration("C35P75GX-D4M")
    found = s0.bench_map(of, np.array([-60.0, -20.0, 20.0, 60.0]), num_runs=6, travel=60.0, seed=3)
    assert list(found["num_runs"]) == [6, 6, 6, 6]
    np.testing.assert_allclose(found["speed"], [-60.0, -20.0, 20.0, 60.0], rtol=5e-3)
    distance = (found["torque"] - twin.friction(of, found["speed"].to_numpy())) / found["sd_of_mean"]
    assert np.abs(distance).max() < 4.0

"""How many samples of a residual count, by which the gain of a factor is judged."""

import numpy as np
import pytest

from tendonlab.checking.scales import shares


@pytest.mark.parametrize("times", [1, 5, 20])
def test_samples_that_are_written_several_times_count_once(times: int) -> None:
    noise = np.random.default_rng(0).standard_normal((2, 2000))
    residual = np.repeat(noise, times, axis=1)
    run = np.repeat([0, 1], 1000 * times)
    assert shares(residual, run) == pytest.approx(1.0 / times, rel=0.2)

"""Intervals where residuals are not independent."""

import numpy as np
import pytest

from tendonlab._core import Free
from tendonlab.fitting.uncertainty import uncertainty

MEAN = Free(name="joint_coulomb", index=0, log=False, scale=1.0, start=0.0)
BLOCKS, LENGTH = 400, 25


def sd_of_mean(residual: np.ndarray) -> float:
    """Of a constant that is fitted to `residual`, in blocks of LENGTH samples."""
    rows = np.arange(len(residual))
    parts = [rows // LENGTH == block for block in range(BLOCKS)]
    run = (residual, np.ones((len(rows), 1)), parts)
    found = uncertainty([run], [MEAN], np.zeros(1), at_bound=[False], informed=[True])
    half = 0.5 * (found.upper[0] - found.lower[0])
    assert half == pytest.approx(1.96 * found.sd[0], rel=0.01)  # Student's t with 400 clusters
    return float(found.sd[0])


def test_a_residual_that_stays_for_a_block_is_one_measurement() -> None:
    random = np.random.default_rng(2)
    independent = random.normal(size=BLOCKS * LENGTH)
    assert sd_of_mean(independent) == pytest.approx((BLOCKS * LENGTH) ** -0.5, rel=0.1)
    assert sd_of_mean(np.repeat(random.normal(size=BLOCKS), LENGTH)) == pytest.approx(BLOCKS**-0.5, rel=0.1)

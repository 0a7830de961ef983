"""The delays of actuation and sensing."""

from typing import Any

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.errors import ParameterError

both = pytest.mark.parametrize("of", [_core.actuation.Delay, _core.sensing.Delay])


@both
def test_a_ramp_comes_late_by_the_delay_and_starts_with_its_first_value(of: Any) -> None:
    time = np.array([0.0, 0.1, 0.2, 0.3, 0.4])
    answer = of(delay=0.25).apply(4.0 * time + 1.0, time=time)
    np.testing.assert_allclose(answer, [1.0, 1.0, 1.0, 1.2, 1.6])  # from 0.25 s on 4 (t - 0.25) + 1


@both
def test_a_delay_needs_the_instants(of: Any) -> None:
    with pytest.raises(ParameterError, match="time is missing: expected the instants of the signal"):
        of(delay=0.1).apply([0.0, 1.0])

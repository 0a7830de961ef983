"""However many directions one simulation carries along, each derivative is the same."""

import numpy as np
import pytest

from integrate.rig import FRICTION, NOMINAL, pair, run

T = np.linspace(0.0, 1.0, 201)
TORQUE = 0.3 * np.sin(9.0 * T)
SYSTEM = pair(NOMINAL, **FRICTION)
NAMES = tuple(SYSTEM.parameters)


def gradient(names):
    found = run(SYSTEM, T, TORQUE, by=names, tolerance=1e-8)
    return {name: found.gradient[name] for name in names}


ALONE = {name: gradient([name])[name] for name in NAMES}


@pytest.mark.parametrize("count", [2, 7, 8, 9, len(NAMES)])
def test_derivatives_do_not_depend_on_their_company(count):
    for name, together in gradient(NAMES[:count]).items():
        size = np.abs(ALONE[name]).max()
        assert np.abs(together - ALONE[name]).max() <= 1e-9 * size + 1e-12

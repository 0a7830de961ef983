"""Twenty cycles of stick and slip against an independent reference with a step of a microsecond."""

import re

import numpy as np
import pytest

from integrate.reference_stick_slip import DRAG, GOLDEN, LOOP, PARAMETERS
from integrate.rig import NOMINAL, controller, pair, relative, run
from tendonlab.simulation.signals import linear

EFFECTS = (*NOMINAL, "joint:stribeck")


@pytest.fixture(scope="module")
def reference():
    return np.loadtxt(GOLDEN, delimiter=",")


def simulated(t, tolerance):
    loop = controller(linear(t, DRAG * t), **LOOP)
    return run(pair(EFFECTS, **PARAMETERS), t, loop=loop, tolerance=tolerance, ports=True)


@pytest.mark.parametrize(("tolerance", "bound"), [(1e-6, 1e-4), (1e-9, 1e-6)])
def test_twenty_cycles_agree_with_the_reference(reference, tolerance, bound):
    t = reference[:, 0]
    done = simulated(t, tolerance)
    slips = np.diff(np.flatnonzero(np.diff(done["joint_angle"]) == 0.0)) > 1
    assert np.count_nonzero(slips) >= 20
    for column, name in enumerate(("motor_angle", "joint_angle", "cable_torque"), start=1):
        assert relative(done[name], reference[:, column]) < bound
    assert done.attempts < 20_000  # the reference takes fourteen million steps


def test_joint_is_exactly_at_rest_while_it_sticks(reference):
    done = simulated(reference[:, 0], 1e-6)
    velocity, _, _, force = done.ports["joint"]
    sticks = velocity == 0.0
    assert 0.3 < np.mean(sticks) < 0.99
    assert np.all(np.abs(force[sticks]) <= 0.18 * (1 + 1e-9))  # its level at rest
    # no gravity: friction holds the cable
    assert force[sticks] == pytest.approx(done["cable_torque"][sticks], abs=1e-9)


def test_reference_has_converged():
    """The file says by how much a step of 2 us differs, a number an output: far less than what is asked of ours."""
    said = [float(x) for x in re.findall(r"\d\.\de-\d\d", GOLDEN.read_text().splitlines()[1])]
    assert len(said) == 3
    assert max(said) < 1e-8

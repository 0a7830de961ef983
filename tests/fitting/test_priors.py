"""Coordinates of free parameters."""

import math

import pytest

from tendonlab.fitting.priors import Free, Scale, free_parameters
from tendonlab.simulation.records import NominalParameter
from tendonlab.simulation.system import System


def test_a_logarithm_starts_above_0_also_where_a_fit_went_there() -> None:
    """A long step of a fit may end where exp(x) is 0; the next fit begins there, and its prior pulls it back."""
    damping = Free("cable_damping", 0, log=True, scale=0.05, start=0.05, mean=0.0, sd=0.6, lower=0.0, upper=math.inf)
    assert damping.value(-945.0) == 0.0
    begun = damping.started(damping.value(-945.0))
    assert 0.0 < begun.start < 1e-300
    assert math.isfinite(begun.coordinate(begun.start))
    assert damping.started(0.02).start == 0.02


def test_what_is_no_logarithm_starts_at_0() -> None:
    amplitude = Free("coulomb", 0, log=False, scale=0.1, start=0.1, mean=0.0, sd=1.0, lower=0.0, upper=1.0)
    assert amplitude.started(0.0).start == 0.0
    assert amplitude.started(2.0).start == 1.0


@pytest.mark.parametrize(("sd", "scale", "prior"), [(0.2, 0.2, 1.0), (math.inf, 0.15, math.inf), (None, 0.15, 1.0)])
def test_a_value_below_0_has_the_prior_that_is_stated(sd: float | None, scale: float, prior: float) -> None:
    """Without an sd the prior is 30 % of the value wide; with inf it says nothing."""
    rig = System(kind="rigid_joint", parameters={"inertia": 1.0, "gravity_torque": -0.5, "torque_constant": 1.0})
    nominal = {"gravity_torque": NominalParameter(-0.5, sd=sd)}
    (free,) = free_parameters(rig, nominal, {"joint": Scale(3.0, 1.0, 1.0)})
    assert (free.name, free.log, free.sd) == ("gravity_torque", False, prior)
    assert free.scale == pytest.approx(scale)
    assert free.value(free.mean) == pytest.approx(-0.5)
